"""Goals over all members of a class. `test_faults` contains the tests of messages about faults."""

from collections.abc import Callable
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from hybrid_tamp.errors import InputError
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.predicate import ANY, Atom
from hybrid_tamp.model.task import Task
from hybrid_tamp.taskfile.domains import find_domain
from hybrid_tamp.taskfile.making import make_task
from hybrid_tamp.taskfile.saving import save_task
from hybrid_tamp.taskfile.schema import json_schema
from hybrid_tamp.taskfile.yaml.nodes import parse

Load = Callable[[str], Task]


def with_drums(text: str, goal: str) -> str:
    """Return the text of a task with three drums, a second region and another goal."""
    drum = text[text.index("  drum:") : text.index("  goal:")]
    more = "".join(drum.replace("drum:", f"{name}:").replace("[0, 0, 0.1]", f"[0, {y}, 0.1]") for name, y in MORE)
    region = text[text.index("  goal:") : text.index("assignment")]
    tokens = more + region.replace("goal:", "away:").replace("[0.8, 0, 0]", "[-0.8, 0, 0]")
    return text.replace("  goal:", tokens + "  goal:").replace("within: [drum, goal]", goal).replace("0.02", "5")


MORE = (("keg", 1), ("barrel", 2))
DRUMS = ("drum", "keg", "barrel")


def atoms(predicate: str, *arguments: tuple[str, ...]) -> tuple[Atom, ...]:
    return tuple(Atom(predicate, each) for each in arguments)


@pytest.mark.parametrize(
    ("goal", "expected"),
    [
        ("within: [{all: ROLLABLE}, goal]", atoms("within", *((drum, "goal") for drum in DRUMS))),
        ("within: [all: ROLLABLE, goal]", atoms("within", *((drum, "goal") for drum in DRUMS))),
        ("beside: [{all: ROLLABLE}, keg]", atoms("beside", ("drum", "keg"), ("barrel", "keg"))),
        (
            "beside: [{all: ROLLABLE}, {all: ROLLABLE}]",
            atoms("beside", *((one, other) for one in DRUMS for other in DRUMS if one != other)),
        ),
        ("shows: [{all: ROLLABLE}, back]", atoms("shows", *((drum, "back") for drum in DRUMS))),
        ("within: [{all: ROLLABLE}, '*']", atoms("within", *((drum, ANY) for drum in DRUMS))),
    ],
)
def test_one_atom_for_each_member_in_the_order_of_the_tokens(
    load: Load, text: str, toy: Domain, goal: str, expected: tuple[Atom, ...]
) -> None:
    assert load(with_drums(text, goal)).goal == expected
    data = parse(with_drums(text, goal), "t").data
    assert jsonschema.Draft202012Validator(json_schema([toy])).is_valid(data)


def test_an_atom_that_is_also_written_occurs_once(load: Load, text: str) -> None:
    goal = "within: [keg, goal]\n  - within: [{all: ROLLABLE}, goal]"
    assert load(with_drums(text, goal)).goal == atoms("within", ("keg", "goal"), ("drum", "goal"), ("barrel", "goal"))


def test_each_member_has_its_own_choice(load: Load, text: str) -> None:
    assert len(load(with_drums(text, "within: [{all: ROLLABLE}, '*']")).alternatives()) == 2**3


def test_a_contradiction_names_both_atoms_and_the_line(load: Load, text: str) -> None:
    with pytest.raises(InputError) as caught:
        load(with_drums(text, "within: [keg, away]\n  - within: [{all: ROLLABLE}, goal]"))
    (issue,) = caught.value.issues
    assert "must have only one region for each object" in issue.wanted
    assert issue.came.startswith("within(keg, away) and within(keg, goal), the first on line ")


def test_the_schema_refuses_unknown_classes_and_keys(text: str, toy: Domain) -> None:
    validator = jsonschema.Draft202012Validator(json_schema([toy]))
    for wrong in ("{all: ROLABLE}", "{any: ROLLABLE}", "{all: [ROLLABLE]}", "{}"):
        assert not validator.is_valid(parse(with_drums(text, f"within: [{wrong}, goal]"), "t").data), wrong


def scene(radius: float) -> dict[str, dict[str, object]]:
    """Return the tokens of a task with two drums and a region with the given radius [m]."""
    drum = {
        "classes": ["ROLLABLE"],
        "properties": {"axis_of_rotation": [0, 0, 1], "radius_of_rotation": 0.1, "mass": 5.0, "friction": 0.5},
        "shape": {"kind": "cylinder", "radius": 0.1, "length": 0.3},
    }
    pose = {"rpy": [np.pi / 2, 0, 0]}
    return {
        "one": {**drum, "pose": {**pose, "position": [0, 0, 0.1]}},
        "two": {**drum, "pose": {**pose, "position": [0, 1, 0.1]}},
        "goal": {"classes": ["REGION"], "properties": {"radius": radius}, "pose": {"position": [2.0, 0, 0]}},
    }


def test_tasks_made_in_python_take_classes_and_their_names(tmp_path: Path) -> None:
    domain = find_domain("rolling_tumbling")
    for members in (domain.class_by_name["ROLLABLE"], "ROLLABLE"):
        task = make_task(domain, scene(3.0), [{"inside": [{"all": members}, "goal"]}])
        assert task.goal == atoms("inside", ("one", "goal"), ("two", "goal"))
    save_task(task, tmp_path / "saved.yaml")
    assert "inside: [two, goal]" in (tmp_path / "saved.yaml").read_text()
    with pytest.raises(InputError, match=r"goal\[0\].inside\[0\].all: unknown class in the domain rolling_tumbling"):
        make_task(domain, scene(3.0), [{"inside": [{"all": "ROLABLE"}, "goal"]}])


def test_bodies_that_do_not_fit_are_refused_at_their_entry_of_the_goal() -> None:
    goal = [{"inside": ["one", "goal"]}, {"inside": [{"all": "ROLLABLE"}, "goal"]}]
    with pytest.raises(InputError, match=r"goal\[1\]: the goal must leave enough room for each body"):
        make_task("rolling_tumbling", scene(0.02), goal)
