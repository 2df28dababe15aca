"""Rolling cylinders in PyBullet against closed forms."""

import math
from typing import Any

import numpy as np
import pytest

from hybrid_tamp.geometry.shapes import Compound, Cylinder, CylinderPart
from hybrid_tamp.model.block import FLOOR
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.constants import GRAVITY
from hybrid_tamp.motion.poses import quaternion_from_rpy, rotate
from hybrid_tamp.physics.bullet.backend import BulletBackend
from hybrid_tamp.physics.bullet.solids import place_solids

LYING = (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))  # the body's z axis along -y
SPEED = 0.4


def roll(task: Task, degrees: float, seconds: float) -> State:
    """Return the state after a time on a floor that falls towards +x."""
    angle = math.radians(degrees)
    with BulletBackend((GRAVITY * math.sin(angle), 0.0, -GRAVITY * math.cos(angle))) as backend:
        state = backend.reset(task, task.state)
        for _ in range(round(seconds / backend.timestep)):
            state = backend.step({})
    return state


def drum(toys: Any, shape: Any, radius: float, speed: float, **properties: float) -> Task:
    state = {"position": (0, 0, radius), "orientation": LYING}
    moving = {"velocity": (speed, 0, 0), "angular_velocity": (0, speed / radius, 0)}
    given = {"mass": 5.0, "friction": 0.8, **properties}
    task: Task = toys.world.thing("drum", shape, given, **state, **moving).task()
    return task


SIZES = [(r, length) for r in (0.05, 0.1, 0.2) for length in (0.1, 0.3, 0.6)]
FLAT_AND_THIN = [(0.1, 0.02), (0.1, 0.002), (0.02, 0.1), (0.03, 1.0), (1.0, 0.5)]


@pytest.mark.parametrize("degrees", [0, 1, 3, 5])
@pytest.mark.parametrize(("radius", "length"), [*SIZES, *FLAT_AND_THIN])
def test_a_cylinder_rolls_like_its_closed_form(toys: Any, radius: float, length: float, degrees: float) -> None:
    speed = SPEED if degrees == 0 else 0.0
    end = roll(drum(toys, toys.cylinder(radius, length), radius, speed), degrees, 2.0)
    expected = speed + 2 / 3 * GRAVITY * math.sin(math.radians(degrees)) * 2.0
    assert end["drum", "velocity"][0] == pytest.approx(expected, rel=0.005)
    assert end["drum", "angular_velocity"][1] * radius == pytest.approx(expected, rel=0.005)


def test_a_small_cylinder_may_turn_faster_than_a_hundred_radians_per_second(toys: Any) -> None:
    end = roll(drum(toys, toys.cylinder(0.005, 0.05), 0.005, 0.0), 5, 2.0)
    assert end["drum", "velocity"][0] == pytest.approx(2 / 3 * GRAVITY * math.sin(math.radians(5)) * 2.0, rel=0.005)


def test_a_cylinder_in_a_compound_rolls_like_a_cylinder(toys: Any) -> None:
    cylinder = CylinderPart(kind="cylinder", radius=0.1, length=0.3, position=(0, 0, 0))
    end = roll(drum(toys, Compound(kind="compound", parts=(cylinder,)), 0.1, SPEED), 0, 2.0)
    assert end["drum", "velocity"][0] == pytest.approx(SPEED, rel=0.005)


def test_the_solids_of_a_placed_cylinder_fill_its_length() -> None:
    rpy = (0.3, -0.4, 0.5)
    part = CylinderPart(kind="cylinder", radius=0.1, length=0.3, position=(0.1, 0.2, 0.3), rpy=rpy)
    placed = place_solids(Compound(kind="compound", parts=(part,)), rolls=True)
    axis = rotate(quaternion_from_rpy(rpy), np.array([0.0, 0.0, 1.0]))
    offsets = [np.array(each.position) - part.position for each in placed]
    for offset in offsets:
        assert offset == pytest.approx((offset @ axis) * axis)
    lengths = [each.solid.length for each in placed if isinstance(each.solid, Cylinder)]
    ends = [
        offset @ axis + side * length / 2 for offset, length in zip(offsets, lengths, strict=True) for side in (-1, 1)
    ]
    assert (min(ends), max(ends)) == pytest.approx((-0.15, 0.15))
    assert max(each.solid.radius for each in placed if isinstance(each.solid, Cylinder)) == 0.1


@pytest.mark.parametrize("orientation", [LYING, (0.0, 0.0, 0.0, 1.0)])
def test_the_floor_carries_the_weight_of_a_resting_cylinder(toys: Any, orientation: Any) -> None:
    height = 0.1 if orientation == LYING else 0.15
    task = toys.world.thing(
        "drum", toys.cylinder(0.1, 0.3), {"mass": 5.0}, position=(0, 0, height), orientation=orientation
    ).task()
    with BulletBackend() as backend:
        backend.reset(task, task.state)
        for _ in range(240):
            state = backend.step({})
        assert backend.contact_forces() == [(FLOOR, "drum", pytest.approx(5.0 * GRAVITY, rel=1e-3))]
    assert state["drum", "position"] == pytest.approx((0, 0, height), abs=1e-4)


def test_a_snapshot_of_a_pushed_cylinder_is_exact(toys: Any) -> None:
    world = toys.world.thing("drum", toys.cylinder(0.1, 0.3), {"mass": 5.0}, position=(0.2, 0, 0.1), orientation=LYING)
    task = world.pusher(position=(0, 0, 0.1)).task()
    push = {("pusher", "force"): np.array([6.0, 0.0, 0.0])}

    def record(backend: BulletBackend, steps: int) -> Any:
        return np.array([backend.step(push).values for _ in range(steps)])

    for begin in (0, 7, 100):
        with BulletBackend() as backend:
            backend.reset(task, task.state)
            straight = record(backend, 240)[begin:]
            backend.reset(task, task.state)
            record(backend, begin)
            with backend.snapshot() as go_back:
                record(backend, 60)
                go_back()
                np.testing.assert_array_equal(record(backend, 240 - begin), straight)
