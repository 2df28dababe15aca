"""Key poses are poses of every execution, and a body in a key pose proves that a movement is impossible."""

import numpy as np
import pytest
from random_tasks.arranging import Arrangement

import hybrid_tamp
from hybrid_tamp.geometry.shapes import Box
from hybrid_tamp.midlevel.refinement import evaluate_defaults
from hybrid_tamp.midlevel.rollout import Rollouts
from hybrid_tamp.model.key_pose import KeyPose
from hybrid_tamp.model.outcome import PlanOutcome
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import rotate
from hybrid_tamp.planning.clearance import Sweep, find_sweeps
from hybrid_tamp.planning.key_poses import prove_overlap

Wall = tuple[tuple[float, float, float], tuple[float, float, float]]
"""Position and half extents of a fixed box [m]."""


def walled(name: str, *walls: Wall) -> hybrid_tamp.Task:
    """Return a bundled task with fixed boxes."""
    task = hybrid_tamp.load_task(name)
    scene = Arrangement.of(task)
    for number, (place, halves) in enumerate(walls):
        wall = Token.make(f"wall-{number}", [], {}, Box(kind="box", half_extents=halves), immovable=True)
        scene.add(wall, np.asarray(place))
    return scene.task(task, "walled")


def sweeps_of(task: hybrid_tamp.Task, outcome: PlanOutcome) -> list[Sweep]:
    """Return the movements of a plan in the forward models of a task, with the default hyperparameters."""
    assert outcome.plan is not None
    rollouts = Rollouts(task, outcome.plan)
    refined = evaluate_defaults(task, outcome.plan, rollouts)
    return list(find_sweeps(task, refined.plan, rollouts.trace(refined.plan)))


@pytest.fixture(scope="module")
def tumble() -> PlanOutcome:
    return hybrid_tamp.plan("tumble_two_hands")


def test_tumbling_passes_its_key_poses(tumble: PlanOutcome) -> None:
    assert distances(tumble, {"REACHING", "TIPPING"}) < 1.0


def test_carrying_passes_its_key_poses() -> None:
    assert distances(hybrid_tamp.plan("carry_two_hands"), {"REACHING", "LIFTING", "LOWERING"}) < 1.0


def distances(outcome: PlanOutcome, expected: set[str]) -> float:
    """Return the largest distance of a movement from a key pose, as a fraction of the declared distance."""
    task, worst, seen = outcome.task, 0.0, set()
    for movement in sweeps_of(task, outcome):
        block = task.domain.block_by_name[movement.instance.block]
        if block.key_poses is not None:
            seen.add(block.action)
            poses = block.key_poses(task.bind(movement.instance.roles), movement.trace.world)
            worst = max(worst, *(distance(movement, each) / each.within for each in poses))
    assert seen == expected
    return worst


def distance(movement: Sweep, pose: KeyPose) -> float:
    """Return the least distance [m] of a token's centre and of two points on its axes from a key pose."""
    states, name = movement.trace.states, movement.instance.slots[pose.slot]
    points = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.1]])

    def of(position: FloatArray, orientation: FloatArray) -> FloatArray:
        return position + rotate(orientation, points)

    there = of(pose.position, pose.orientation)
    moved = of(states[name, "position"][:, None], states[name, "orientation"][:, None])
    return float(np.linalg.norm(moved - there, axis=-1).max(axis=-1).min())


@pytest.mark.parametrize(
    ("name", "wall", "said"),
    [
        ("lift_two_hands", ((0.0, 0.0, 0.30), (0.1, 0.1, 0.02)), "LIFTING:two .*: box hits wall-0, 0.06 m deep at "),
        ("lift_two_hands", ((-0.27, 0.0, 0.2), (0.09, 0.3, 0.2)), "REACHING:place .*: left-hand hits wall-0, 0.052 m "),
        ("carry_two_hands", ((0.6, 0.8, 0.3), (0.06, 0.06, 0.3)), "LOWERING:two .*, and fixed bodies .* inside"),
    ],
)
def test_a_body_in_a_key_pose_proves_that_there_is_no_plan(name: str, wall: Wall, said: str) -> None:
    found = hybrid_tamp.plan(walled(name, wall), trials=0)
    assert found.error is not None
    assert found.error.exit_status == 10
    with pytest.raises(hybrid_tamp.NoPlan, match=said):
        raise found.error


@pytest.mark.parametrize(
    ("name", "wall"),
    [
        ("lift_two_hands", ((0.0, 0.0, 0.44), (0.1, 0.1, 0.02))),
        ("carry_two_hands", ((0.6, 1.02, 0.3), (0.06, 0.03, 0.3))),
    ],
)
def test_a_body_beside_all_key_poses_is_no_obstacle(name: str, wall: Wall) -> None:
    assert hybrid_tamp.plan(walled(name, wall), trials=0).plan is not None


@pytest.mark.parametrize(
    ("x", "instance", "moving"), [(0.36, "TIPPING-1", "hand-2"), (0.47, "TIPPING-3", "box"), (0.75, "", "")]
)
def test_a_body_where_a_box_tips_over_makes_the_turn_impossible(
    tumble: PlanOutcome, x: float, instance: str, moving: str
) -> None:
    task = walled("tumble_two_hands", ((x, 0.0, 0.15), (0.02, 0.1, 0.15)))
    movements = sweeps_of(task, tumble)
    proven = [prove_overlap(task, each, movements[:index]) for index, each in enumerate(movements)]
    first = next((each for each in proven if each), None)
    assert (first.where if first else "") == instance
    assert first is None or (first.proven and first.atom.arguments == (moving, "wall-0"))
