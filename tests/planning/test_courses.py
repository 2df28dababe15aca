"""Plain `plan` compares every plan by the courses of its blocks, and rolls a plan out only if something is near."""

from collections.abc import Mapping
from itertools import product

import numpy as np
import pytest
from planning.test_meetings import crossing, rolling
from scenes import rolling_task

import hybrid_tamp
from hybrid_tamp.collision.checker import find_collisions
from hybrid_tamp.midlevel.predictions import Trace
from hybrid_tamp.midlevel.refinement import evaluate_defaults
from hybrid_tamp.midlevel.rollout import Rollouts
from hybrid_tamp.model.collision import Collision
from hybrid_tamp.model.control import CONTROL_PERIOD
from hybrid_tamp.model.course import ALLOWANCE, Course
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.state import State, StateLayout
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.planning import courses, routing
from hybrid_tamp.planning.collisions import lay_out
from hybrid_tamp.planning.courses import follow_courses, may_collide
from hybrid_tamp.planning.routing import route_defaults


def both_reach(task: Task, drums: tuple[str, str]) -> TaskPlan:
    """Return the plan in which two hands reach behind a drum each, at the same time, and then roll the drums."""
    instances = []
    for number, drum in enumerate(drums):
        hand, region = f"hand {number}", drum.replace("drum", "region")
        ways = {"object": drum, "region": region}
        instances += [
            BlockInstance(f"RESTING-{4 * number + 1}", "RESTING", {"token": hand}, 0.0, 0.1),
            BlockInstance(f"RESTING-{4 * number + 2}", "RESTING", {"token": drum}, 0.0, 3.0),
            BlockInstance(f"REACHING-{number + 1}", "REACHING:behind", {"hand": hand}, 0.1, 3.0, ways),
            BlockInstance(
                f"ROLLING-{number + 1}", "ROLLING", {"hand": hand, "object": drum}, 3.0, 6.0, {"region": region}
            ),
            BlockInstance(f"RESTING-{4 * number + 3}", "RESTING", {"token": hand}, 6.0, 6.1),
            BlockInstance(f"RESTING-{4 * number + 4}", "RESTING", {"token": drum}, 6.0, 6.1),
        ]
    return TaskPlan(tuple(instances), 6.1)


@pytest.fixture(scope="module")
def side_by_side() -> Task:
    """Return a task with two drums that roll side by side. Each hand starts near the drum of its number."""
    sides = (-0.5, 0.5)
    places = {(f"hand {number}", "position"): (-0.4, y, 0.3) for number, y in enumerate(sides)}
    task = rolling_task(2, [(0.0, y) for y in sides], [(0.7, y) for y in sides], [(0, 0), (1, 1)])
    return task.replaced(state=task.state.replace(places))


def test_hands_that_stay_on_their_sides_need_no_rollout(side_by_side: Task, monkeypatch: pytest.MonkeyPatch) -> None:
    plan = both_reach(side_by_side, ("drum 0", "drum 1"))
    assert not may_collide(side_by_side, plan)
    monkeypatch.setattr(routing, "route", None)
    assert route_defaults(side_by_side, plan) is None


def test_the_independent_check_has_the_last_word(side_by_side: Task, monkeypatch: pytest.MonkeyPatch) -> None:
    seen = []

    def refute(task: Task, plan: TaskPlan, traces: Mapping[str, Trace]) -> tuple[Collision, ...]:
        seen.extend(traces)
        assert find_collisions(task, plan.instances, *lay_out(task, plan, traces)) == ()
        return (Collision(("hand 0", "drum 1"), ("REACHING-1", "ROLLING-2"), 1.0),)

    monkeypatch.setattr(courses, "check_plan", refute)
    monkeypatch.setattr(courses, "run_isolated", lambda check, deadline: check(str))
    assert may_collide(side_by_side, both_reach(side_by_side, ("drum 0", "drum 1")))
    assert {"REACHING-1", "ROLLING-1", "REACHING-2", "ROLLING-2"} <= set(seen)


@pytest.mark.parametrize("times", [None, np.array([0.0, 0.5, 1.0])])
def test_a_paced_course_passes_its_states_with_unit_quaternions(times: FloatArray | None) -> None:
    layout = StateLayout((("hand", "position", 3), ("hand", "orientation", 4)))
    turned = [[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.6, 0.8], [0.0, 0.0, -0.96, -0.28]]
    places = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 2.0, 0.0]]
    course = Course(State(layout, np.hstack([places, turned])), times=times)
    paced = course.paced(1.0)
    period = round(0.5 / CONTROL_PERIOD)
    assert paced["hand", "position"][[0, period, -1]] == pytest.approx(np.array(places))
    assert np.abs((paced["hand", "orientation"][[0, period, -1]] * turned).sum(axis=1)) == pytest.approx(1.0)
    assert np.linalg.norm(paced["hand", "orientation"], axis=1) == pytest.approx(1.0)
    assert np.abs(np.diff(paced["hand", "orientation"], axis=0)).max() < 0.02


def test_hands_that_swap_sides_are_kept_apart_although_every_body_moves(side_by_side: Task) -> None:
    plan = both_reach(side_by_side, ("drum 1", "drum 0"))
    assert may_collide(side_by_side, plan)
    routed = route_defaults(side_by_side, plan)
    assert routed is not None
    assert routed.shortfall is None
    assert routed.plan.order or any(each.path for each in routed.plan.instances)


def test_plain_plan_puts_movements_that_cross_in_order() -> None:
    crossed = hybrid_tamp.plan(crossing())
    first, second = rolling(crossed)
    assert crossed.order == ((first.name, second.name),)
    assert second.start >= first.end - 1e-6


def test_the_end_of_a_course_is_where_the_next_movement_begins(side_by_side: Task) -> None:
    plan = both_reach(side_by_side, ("drum 0", "drum 1"))
    rollouts = Rollouts(side_by_side, plan)
    rolled = rollouts.trace(evaluate_defaults(side_by_side, plan, rollouts).plan)
    followed = follow_courses(side_by_side, plan)
    assert followed is not None
    assert followed.keys() == rolled.keys()
    for name, rollout in rolled.items():
        for token, (row, prop) in product(
            ("hand 0", "drum 0", "hand 1", "drum 1"), ((0, "position"), (-1, "position"))
        ):
            if (token, prop) in rollout.states.layout.slices:
                found = followed[name].course.states[token, prop][row]
                np.testing.assert_allclose(found, rollout.states[token, prop][row], atol=ALLOWANCE)
