"""A file without faults is loaded as the task that it describes."""

import json
import math
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from ruamel.yaml import YAML
from texts import load_task_text

from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.task import DEFAULT_PLANNER, Limits, Task
from hybrid_tamp.taskfile.loader import load_task

Load = Callable[[str], Task]


def test_the_task_says_what_the_file_says(load: Load, text: str, toy: Domain) -> None:
    task = load(text)
    assert (task.name, task.domain, task.planner, task.seed) == ("t.yaml", toy, "fast-downward", 7)
    assert task.limits == Limits(30.0, 1024.0, 2)
    assert [token.name for token in task.tokens] == ["hand", "drum", "goal"]
    assert task.agents == {"robot": ("hand",)}
    assert task.goal == (Atom("within", ("drum", "goal")),)
    assert task.assignment == {"hand": "GUARDING", "drum": "RESTING"}
    assert task.token_by_name["drum"]["axis"] == (0.0, 0.0, 1.0)
    assert task.token_by_name["drum"]["friction"] == 0.5
    assert task.source is None


def test_poses_are_those_of_the_file_also_of_places(load: Load, text: str) -> None:
    state = load(text).state
    half = math.sqrt(0.5)
    np.testing.assert_allclose(state["drum", "position"], [0, 0, 0.1])
    np.testing.assert_allclose(state["drum", "orientation"], [half, 0, 0, half], atol=1e-12)
    np.testing.assert_allclose(state["goal", "position"], [0.8, 0, 0])
    np.testing.assert_allclose(state["hand", "orientation"], [0, 0, 0, 1])


def test_a_quaternion_is_normalised(load: Load, text: str) -> None:
    text = text.replace("[0, 0, 0.1], rpy: [1.5707963267948966, 0, 0]", "[0, 0, 0.15], quaternion: [0, 0, 2, 0]")
    state = load(text).state
    np.testing.assert_allclose(state["drum", "orientation"], [0, 0, 1, 0])


def test_what_is_optional_may_be_left_out(load: Load, text: str) -> None:
    kept = text[: text.index("assignment")] + "goal:\n  - within: [drum, goal]\n"
    task = load(kept.replace("agents:\n  robot: [hand]\n", ""))
    assert task.goal == (Atom("within", ("drum", "goal")),)
    assert (task.planner, task.limits, task.seed, task.agents) == (DEFAULT_PLANNER, Limits(), 0, {})
    assert task.assignment == {"hand": "RESTING", "drum": "RESTING"}


def test_an_atom_that_stands_twice_counts_once(load: Load, text: str) -> None:
    task = load(text.replace("  - within: [drum, goal]\n", "  - within: [drum, goal]\n" * 2))
    assert task.goal == (Atom("within", ("drum", "goal")),)


def test_a_symbol_is_an_argument(load: Load, text: str) -> None:
    assert load(text.replace("within: [drum, goal]", "shows: [drum, back]")).goal == (Atom("shows", ("drum", "back")),)


def test_classes_that_share_a_property_make_one_token(load: Load, text: str) -> None:
    drum = load(text.replace("[ROLLABLE]", "[HEAVY, TOKEN, ROLLABLE]")).token_by_name["drum"]
    assert [member.name for member in drum.classes] == ["HEAVY", "ROLLABLE", "TOKEN"]
    assert drum["mass"] == 5


def test_a_place_without_a_position_needs_no_pose(load: Load, text: str) -> None:
    task = load(text.replace("assignment:", "  thought: {classes: [IDEA]}\nassignment:"))
    assert task.token_by_name["thought"].place


def test_a_file_is_named_by_its_stem_or_by_itself(tmp_path: Path, text: str, toy: Domain) -> None:
    path = tmp_path / "roll it.yaml"
    path.write_bytes(b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode())
    task = load_task(path, lambda name: toy)
    assert (task.name, task.source) == ("roll it", path)
    assert load_task_text(text + "name: mine\n", "x", lambda name: toy).name == "mine"


def test_numbers_and_words_are_those_of_yaml_1_2(load: Load, text: str) -> None:
    task = load(text.replace("hand", "no").replace("seed: 7", "seed: 010").replace("time: 30", "time: 0x1F"))
    assert "no" in task.token_by_name
    assert (task.seed, task.limits.time) == (10, 31.0)
    assert load(text.replace("seed: 7", "seed: 0o17").replace("mass: 5", "mass: 5e-1")).seed == 15


def test_a_json_file_is_a_task_file(load: Load, text: str) -> None:
    plain = json.dumps(YAML(typ="safe", pure=True).load(text))
    assert load(plain).goal == load(text).goal


@pytest.mark.parametrize("names", [["2go-now?", "At Robot", "and"], ["ß", "SS", "ss"], ["Drum", "drum", "DRUM"]])
def test_names_that_hurt_others_come_back_as_written(load: Load, text: str, names: list[str]) -> None:
    for mine, theirs in zip(("hand", "drum", "goal"), names, strict=True):
        text = _renamed(text, mine, json.dumps(theirs))
    assert [token.name for token in load(text).tokens] == names


# A key of YAML has at most 1024 characters, and an escape up to 12.
_NAMES = st.lists(
    st.text(min_size=1, max_size=80).filter(lambda name: name.isprintable() and name not in ("*", "front", "back")),
    min_size=3,
    max_size=3,
    unique=True,
)


@given(names=_NAMES, ascii_only=st.booleans())
def test_any_names_come_back_as_written(load: Load, text: str, names: list[str], ascii_only: bool) -> None:
    for mine, theirs in zip(("hand", "drum", "goal"), names, strict=True):
        text = _renamed(text, mine, _quoted(theirs, ascii_only))
    task = load(text)
    assert [token.name for token in task.tokens] == names
    assert task.goal == (Atom("within", (names[1], names[2])),)
    assert task.agents == {"robot": (names[0],)}


def _quoted(name: str, ascii_only: bool) -> str:
    r"""Return a name in double quotes, either with the escapes of JSON, or with unchanged printable characters."""
    if ascii_only:
        return json.dumps(name)
    return '"' + "".join(c if c.isprintable() and c not in '"\\' else json.dumps(c)[1:-1] for c in name) + '"'


def _renamed(text: str, mine: str, theirs: str) -> str:
    """Replace the name of a token everywhere in the file. Names that are already in quotes do not change."""
    for before, after in (("  ", ":"), ("[", "]"), ("[", ","), (" ", "]"), ("{", ":")):
        text = text.replace(f"{before}{mine}{after}", f"{before}{theirs} {after}")
    return text


def test_loading_is_light() -> None:
    code = (
        "import sys, hybrid_tamp.taskfile.loader, hybrid_tamp.taskfile.schema;"
        "heavy = {'unified_planning', 'pybullet', 'scipy', 'matplotlib'} & set(sys.modules);"
        "sys.exit(', '.join(heavy) or 0)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
