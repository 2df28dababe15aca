"""The closest pair of each movement: planned, drawn, and measured in a run."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scenes import rolling_task

import hybrid_tamp
from hybrid_tamp.execution.execute import execute
from hybrid_tamp.geometry.shapes import Box
from hybrid_tamp.model.outcome import PlanOutcome
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.physics.protocol import open_backend
from hybrid_tamp.planning.closest_pairs import NEAR, measure_pairs, sweep_plan
from hybrid_tamp.verbs.movements import draw_plan


@pytest.fixture(scope="module")
def around_wall() -> PlanOutcome:
    return hybrid_tamp.plan("roll_around_wall")


def test_a_path_around_a_wall_keeps_its_clearance(around_wall: PlanOutcome) -> None:
    reach, roll = around_wall.closest_pairs
    assert (reach.moving, reach.other, roll.moving, roll.other) == ("hand", "wall", "drum", "wall")
    # A path keeps 20 mm from bodies. The wall ends at y = -0.22 m, and the drum is 0.3 m long.
    assert 0.019 < reach.distance < 0.03
    assert roll.distance == pytest.approx(0.07, abs=1e-3)
    for pair in (reach, roll):
        assert np.linalg.norm(np.subtract(*pair.points)) == pytest.approx(pair.distance, abs=1e-6)


def test_the_swept_paths_have_the_same_pairs_and_contain_the_poses_at_their_instants(around_wall: PlanOutcome) -> None:
    swept = sweep_plan(around_wall)
    assert tuple(path.closest for path in swept.paths) == around_wall.closest_pairs
    assert swept.refused is None
    reach = swept.paths[0]
    assert reach.closest is not None
    (hand,) = reach.bodies
    assert len(hand.positions) == len(hand.orientations) == len(reach.times)
    place = [np.interp(reach.closest.time, reach.times, hand.positions[:, axis]) for axis in range(3)]
    token = swept.task.token_by_name["hand"]
    reached = np.hypot(token["radius"], token["length"] / 2.0)
    assert np.linalg.norm(np.subtract(reach.closest.points[0], place)) <= reached + 1e-3


def test_the_clearance_in_a_run_agrees_with_the_planned_one(around_wall: PlanOutcome) -> None:
    assert around_wall.plan is not None
    with open_backend("pybullet") as physics:
        recording = execute(around_wall.task, around_wall.plan, physics)
    pairs = measure_pairs(around_wall.task, recording, around_wall.closest_pairs)
    assert len(pairs) == 2
    for pair in pairs:
        assert pair.measured is not None
        assert abs(pair.measured - pair.distance) < 5e-3
    unfinished = replace(recording, instances=recording.instances[:0])
    assert measure_pairs(around_wall.task, unfinished, around_wall.closest_pairs) == ()


def test_the_movements_of_a_refused_plan_show_the_place_and_the_depth() -> None:
    task = rolling_task()
    wall = Token.make("wall", [], {}, Box(kind="box", half_extents=(0.05, 0.15, 0.1)), immovable=True)
    tokens = (*task.tokens, wall)
    poses = {(token.name, v.name): task.state[token, v.name] for token in task.tokens for v in token.varying}
    state = State.of(tokens, {**poses, ("wall", "position"): np.array([0.45, 0.0, 0.1])})
    refused = hybrid_tamp.plan(task.replaced(tokens=tokens, state=state), trials=0)
    assert refused.plan is None
    swept = sweep_plan(refused)
    assert swept.refused is not None
    (hit,) = (path.closest for path in swept.paths if path.instance.name == swept.refused.where)
    assert hit is not None
    assert (hit.moving, hit.other) == ("drum 0", "wall")
    assert hit.margin == swept.refused.margin
    assert hit.points[0][0] == pytest.approx(0.45, abs=0.1)


def test_a_plan_that_moves_every_body_is_compared_when_it_is_drawn(tmp_path: Path) -> None:
    planned, file = hybrid_tamp.plan("roll_cylinder"), tmp_path / "movements.svg"
    assert planned.closest_pairs == ()
    (pair,) = draw_plan(planned, file).closest_pairs
    assert (pair.instance, pair.moving, pair.other) == ("REACHING-1", "hand", "drum")
    assert 0 < pair.distance < NEAR
    assert "<svg" in file.read_text(encoding="utf-8")
    assert sweep_plan(replace(planned, plan=None)).paths == ()
