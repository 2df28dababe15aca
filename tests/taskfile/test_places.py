"""Bodies that start in the air, regions that are not on the floor, and places that are too small for two bodies."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from texts import load_task_text

import hybrid_tamp
from hybrid_tamp.errors import InputError
from hybrid_tamp.model.task import Task
from hybrid_tamp.taskfile.loader import load_task
from hybrid_tamp.taskfile.making import make_task

ROOT = Path(__file__).parents[2]
LYING = [math.pi / 2, 0.0, 0.0]


def drum(x: float, z: float = 0.1, *, radius: float = 0.1, **changes: Any) -> dict[str, Any]:
    token = {
        "classes": ["ROLLABLE"],
        "properties": {"axis_of_rotation": [0, 0, 1], "radius_of_rotation": radius, "mass": 5, "friction": 0.6},
        "shape": {"kind": "cylinder", "radius": radius, "length": 0.3},
        "pose": {"position": [x, 0, z], "rpy": LYING},
    }
    return {**token, **changes}


def ball(x: float, z: float, radius: float) -> dict[str, Any]:
    return drum(x, z, radius=radius, shape={"kind": "sphere", "radius": radius}, pose={"position": [x, 0, z]})


def mesh_drum(x: float, z: float) -> dict[str, Any]:
    path = str(ROOT / "problems" / "meshes" / "cylinder.obj")
    rolls = {"axis_of_rotation": [0, 1, 0], "radius_of_rotation": 0.1, "mass": 5, "friction": 0.6}
    return drum(x, shape={"kind": "mesh", "file": path}, properties=rolls, pose={"position": [x, 0, z]})


def region(x: float, z: float = 0.0, radius: float = 0.02, **pose: Any) -> dict[str, Any]:
    return {"classes": ["REGION"], "properties": {"radius": radius}, "pose": {"position": [x, 0, z], **pose}}


HAND = {
    "classes": ["STATIC END-EFFECTOR"],
    "properties": {
        "radius": 0.035,
        "length": 0.16,
        "mass": 1.5,
        "maximal_force": 300,
        "workspace_lower": [-3, -3, 0],
        "workspace_upper": [3, 3, 1.2],
    },
    "pose": {"position": [0.25, -0.45, 0.3]},
}


def crate(x: float, halves: tuple[float, float, float] = (0.2, 0.2, 0.2), **changes: Any) -> dict[str, Any]:
    thing = {"classes": ["TOKEN"], "shape": {"kind": "box", "half_extents": list(halves)}}
    return {**thing, "pose": {"position": [x, 0, halves[2]]}, **changes}


def rolling(atoms: list[Any], **tokens: dict[str, Any]) -> Task:
    return make_task("rolling_tumbling", tokens, atoms)


def refusal(atoms: list[Any], **tokens: dict[str, Any]) -> str:
    with pytest.raises(InputError) as caught:
        rolling(atoms, **tokens)
    (issue,) = caught.value.issues
    return str(issue)


GOAL = [{"inside": ["thing", "goal"]}]


@pytest.mark.parametrize(
    "thing", [drum(0, 0.3), ball(0, 0.3, 0.1), mesh_drum(0, 0.3), drum(0, 0.35, pose={"position": [0, 0, 0.35]})]
)
def test_a_rollable_body_in_the_air(thing: dict[str, Any]) -> None:
    said = refusal(GOAL, thing=thing, goal=region(0.7))
    assert "must rest on the floor or on another body, but it is 0.2" in said
    assert said.endswith("m above the floor")
    assert said.startswith("tokens.thing.pose")


def test_a_body_on_another_body_is_supported() -> None:
    rolling(GOAL, thing=drum(0, 0.5), crate=crate(0), goal=region(0.7))
    rolling(GOAL, thing=ball(0, 0.7, 0.1), middle=drum(0, 0.5), crate=crate(0), goal=region(0.7))


@pytest.mark.parametrize(
    ("thing", "words"),
    [
        (drum(0, 0.6), "0.1 m above crate"),
        (drum(0.35, 0.6), "0.5 m above the floor"),
        # The ball touches only the side of the crate.
        (ball(0.3, 0.3, 0.1), "0.2 m above the floor"),
        # The ball would fall onto the edge of the crate: its centre ends sqrt(0.1^2 - 0.05^2) m above the top.
        (ball(0.25, 0.6, 0.1), "0.1134 m above crate"),
    ],
)
def test_the_height_above_the_body_below(thing: dict[str, Any], words: str) -> None:
    said = refusal(GOAL, thing=thing, crate=crate(0), goal=region(0.7))
    height = float(said.split("it is ")[1].split(" m ")[0])
    assert said.endswith(words.split(" ", 2)[2])
    assert height == pytest.approx(float(words.split()[0]), abs=2e-3)


@pytest.mark.parametrize(("name", "old", "new", "above"), [
    ("hammer_push", "position: [0.1, 0, 0.06]", "position: [0.1, 0, 0.26]", "0.2 m above the floor"),
    ("hammer_push", "position: [-0.25, 0, 0.04]", "position: [-0.25, 0, 0.09]", "0.05 m above the floor"),
    ("hammer_strike", "position: [-0.25, 0, 0.04]", "position: [-0.25, 0, 0.14]", "0.1 m above the floor"),
])  # fmt: skip
def test_blocks_and_tools_in_the_air(name: str, old: str, new: str, above: str) -> None:
    text = (ROOT / "problems" / f"{name}.yaml").read_text(encoding="utf-8")
    assert old in text
    with pytest.raises(InputError, match=above):
        load_task_text(text.replace(old, new), name)


@pytest.mark.parametrize(
    ("height", "where"),
    [(0.5, "it is 0.5 m above the floor"), (0.02, "it is 0.02 m above the floor"), (-0.05, "it is at z = -0.05 m")],
)
def test_a_region_is_on_the_floor(height: float, where: str) -> None:
    assert where in refusal(GOAL, thing=drum(0), goal=region(0.7, height))
    rolling(GOAL, thing=drum(0), goal=region(0.7, math.copysign(0.009, height)))


def test_a_region_is_level() -> None:
    assert "20 degrees" in refusal(GOAL, thing=drum(0), goal=region(0.7, rpy=[math.radians(20), 0, 0]))
    rolling(GOAL, thing=drum(0), goal=region(0.7, rpy=[0, 0, 1.0]))


BOTH = [{"inside": ["thing", "goal"]}, {"inside": ["other", "goal"]}]


@pytest.mark.parametrize(
    ("thing", "other", "radius", "needed"),
    [
        (drum(0), drum(2.0), 0.02, 0.2),
        (drum(0), drum(2.0), 0.095, 0.2),
        (ball(0, 0.05, 0.05), ball(2.0, 0.05, 0.05), 0.045, 0.1),
        (ball(0, 0.05, 0.05), drum(2.0), 0.05, 0.14),
        (mesh_drum(0, 0.1), mesh_drum(2.0, 0.1), 0.02, 0.083),
    ],
)
def test_two_things_for_one_region(thing: Any, other: Any, radius: float, needed: float) -> None:
    said = refusal(BOTH, thing=thing, other=other, goal=region(0.7, radius=radius))
    assert "inside(thing, goal) and inside(other, goal) cannot both hold" in said
    assert f"at most {2 * radius:.3g} m, but must be at least" in said
    assert float(said.split("at least ")[1].split(" m")[0]) == pytest.approx(needed, rel=0.05)
    rolling(BOTH, thing=thing, other=other, goal=region(0.7, radius=0.105))


def test_two_regions_side_by_side() -> None:
    goal = [{"inside": ["thing", "goal"]}, {"inside": ["other", "second"]}]
    things = {"thing": drum(0), "other": drum(2.0), "goal": region(0.7)}
    assert "at most 0.14 m" in refusal(goal, **things, second=region(0.8))
    rolling(goal, **things, second=region(0.87))


def test_a_choice_that_crowds_a_place_is_not_planned() -> None:
    things = {"hand": HAND, "thing": drum(0), "other": drum(2.0), "goal": region(0.7), "second": region(1.2)}
    task = rolling([{"inside": ["thing", "*"]}, {"inside": ["other", "*"]}], **things)
    plan = hybrid_tamp.plan(task)
    assert plan.chosen is not None
    assert len({atom.arguments[1] for atom in plan.chosen.goal}) == 2
    del things["second"]
    said = refusal([{"inside": ["thing", "*"]}, {"inside": ["other", "*"]}], **things)
    assert "cannot both hold" in said


def test_what_is_there_already_may_stay() -> None:
    # A thin disc on another disc: both are inside the region, and nothing has to move.
    flat = {"shape": {"kind": "cylinder", "radius": 0.1, "length": 0.06}}
    one, other = (drum(0.7, z, **flat, pose={"position": [0.7, 0, z]}) for z in (0.03, 0.09))
    rolling(BOTH, thing=one, other=other, goal=region(0.7))
    assert "cannot both hold" in refusal(BOTH, thing=one, other=drum(2.0), goal=region(0.7))


@pytest.mark.parametrize(("x", "fits"), [(0.7, False), (0.75, False), (0.9, False), (1.1, True)])
def test_a_body_that_no_block_moves(x: float, fits: bool) -> None:
    things = {"thing": drum(0), "crate": crate(x), "goal": region(0.7, radius=0.05)}
    if fits:
        rolling(GOAL, **things)
    else:
        said = refusal(GOAL, **things)
        assert "inside(thing, goal) is impossible, because crate stands there and no block moves it" in said
        assert "but must be at least 0.1 m" in said


def test_a_body_that_a_block_moves_may_be_moved_away() -> None:
    box = crate(0.7, classes=["TUMBLABLE"], properties={"half_extents": [0.2, 0.2, 0.2], "mass": 5, "friction": 0.6})
    rolling(GOAL, thing=drum(0), crate=box, goal=region(0.7, radius=0.05))


@given(st.floats(0.03, 0.3), st.floats(0.03, 0.3), st.floats(0.0, 1.0))
@settings(max_examples=25, deadline=None)
def test_only_what_is_impossible_is_refused(one: float, other: float, share: float) -> None:
    """Two spheres on the floor keep the horizontal distance 2 sqrt(r s)."""
    needed = 2 * math.sqrt(one * other)
    radius = needed / 2 * (0.6 + 0.8 * share)
    things = {"thing": ball(0, one, one), "other": ball(2.0, other, other), "goal": region(0.7, radius=radius)}
    if 2 * radius >= needed:
        rolling(BOTH, **things)
    elif 2 * radius < 0.85 * needed - 0.005 and max(one, other) < 2 * min(one, other):
        assert "cannot both hold" in refusal(BOTH, **things)


def test_all_bundled_tasks_are_accepted() -> None:
    for path in (ROOT / "problems").glob("*.yaml"):
        assert np.isfinite(load_task(path).state.values).all()
