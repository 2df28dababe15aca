"""Domains are found by installed name, by module or by path. Otherwise the message lists the available names."""

import sys
from pathlib import Path

import pytest
from texts import load_task_text

from hybrid_tamp.errors import InputError
from hybrid_tamp.taskfile import domains
from hybrid_tamp.taskfile.domains import (
    available_domains,
    bundled_tasks,
    find_domain,
    find_task_file,
    installed_domain,
)
from hybrid_tamp.taskfile.loader import load_task

SOURCE = """\
from hybrid_tamp.model.affordance import TOKEN, PlaceClass
from hybrid_tamp.model.block import Block, Duration, Slot
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.network import ReassignmentNetwork


class Spot(PlaceClass):
    name = "SPOT"


REST = Block("RESTING", (Slot("token", TOKEN),), "token", Duration(1, 2, lambda *_: 1.0), hold=True)
DOMAIN = Domain("mine", (Spot,), (), (REST,), ReassignmentNetwork([("RESTING.token", "RESTING.token")]))
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "mine.py"
    path.write_text(SOURCE)
    return path


def test_an_installed_domain_is_found_by_its_name() -> None:
    assert "rolling_tumbling" in available_domains()
    assert find_domain("rolling_tumbling") is installed_domain("rolling_tumbling")
    assert find_domain("hybrid_tamp_domains.rolling_tumbling:DOMAIN") is find_domain("rolling_tumbling")


def test_an_installed_domain_is_the_same_by_its_path() -> None:
    domain = find_domain("rolling_tumbling")
    path = sys.modules["hybrid_tamp_domains.rolling_tumbling"].__file__
    assert path is not None
    assert find_domain(path) is domain


def test_one_file_gives_one_domain(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = find_domain(str(file))
    monkeypatch.chdir(file.parent)
    assert find_domain("./mine.py") is first
    assert find_domain(f"../{file.parent.name}/mine.py") is first
    assert first.name == "mine"


def test_two_files_of_one_name_are_two(file: Path, tmp_path: Path) -> None:
    other = tmp_path / "other" / "mine.py"
    other.parent.mkdir()
    other.write_text(SOURCE)
    assert find_domain(str(other)).classes[0] is not find_domain(str(file)).classes[0]


def test_an_unknown_name_says_what_there_is() -> None:
    with pytest.raises(InputError, match=r"unknown domain; got 'roling_tumbling'; did you mean 'rolling_tumbling'\?"):
        find_domain("roling_tumbling")
    with pytest.raises(InputError, match=r"package\.module:ATTRIBUTE"):
        find_domain("no such thing")


def test_a_path_without_a_file_is_named() -> None:
    with pytest.raises(InputError, match=r"the file of the domain must exist; got '.*nothing\.py'"):
        find_domain("nothing.py")
    with pytest.raises(InputError, match="the file of the domain must exist"):
        find_domain("a\0.py")


@pytest.mark.parametrize(
    ("source", "words"),
    [
        ("x = 1\ny = 1 / 0\n", r"bad\.py:2:1: cannot import the domain's module; got ZeroDivisionError"),
        ("x = (\n", r"bad\.py:1:\d+: cannot import the domain's module; got SyntaxError"),
        ("import sys\nsys.exit(3)\n", r"bad\.py:2:1: cannot import the domain's module; got SystemExit: 3"),
        ("from . import x\n", r"bad\.py:1:1: cannot import the domain's module; got ImportError"),
        ("X = 1\n", r"bad\.py: the module must define DOMAIN"),
        ("DOMAIN = 1\n", r"bad\.py: the domain must be an instance of hybrid_tamp\.Domain; got int"),
        (SOURCE.replace('"RESTING", (', '"REST", ('), r"bad\.py: the domain's declarations contradict each other"),
    ],
    ids=["raises", "no Python", "exits", "needs a package", "no domain", "another thing", "contradicts itself"],
)
def test_a_file_that_does_not_load_is_named_every_time(tmp_path: Path, source: str, words: str) -> None:
    path = tmp_path / "bad.py"
    path.write_text(source)
    for _ in range(2):
        with pytest.raises(InputError, match=words):
            find_domain(str(path))


def test_a_module_that_does_not_load_is_named() -> None:
    with pytest.raises(InputError, match="hybrid_tamp_nowhere: cannot import the domain's module; got ModuleNot"):
        find_domain("hybrid_tamp_nowhere:DOMAIN")


@pytest.mark.parametrize("form", ["{file}", "mine:DOMAIN"])
def test_a_task_file_cannot_start_code(file: Path, text: str, monkeypatch: pytest.MonkeyPatch, form: str) -> None:
    file.write_text("raise SystemExit('ran')")
    monkeypatch.syspath_prepend(str(file.parent))
    wrong = text.replace("domain: toy", f'domain: "{form.format(file=file)}"')
    with pytest.raises(
        InputError, match=r"t:2:9: unknown domain.*a task file cannot refer to code, so install the domain"
    ):
        load_task_text(wrong, "t")


def test_a_caller_may_let_a_task_file_name_a_path(file: Path) -> None:
    text = f'domain: "{file}"\ntokens: {{a: {{classes: [TOKEN], pose: {{position: [0, 0, 0]}}}}}}\ngoal: [x: [a]]\n'
    with pytest.raises(InputError, match="t:3:8: unknown predicate in the domain mine"):
        load_task_text(text, "t", find_domain)


@pytest.mark.parametrize("name", ["roll_cylinder", "roll_cylinder.yaml", "problems/roll_cylinder.yaml"])
def test_a_bundled_task_is_found_by_name_from_any_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "roll_cylinder").mkdir()
    path = find_task_file(name)
    assert path.is_absolute()
    assert path.name == "roll_cylinder.yaml"
    task = load_task(name)
    assert (task.name, task.source) == ("roll_cylinder", path)
    assert load_task(task) is task


def test_a_file_that_is_there_goes_before_a_bundled_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "roll_cylinder.yaml").touch()
    assert find_task_file("roll_cylinder.yaml") == Path("roll_cylinder.yaml")
    assert find_task_file(str(tmp_path)) == tmp_path


def test_an_unknown_task_says_what_is_bundled(monkeypatch: pytest.MonkeyPatch) -> None:
    assert "roll_cylinder" in bundled_tasks()
    with pytest.raises(InputError, match=r"'rol_cylinder'; did you mean 'roll_cylinder'\?"):
        find_task_file("rol_cylinder")
    with pytest.raises(InputError, match="neither a task file nor a bundled task"):
        find_task_file("elsewhere/roll_cylinder.yaml")
    for impossible in ("a\0b", "a" * 5000):
        with pytest.raises(InputError, match="neither a task file nor a bundled task"):
            find_task_file(impossible)
    monkeypatch.setattr(domains, "PROBLEMS", "hybrid_tamp_no_problems")
    assert bundled_tasks() == ()
