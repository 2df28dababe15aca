"""Tokens without affordances: their mass and friction, and bodies that nothing can move."""

from pathlib import Path
from typing import Any

import pytest

import hybrid_tamp
from hybrid_tamp.errors import InputError
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.scene import make_bodies
from hybrid_tamp.taskfile.saving import differences

BOX = {"kind": "box", "half_extents": [0.1, 0.1, 0.1]}


def task_with(**tokens: dict[str, Any]) -> Task:
    """Return a task in which a drum rolls, with further tokens."""
    base = hybrid_tamp.load_task("roll_cylinder")
    entries = {
        token.name: {
            "classes": [member for member in token.classes if member.name != "TOKEN"],
            "properties": dict(token.properties),
            "shape": None if token.shape is None else token.shape.model_dump(),
            "pose": {
                key: base.state[token, source].tolist()
                for key, source in (("position", "position"), ("quaternion", "orientation"))
                if (token.name, source) in base.state.layout.slices
            },
        }
        for token in base.tokens
    }
    return hybrid_tamp.make_task(base.domain, {**entries, **tokens}, base.goal, agents=base.agents)


def crate(x: float, z: float = 0.1, **entry: Any) -> dict[str, Any]:
    """Return the entry of a cube with edges of 0.2 m."""
    return {"classes": ["TOKEN"], "shape": BOX, "pose": {"position": [x, 0.6, z]}, **entry}


def test_a_crate_has_the_mass_and_the_friction_that_the_file_gives() -> None:
    task = task_with(heavy=crate(0.3, properties={"mass": 30.0, "friction": 0.2}), plain=crate(-0.3))
    bodies = {body.token: body for body in make_bodies(task)}
    assert (bodies["heavy"].mass, bodies["heavy"].friction) == (30.0, 0.2)
    assert (bodies["plain"].mass, bodies["plain"].friction) == (1.0, 0.5)


def test_a_fixed_body_may_hang_in_the_air_and_overlap_other_fixed_bodies() -> None:
    task = task_with(shelf=crate(0.3, 0.8, fixed=True), wall=crate(0.4, 0.8, fixed=True))
    assert [body.mass for body in make_bodies(task) if body.token in ("shelf", "wall")] == [0.0, 0.0]


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        ({"properties": {"mass": 0.0}}, "must be more than 0 [kg]; got 0.0"),
        ({"properties": {"wieght": 1.0}}, "unknown key in properties of token 'crate'; got 'wieght'"),
        ({"pose": {"position": [0.3, 0.6, 0.4]}}, "it is 0.3 m above the floor"),
        ({"pose": {"position": [0.3, 0.6, 0.4]}}, "write 'fixed: true'"),
        ({"pose": {"position": [0.3, 0.6, 0.05]}, "fixed": True}, "a lowest point at z = -0.05 m"),
        ({"pose": {"position": [0.0, 0.1, 0.1]}, "fixed": True}, "must not overlap other tokens"),
        ({"classes": ["ROLLABLE"], "fixed": True}, "a fixed token must be a member of TOKEN only; got ROLLABLE"),
    ],
)
def test_a_wrong_bystander_is_refused(entry: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError) as refused:
        task_with(crate={**crate(0.3), **entry})
    assert said in str(refused.value)


def test_a_bystander_is_saved_and_loaded(tmp_path: Path) -> None:
    task = task_with(wall=crate(0.3, 0.5, fixed=True), heavy=crate(-0.3, properties={"mass": 30.0}))
    hybrid_tamp.save_task(task, tmp_path / "task.yaml")
    again = hybrid_tamp.load_task(tmp_path / "task.yaml")
    assert not differences(task, again)
    assert again.token_by_name["wall"].immovable
