"""Tasks with tables: what rests on what, where regions may lie, and what is refused."""

from typing import Any

import numpy as np
import pytest

import hybrid_tamp
from hybrid_tamp.errors import InputError
from hybrid_tamp.feasibility.safety_figures import describe_shortfall
from hybrid_tamp.model.ground import ON_FLOOR
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.task import Task
from tests.taskfile.test_bystanders import crate, task_with

WALL = crate(0.3, fixed=True)
"""A fixed cube with edges of 0.2 m on the floor. Its centre is at x = 0.3 m, y = 0.6 m."""


def spot(z: float, x: float = 0.3, radius: float = 0.05) -> dict[str, Any]:
    """Return the entry of a region above the cube."""
    return {"classes": ["REGION"], "properties": {"radius": radius}, "pose": {"position": [x, 0.6, z]}}


def table_with(**tokens: dict[str, Any]) -> Task:
    """Return the task in which a drum rolls on a table, with further tokens."""
    task = hybrid_tamp.load_task("roll_on_table")
    entries = {
        token.name: {
            "classes": [member.name for member in token.classes if member.name != "TOKEN"] or ["TOKEN"],
            "properties": dict(token.properties),
            "shape": None if token.shape is None else token.shape.model_dump(),
            "fixed": token.immovable,
            "pose": {
                "position": task.state[token, "position"].tolist(),
                "quaternion": task.state[token, "orientation"].tolist(),
            },
        }
        for token in task.tokens
    }
    entries = {name: {k: v for k, v in entry.items() if v is not False} for name, entry in entries.items()}
    return hybrid_tamp.make_task(task.domain, {**entries, **tokens}, task.goal, agents=task.agents)


def fails(task: Task, name: str, *arguments: str) -> str:
    """Return why a fact does not hold in a task."""
    predicate, values = task.domain.predicate_by_name[name], tuple(map(task.value, arguments))
    margin = task.margin(Atom(name, arguments))
    assert margin < 0
    return describe_shortfall(task, predicate, values, margin)


def test_a_drum_on_a_table_knows_its_ground() -> None:
    ground = hybrid_tamp.load_task("roll_on_table").token_by_name["drum"].ground
    assert (ground.body, ground.friction, ground.fixed) == ("table", 0.7, True)
    assert ground.height == pytest.approx(0.7)
    # The top covers -0.3 <= x <= 1.1 and -0.4 <= y <= 0.4.
    assert np.allclose(ground.depth(np.array([[0.0, 0.0], [1.0, 0.1], [1.2, 0.0]])), [0.3, 0.1, -0.1])


def test_bodies_on_the_floor_rest_on_the_floor() -> None:
    assert all(token.ground == ON_FLOOR for token in hybrid_tamp.load_task("roll_around_wall").tokens)


def test_the_parts_of_a_fixed_body_may_have_any_centre_of_mass() -> None:
    assert table_with().token_by_name["table"].immovable


@pytest.mark.parametrize(
    ("tokens", "said"),
    [
        ({"spot": spot(0.0)}, "the centre of the disc is 0.1 m inside wall"),
        ({"spot": spot(0.0, x=0.36)}, "the centre of the disc is 0.04 m inside wall"),
        ({"spot": spot(0.15)}, "the centre of the disc is 0.03 m inside wall"),
        ({"spot": spot(0.4)}, "it is 0.2 m above the top of wall"),
        ({"spot": spot(0.3, x=-0.5)}, "it is 0.3 m above the floor"),
        ({"spot": spot(-0.2, x=-0.5)}, "must not be below the floor (z = 0), but it is at z = -0.2 m"),
        ({"spot": spot(0.2, x=0.38)}, "the disc reaches 0.03 m beyond the edge of wall"),
        ({"wall": crate(0.3), "spot": spot(0.2)}, "but wall is not fixed"),
        ({"wall": crate(0.3, 0.05, fixed=True)}, "a lowest point at z = -0.05 m; raise the token by 0.05 m"),
        ({"wall": {**WALL, "pose": {"position": [0.0, 0.1, 0.1]}}}, "an overlap with token 'drum'"),
        ({"wall": {**WALL, "velocity": [1.0, 0.0, 0.0]}}, "unknown key in token 'wall'; got 'velocity'"),
    ],
)
def test_a_wrong_place_is_refused_with_names_and_figures(tokens: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError) as refused:
        task_with(**{"wall": WALL, **tokens})
    assert said in str(refused.value)


def test_a_fixed_body_with_a_velocity_is_refused() -> None:
    task = table_with()
    moving = task.replaced(state=task.state.replace({("table", "velocity"): [0.0, 3.0, 0.0]}))
    with pytest.raises(InputError, match="token table: a fixed body must have no velocity; got 3 m/s"):
        hybrid_tamp.load_task(moving)


def test_a_region_at_another_height_is_refused_with_its_height() -> None:
    low = table_with(goal={"classes": ["REGION"], "properties": {"radius": 0.02}, "pose": {"position": [1.3, 0, 0]}})
    assert fails(low, "level_with", "drum", "goal").startswith("goal lies 0.7 m below the top of table")


def test_a_region_on_another_table_of_the_same_height_is_refused() -> None:
    other = {"classes": ["TOKEN"], "fixed": True, "shape": {"kind": "box", "half_extents": [0.2, 0.4, 0.35]}}
    goal = {"classes": ["REGION"], "properties": {"radius": 0.02}, "pose": {"position": [1.4, 0, 0.7]}}
    task = table_with(shelf={**other, "pose": {"position": [1.4, 0, 0.35]}}, goal=goal)
    said = fails(task, "level_with", "drum", "goal")
    assert said.startswith("the middle of goal is 0.3 m beyond the edge of table")


def test_nothing_may_lie_on_what_is_moved() -> None:
    box = {"classes": ["TOKEN"], "shape": {"kind": "box", "half_extents": [0.02, 0.02, 0.02]}}
    task = table_with(cup={**box, "pose": {"position": [0, 0, 0.92]}})
    assert task.token_by_name["drum"].burden == ("cup",)
    assert fails(task, "free_to_move", "drum").startswith("cup lies on it")


def test_a_body_on_a_loose_body_is_not_moved() -> None:
    task = hybrid_tamp.load_task("roll_on_table")
    loose = table_with(
        table={"classes": ["TOKEN"], "shape": {"kind": "box", "half_extents": [0.7, 0.4, 0.35]},
               "pose": {"position": [0.4, 0, 0.35]}},
        goal={"classes": ["REGION"], "properties": {"radius": 0.02}, "pose": {"position": [1.3, 0, 0]}},
    )  # fmt: skip
    assert task.margin(Atom("free_to_move", ("drum",))) > 0
    assert fails(loose, "free_to_move", "drum").startswith("it rests on table, which is not fixed")
