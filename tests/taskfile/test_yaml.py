"""Files that are not YAML, not plain data or malicious are refused quickly, with a place, and never executed."""

import time
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from texts import load_task_text

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.task import Task
from hybrid_tamp.taskfile.loader import load_task
from hybrid_tamp.taskfile.yaml import builder as yaml_builder
from hybrid_tamp.taskfile.yaml.builder import MAX_DEPTH
from hybrid_tamp.taskfile.yaml.nodes import MAX_BYTES, decode, parse

Issues = Callable[[str], tuple[Issue, ...]]


def refused(text: str) -> list[str]:
    """Return the messages about a text that cannot be read or that has faults."""
    try:
        document = parse(text, "f")
    except InputError as error:
        return [str(issue) for issue in error.issues]
    return [str(issue) for issue in document.faults.issues]


@pytest.mark.parametrize(
    ("text", "messages"),
    [
        ("", ["f:1:1: a task file must be a mapping with the keys domain, tokens and goal; got an empty file"]),
        ("# nothing\n---\n", ["f:1:1: a task file must be a mapping"]),
        ("- a", ["f:1:1: a task file must be a mapping with the keys domain, tokens and goal; got ['a']"]),
        ("a: 1\n\tb: 2\n", ["f:2:1: lines must be indented with spaces; got a tab"]),
        ("a:\n\tb: 1\n  \tc: 2\n", ["f:2:1: lines must be indented", "f:3:3: lines must be indented"]),
        ("a: 1\n---\nb: 2\n", ["f:2:1: a task file must be one document; got a second document"]),
        ("%YAML 1.1\n---\na: no\n", ["f:1:1: a task file must be YAML 1.2; got YAML 1.1"]),
        ("a: [1, 2\nb: 3\n", ["f:2:2: expected a comma or ']' in a list; got 'b: 3'"]),
        ("a: {b: 1\nc: 2\n", ["f:2:2: expected a comma or '}' in a mapping; got 'c: 2'"]),
        ("a: 'x\n", ["f:1:4: a text in quotes must have a closing quote"]),
        ("a: b: c\n", ["f:1:5: a line must have only one key, and text with ': ' must be in quotes; got 'a: b: c'"]),
        ("a: 1\n b: 2\n", ["f:2:3: a line must have only one key"]),
        ("a:\n  b: 1\n c: 2\n", ["f:3:2: the lines of a list or mapping must have the same indentation"]),
        ("a: @b\n", ["f:1:4: text that begins with this character must be in quotes"]),
        ('a: "\\q"\n', ["f:1:6: YAML does not know this escape"]),
        ('a: "\\UFFFFFFFF"\n', ["f:1:1: not valid YAML 1.2: cannot read the text after this place"]),
        ("a: \x07b\n", ["f:1:4: a task file must be printable text; got the control character U+0007"]),
        ("a: !!python/object/apply:os.system [ls]\n", ["f:1:4: a task file must be plain", "!!python/object/apply"]),
        ("a: !x b\n!!set c: d\n", ["f:1:4: a task file must be plain data", "f:2:1: a task file must be plain data"]),
        ("a: !!int x\n", ["f:1:4: a value must fit its tag !!int; got 'x'"]),
        ("a: !!seq {b: c}\n", ["f:1:4: a task file must be plain data"]),
        ("a: &x 1\nb: *x\n", ["f:2:4: a task file must not contain aliases; got *x; write the value itself"]),
        ("a: &x [*x]\n", ["f:1:8: a task file must not contain aliases"]),
        ("a: {<<: *x}\n", ["f:1:9: a task file must not contain aliases"]),
        ("*a : b\n", ["f:1:1: a key must be text; got *a"]),
        ("? [a, b]\n: c\n", ["f:1:3: a key must be text; got a list or mapping"]),
        ("a: {1: b, ~: c, true: d, : e}\n", ["f:1:5: a key must be text; got 1; write \"1\" in quotes",
                                            "f:1:11: a key must be text", "f:1:17: a key must be text",
                                            "f:1:27: a key must be text; got nothing; write a key before the ':'"]),
        ('a: "\\ud800"\n"\\udfff": b\n', ["f:1:4: text must be whole characters", "f:2:1: text must be whole"]),
        ("a: {b: 1, c: 2, b: 3}\na: 2\nd: 3\nd: 3\n", ["f:1:17: a key must occur only once; got a second key 'b'",
                                                       "f:2:1: a key must occur only once", "f:4:1: a key must occur"]),
    ],
)  # fmt: skip
def test_a_fault_of_the_text_is_named_with_its_place(text: str, messages: list[str]) -> None:
    found = refused(text)
    assert len(found) == (1 if "python" in text else len(messages)), found
    for message in messages:
        assert any(message in one for one in found), found


def test_numbers_are_those_of_the_core_schema() -> None:
    text = "[010, 0o10, 0x1f, -3, +4, 1e3, .5, 5., -.Inf, 1_000, 0b1, 1:30, 2020-01-01, no, True, ~, '1', !!str 2, ! 3]"
    values = parse(f"a: {text}", "f").data["a"]
    assert values == [10, 8, 31, -3, 4, 1000.0, 0.5, 5.0, float("-inf"), "1_000", "0b1", "1:30", "2020-01-01", "no",
                      True, None, "1", "2", "3"]  # fmt: skip
    assert [type(value) for value in values[:8]] == [int] * 5 + [float] * 3


def test_every_part_has_its_place() -> None:
    faults = parse("a:\n  - b: [1, 2]\n    c:\n", "f").faults
    places = {path: (mark.line, mark.column) for path, mark in faults.values.items()}
    assert places == {
        (): (1, 1),
        ("a",): (2, 3),
        ("a", 0): (2, 5),
        ("a", 0, "b"): (2, 8),
        ("a", 0, "b", 0): (2, 9),
        ("a", 0, "b", 1): (2, 12),
        ("a", 0, "c"): (3, 5),
    }
    assert {path: (mark.line, mark.column) for path, mark in faults.keys.items()} == {
        ("a",): (1, 1),
        ("a", 0, "b"): (2, 5),
        ("a", 0, "c"): (3, 5),
    }


@pytest.mark.parametrize(
    ("raw", "where"), [(b"a: \xff", "f:1:4"), ("ä: ß\r\nö".encode() + b"\xc3", "f:2:2"), (b"\xff\xfea\0", "f:1:1")]
)
def test_a_byte_that_is_not_utf_8_is_named_with_its_place(raw: bytes, where: str) -> None:
    with pytest.raises(InputError, match=f"{where}: a task file must be UTF-8; got the byte 0x"):
        decode(raw, "f")


def test_a_byte_order_mark_does_not_move_the_place() -> None:
    with pytest.raises(InputError, match="f:1:2: a task file must be UTF-8; got the byte 0xff"):
        decode(b"\xef\xbb\xbfa\xff", "f")


def test_ten_megabytes_of_nested_lists_are_refused_by_size_at_once(tmp_path: Path) -> None:
    path = tmp_path / "t.yaml"
    path.write_bytes(b"[" * 10_000_000)
    start = time.perf_counter()
    with pytest.raises(InputError, match=f"at most {MAX_BYTES} bytes .1 MiB.; got 10000000 bytes"):
        load_task(path)
    assert time.perf_counter() - start < 1.0


def test_a_text_is_refused_by_size_too(tmp_path: Path) -> None:
    path = tmp_path / "t.yaml"
    path.write_text("ä" * 600_000, encoding="utf-8")
    with pytest.raises(InputError, match="at most 1048576 bytes"):
        load_task(path)


@pytest.mark.parametrize(
    "piece", ["[", "[ ", "{a: ", "- ", "? ", "a: [{", "&a [", "!!seq [", "{? ["], ids=lambda piece: repr(piece)
)
def test_deep_nesting_is_refused_before_it_hurts(piece: str) -> None:
    *others, message = refused(piece * (9_999 // len(piece)))
    # Lists as keys are refused one by one before.
    assert f"not be nested more than {MAX_DEPTH} deep" in message
    assert all("a key must be text" in other for other in others)


@pytest.mark.parametrize("piece", ["!", "&", "!a", "x"])
def test_endless_words_are_refused_at_once(piece: str) -> None:
    start = time.perf_counter()
    (message,) = refused("a:\n  b: " + piece * 500_000)
    assert message == "f:2:6: a word must have at most 10000 characters; got a longer word; put blanks in between"
    assert time.perf_counter() - start < 1.0


def test_messages_stay_short(issues: Issues, text: str) -> None:
    long = "x" * 9000
    for old, new in (
        ("[drum, goal]", f"[{long}, goal]"),
        ("seed", long),
        ("toy", long),
        ("7", f"!{long} 7"),
        ("7", f"*{long}"),
    ):
        for issue in issues(text.replace(old, new, 1)):
            assert len(str(issue)) < 400


def test_nesting_by_indentation_is_refused_too() -> None:
    (message,) = refused("".join(" " * depth + "a:\n" for depth in range(1400)))
    assert message.startswith(
        f"f:{MAX_DEPTH + 1}:{MAX_DEPTH + 1}: lists and mappings must not be nested more than {MAX_DEPTH} deep"
    )


def test_too_many_values_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(yaml_builder, "MAX_NODES", 1000)
    assert refused("a: [" + "1, " * 997 + "]") == []
    (message,) = refused("a: [" + "1, " * 998 + "]")
    assert message.startswith("f:1:2996: a task file must have at most 1000 keys and values")


def test_aliases_cannot_blow_up() -> None:
    lines = ["a0: &a0 [x, x]"] + [f"a{n}: &a{n} [*a{n - 1}, *a{n - 1}]" for n in range(1, 40)]
    assert len(refused("\n".join(lines))) == 2 * 39


def test_a_tag_runs_nothing(tmp_path: Path, issues: Issues, text: str) -> None:
    mark = tmp_path / "ran"
    attack = f"seed: !!python/object/apply:os.system ['touch {mark}']"
    (found,) = issues(text.replace("seed: 7", attack))
    assert "!!python/object/apply:os.system" in str(found)
    assert not mark.exists()


def test_what_cannot_be_read_is_not_called_wrong_as_well(issues: Issues, text: str) -> None:
    text = text.replace("mass: 5", "mass: !kg 5").replace("seed: 7", "seed: *a").replace("drum, goal]", "drum, *b]")
    assert [issue.where for issue in issues(text)] == ["t.yaml:12:41", "t.yaml:21:20", "t.yaml:24:7"]


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.yaml: must be a task file; got no file of this name"):
        load_task(tmp_path / "none.yaml")


def test_a_folder_is_no_task_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="must be a task file; got a folder"):
        load_task(tmp_path)


def test_a_name_that_no_file_can_have_is_refused() -> None:
    with pytest.raises(InputError, match="cannot read the file"):
        load_task(Path("a\0b"))
    with pytest.raises(InputError, match="cannot read the file"):
        load_task(Path("a" * 5000))


def _only_refused(raw: bytes, domain: Domain) -> Task | None:
    """Load bytes like a file. Only the exception `InputError` is accepted."""
    try:
        return load_task_text(decode(raw, "f"), "f", lambda name: domain)
    except InputError as error:
        issues = error.issues
    assert issues
    assert all(str(issue).startswith("f:") for issue in issues)
    return None


@given(raw=st.binary(max_size=300))
def test_random_bytes_are_refused(toy: Domain, raw: bytes) -> None:
    assert _only_refused(raw, toy) is None


_YAML = st.text(alphabet="ab1-:?,[]{}#&*!|>'\"%@`\\\n\r\t ~<=.0xeu_\x85\u2028é😀", max_size=60)


@settings(max_examples=500)
@given(text=_YAML)
def test_random_yaml_is_refused(toy: Domain, text: str) -> None:
    assert _only_refused(text.encode(), toy) is None


_EDITS = st.lists(st.tuples(st.floats(0, 1), st.integers(0, 12), _YAML), min_size=1, max_size=3)


@settings(max_examples=300)
@given(edits=_EDITS)
def test_mutations_of_a_file_are_loaded_or_refused(toy: Domain, text: str, edits: list[tuple[float, int, str]]) -> None:
    for share, cut, new in edits:
        place = int(share * len(text))
        text = text[:place] + new + text[place + cut :]
    task = _only_refused(text.encode(), toy)
    assert task is None or task.domain is toy


_VALUES = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.sampled_from(["hand", "drum", "goal", "within", "REGION", "cylinder", "x"]),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.sampled_from(["not", "within", "x"]), inner),
    max_leaves=6,
)


_PARTS = (
    "[hand]",
    "{force: 300}",
    "[ROLLABLE]",
    "[0, 0, 2]",
    "{kind: cylinder, radius: 0.1, length: 0.3}",
    "{position: [0.8, 0, 0]}",
    "{hand: GUARDING}",
    "\n  - within: [drum, goal]",
    "[drum, goal]",
    "fast-downward",
    "30",
    "7",
    "toy",
    "5",
)


@settings(max_examples=300)
@given(old=st.sampled_from(_PARTS), new=_VALUES)
def test_any_value_anywhere_is_loaded_or_refused(toy: Domain, text: str, old: str, new: object) -> None:
    assert old in text
    task = _only_refused(text.replace(old, " " + _flow(new)).encode(), toy)
    assert task is None or task.domain is toy


def _flow(value: object) -> str:
    if isinstance(value, list):
        return "[" + ", ".join(map(_flow, value)) + "]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {_flow(item)}" for key, item in value.items()) + "}"
    if value is None or isinstance(value, bool):
        return str(value).lower().replace("none", "null")
    return str(value).replace("inf", ".inf").replace("nan", ".nan") if isinstance(value, float) else str(value)
