"""Comparison of PyBullet with closed forms, and tests of the protocol of the backend."""

import math
import subprocess
import sys
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from hybrid_tamp.errors import InputError
from hybrid_tamp.model.block import FLOOR
from hybrid_tamp.model.commands import CommandError
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.constants import GRAVITY
from hybrid_tamp.physics.bullet.backend import BulletBackend

LYING = (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))  # the body's z axis along -y
SLOPE = math.radians(15)


def inclined(angle: float) -> tuple[float, float, float]:
    """Return the gravity on a floor that is inclined downwards in the direction of +x."""
    return (GRAVITY * math.sin(angle), 0.0, -GRAVITY * math.cos(angle))


def settle(backend: BulletBackend, seconds: float, commands: Any = None) -> list[State]:
    return [backend.step(commands or {}) for _ in range(round(seconds / backend.timestep))]


def speed_gained(task: Task, token: str, gravity: tuple[float, float, float], seconds: float) -> float:
    with BulletBackend(gravity) as backend:
        backend.reset(task, task.state)
        return float(settle(backend, seconds)[-1][token, "velocity"][0])


@pytest.mark.parametrize("radius", [0.06, 0.1, 0.15])
def test_cylinder_rolls_down_an_incline_at_two_thirds_of_sliding(toys: Any, radius: float) -> None:
    shape = toys.cylinder(radius, 0.3)
    properties = {"mass": 5.0, "friction": 0.8}
    state = {"position": (0, 0, radius), "orientation": LYING}
    task = toys.world.thing("drum", shape, properties, **state).task()
    expected = 2 / 3 * GRAVITY * math.sin(SLOPE)
    assert speed_gained(task, "drum", inclined(SLOPE), 1.0) == pytest.approx(expected, rel=0.01)


def test_sphere_rolls_down_an_incline_at_five_sevenths_of_sliding(toys: Any) -> None:
    task = toys.world.thing("ball", toys.sphere(0.1), {"mass": 2.0, "friction": 0.8}, position=(0, 0, 0.1)).task()
    expected = 5 / 7 * GRAVITY * math.sin(SLOPE)
    assert speed_gained(task, "ball", inclined(SLOPE), 1.0) == pytest.approx(expected, rel=0.01)


def test_box_slides_down_an_incline_by_what_friction_leaves(toys: Any) -> None:
    world = toys.world.thing("box", toys.box(0.2, 0.2, 0.05), {"mass": 3.0, "friction": 0.2}, position=(0, 0, 0.05))
    slope = math.radians(25)
    expected = GRAVITY * (math.sin(slope) - 0.2 * math.cos(slope))
    assert speed_gained(world.task(), "box", inclined(slope), 1.0) == pytest.approx(expected, rel=0.01)


def test_rolling_friction_stops_a_drum_after_the_distance_it_implies(toys: Any) -> None:
    shape, properties = toys.cylinder(0.1, 0.3), {"mass": 5.0, "friction": 0.6, "rolling_friction": 0.005}
    start = {"position": (0, 0, 0.1), "orientation": LYING, "velocity": (0.4, 0, 0), "angular_velocity": (0, 4.0, 0)}
    task = toys.world.thing("drum", shape, properties, **start).task()
    with BulletBackend() as backend:
        backend.reset(task, task.state)
        end = settle(backend, 4.0)[-1]
    slowing = 2 / 3 * GRAVITY * 0.005 / 0.1
    assert end["drum", "position"][0] == pytest.approx(0.4**2 / (2 * slowing), rel=0.005)
    assert np.linalg.norm(end["drum", "velocity"]) < 1e-4


def pushed(toys: Any, force: float, friction: float, half_width: float) -> State:
    """Push a tall box with a constant force for a second, at a height of 0.5 m."""
    world = toys.world.thing("box", toys.box(half_width, 0.2, 0.3), {"mass": 8.0, "friction": friction})
    world = world.pusher(limit=1000.0, position=(-half_width - 0.0501, 0, 0.5))
    task = world.task()
    task = task.replaced(state=task.state.replace({("box", "position"): (0, 0, 0.3)}))
    with BulletBackend() as backend:
        backend.reset(task, task.state)
        return settle(backend, 1.0, {("pusher", "force"): np.array([force, 0.0, 0.0])})[-1]


@pytest.mark.parametrize(("share", "tips"), [(0.99, False), (1.01, True)])
def test_box_tips_at_half_its_weight_times_width_over_height(toys: Any, share: float, tips: bool) -> None:
    tipping = 8.0 * GRAVITY * 0.15 / 0.5
    end = pushed(toys, share * tipping, friction=2.0, half_width=0.15)
    tilted = abs(end["box", "orientation"][1]) > 0.05
    assert tilted == tips


@pytest.mark.parametrize(("share", "slips"), [(0.99, False), (1.01, True)])
def test_box_slips_at_friction_times_weight(toys: Any, share: float, slips: bool) -> None:
    end = pushed(toys, share * 0.2 * 8.0 * GRAVITY, friction=0.2, half_width=0.4)
    assert (end["box", "position"][0] > 0.005) == slips


def test_floor_carries_the_weight(toys: Any) -> None:
    task = toys.world.thing("box", toys.box(0.1, 0.1, 0.1), {"mass": 2.0}, position=(0, 0, 0.1)).task()
    with BulletBackend() as backend:
        backend.reset(task, task.state)
        settle(backend, 1.0)
        [(one, other, force)] = backend.contact_forces()
    assert (one, other) == (FLOOR, "box")
    assert force == pytest.approx(2.0 * GRAVITY, rel=1e-3)


def test_a_blow_within_a_period_is_felt(toys: Any) -> None:
    """A pusher of 1.5 kg is stopped from 1 m/s, which gives an impulse of 1.5 N s within one of the four substeps."""
    world = toys.world.thing("wall", toys.box(0.1, 0.1, 0.1), {"mass": 1e6, "friction": 0.5}, position=(0, 0, 0.1))
    for start in np.linspace(-0.17, -0.18, 7):
        task = world.pusher(position=(start, 0, 0.1), velocity=(1.0, 0, 0)).task()
        hardest = 0.0
        with BulletBackend() as backend:
            backend.reset(task, task.state)
            for _ in range(12):
                backend.step({})
                felt = {(one, other): force for one, other, force in backend.contact_forces()}
                hardest = max(hardest, felt.get(("pusher", "wall"), 0.0))
        # The impulse over 10 ms does not depend on the moment of the blow or on the solver.
        assert hardest == pytest.approx(150.0, rel=1e-3)


def test_a_reassignment_empties_the_windows_of_its_tokens(toys: Any) -> None:
    world = toys.world.thing("box", toys.box(0.1, 0.1, 0.1), {"mass": 2.0}, position=(0, 0, 0.1))
    task = world.thing("other", toys.box(0.1, 0.1, 0.1), {"mass": 2.0}, position=(1, 0, 0.1)).task()
    rests = [toys.rest(f"RESTING-{name}", 0.0, 1.0, name) for name in ("box", "other")]
    with BulletBackend() as backend:
        backend.reset(task, task.state)
        backend.assign(rests)
        settle(backend, 0.5)
        backend.assign([replace(rests[0], name="RESTING-3"), rests[1]])
        backend.step({})
        felt = {other: force for _, other, force in backend.contact_forces()}
    # A window contains 9.6 substeps, and a control period contains four substeps.
    assert felt == pytest.approx({"box": 2.0 * GRAVITY * 4 / 9.6, "other": 2.0 * GRAVITY}, rel=1e-3)


def test_hand_floats_keeps_its_orientation_and_obeys_newton(toys: Any) -> None:
    turned = np.array([0.1, 0.2, 0.3, 0.9]) / np.linalg.norm([0.1, 0.2, 0.3, 0.9])
    task = toys.world.pusher(orientation=turned).task()
    with BulletBackend() as backend:
        backend.reset(task, task.state)
        still = settle(backend, 1.0)[-1]
        assert still["pusher", "position"] == pytest.approx([0, 0, 0.5], abs=1e-9)
        moving = settle(backend, 1.0, {("pusher", "force"): np.array([3.0, 0.0, 0.0])})[-1]
    assert moving["pusher", "velocity"] == pytest.approx([3.0 / 1.5, 0, 0], rel=1e-9, abs=1e-9)
    assert moving["pusher", "orientation"] == pytest.approx(turned, abs=1e-9)


def tumble(toys: Any) -> Task:
    """Return a scene with many contacts."""
    world = toys.world.thing("box", toys.box(0.1, 0.15, 0.2), {"mass": 4.0}, position=(0, 0, 0.6))
    world = world.thing("drum", toys.cylinder(0.1, 0.3), {"mass": 5.0}, position=(0.05, 0.02, 0.2), orientation=LYING)
    orientation = np.array([0.3, -0.2, 0.1, 0.8])
    world = world.pusher(position=(-0.4, 0, 0.3), orientation=orientation / np.linalg.norm(orientation))
    task: Task = world.spot().task()
    return task


def trajectory(backend: BulletBackend, task: Task, state: State) -> bytes:
    rows = [backend.reset(task, state)]
    rows += settle(backend, 1.5, {("pusher", "force"): np.array([20.0, 1.0, 0.0])})
    return np.array([row.values for row in rows]).tobytes()


def test_runs_are_bit_identical_across_clients_and_resets(toys: Any) -> None:
    task = tumble(toys)
    with BulletBackend() as one, BulletBackend() as other:
        first = trajectory(one, task, task.state)
        assert trajectory(other, task, task.state) == first
        assert trajectory(one, task, task.state) == first


def test_resetting_to_what_reset_returned_starts_the_same_run(toys: Any) -> None:
    task = tumble(toys)
    with BulletBackend() as backend:
        first = trajectory(backend, task, task.state)
        returned = backend.reset(task, task.state)
        assert trajectory(backend, task, returned) == first


def test_places_stay_where_they_are(toys: Any) -> None:
    task = tumble(toys)
    with BulletBackend() as backend:
        backend.reset(task, task.state)
        end = settle(backend, 0.2)[-1]
    assert np.array_equal(end["spot", "position"], task.state["spot", "position"])


def test_tokens_that_cannot_be_simulated_are_refused_all_at_once(toys: Any) -> None:
    task = toys.world.twister().thing("ghost", None, {"mass": 1.0}).task()
    with BulletBackend() as backend, pytest.raises(InputError) as refused:
        backend.reset(task, task.state)
    said = str(refused.value)
    assert "token twister" in said
    assert "torque of size 1" in said
    assert "token ghost: a simulated token must have a shape" in said


@pytest.mark.parametrize(
    ("commands", "said"),
    [
        ({("pusher", "force"): np.array([math.nan, 0, 0])}, "must be finite"),
        ({("pusher", "force"): np.array([math.inf, 0, 0])}, "must be finite"),
        ({("pusher", "force"): np.array([80.0, 80.0, 0])}, "must not exceed its limit of 100"),
        ({("pusher", "force"): np.array([1.0])}, r"must have shape \(3,\)"),
        ({("pusher", "torque"): np.zeros(3)}, "cannot command torque on pusher"),
        ({("spot", "force"): np.zeros(3)}, "cannot command force on spot"),
    ],
)
def test_backend_checks_commands_itself(toys: Any, commands: Any, said: str) -> None:
    task = toys.one_move_task()
    with BulletBackend() as backend:
        backend.reset(task, task.state)
        with pytest.raises(CommandError, match=said):
            backend.step(commands)


def test_import_prints_nothing() -> None:
    done = subprocess.run(
        [sys.executable, "-c", "import hybrid_tamp.physics.bullet.backend; print('after')"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout == "after\n"
    assert done.stderr == ""


def test_import_works_without_standard_streams() -> None:
    program = "import os; os.close(1); os.close(2); import hybrid_tamp.physics.bullet.backend"
    subprocess.run([sys.executable, "-c", program], check=True)


def test_closing_twice_is_harmless() -> None:
    backend = BulletBackend()
    backend.close()
    backend.close()
