"""The independent check of plans and recordings finds every forbidden overlap, and no allowed contact."""

import numpy as np
import pytest
from scenes import rolling_task

import hybrid_tamp
from hybrid_tamp.collision.checker import find_collisions
from hybrid_tamp.geometry.shapes import Box
from hybrid_tamp.midlevel.rollout import Rollouts
from hybrid_tamp.model.outcome import PlanOutcome
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.planning.collisions import check_plan, lay_out


@pytest.fixture(scope="module")
def rolled() -> PlanOutcome:
    return hybrid_tamp.plan(rolling_task(), optimise=True)


def with_wall(task: Task, place: tuple[float, float, float]) -> Task:
    """Return the task with a thin wall at a place [m]."""
    wall = Token.make("wall", [], {}, Box(kind="box", half_extents=(0.02, 0.3, 0.05)), immovable=True)
    poses = {(token.name, v.name): task.state[token, v.name] for token in task.tokens for v in token.varying}
    tokens = (*task.tokens, wall)
    return task.replaced(tokens=tokens, state=State.of(tokens, {**poses, ("wall", "position"): place}))


@pytest.mark.parametrize(
    ("place", "bodies"),
    [
        ((0.5, 0.0, 0.05), {("drum 0", "wall"), ("hand 0", "wall")}),
        ((0.7 + 0.1 + 0.02 - 0.006, 0.0, 0.1), {("drum 0", "wall")}),
        ((0.7 + 0.1 + 0.02 + 0.006, 0.0, 0.1), set()),
        ((0.3, 0.5, 0.05), set()),
    ],
)
def test_a_wall_that_the_planner_did_not_know(
    rolled: PlanOutcome, place: tuple[float, float, float], bodies: set[tuple[str, str]]
) -> None:
    task, plan = with_wall(rolled.task, place), rolled.plan
    assert plan is not None
    found = check_plan(task, plan, Rollouts(task, plan).trace(plan))
    assert {each.tokens for each in found} == bodies
    assert all(each.instances[0] == "ROLLING-1" for each in found)


def test_a_hand_may_push_the_drum_but_not_reach_through_it(rolled: PlanOutcome) -> None:
    task, plan = rolled.task, rolled.plan
    assert plan is not None
    times, states = lay_out(task, plan, Rollouts(task, plan).trace(plan))
    assert find_collisions(task, plan.instances, times, states) == ()
    reach = next(each for each in plan.instances if each.block == "REACHING:behind")
    rows = (times > reach.start) & (times < reach.end)
    place = np.where(rows[:, None], states["drum 0", "position"], states["hand 0", "position"])
    (found,) = find_collisions(task, plan.instances, times, states.replace({("hand 0", "position"): place}))
    assert found.tokens == ("hand 0", "drum 0")
    assert found.text.startswith("hand 0 and drum 0 collide at ")
    assert found.instances[0] == reach.name
