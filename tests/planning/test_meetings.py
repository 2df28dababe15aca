"""Movements that may happen at the same time and would meet: one goes first, in the plan and in physics."""

from itertools import combinations
from typing import Any

import pytest

import hybrid_tamp
from hybrid_tamp.execution.execute import execute
from hybrid_tamp.model.outcome import PlanOutcome
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.precedence import Precedence
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.protocol import open_backend

HAND = {"radius": 0.035, "length": 0.16, "mass": 1.5, "maximal_force": 300.0}
DRUM = {"axis_of_rotation": [0, 0, 1], "radius_of_rotation": 0.1, "mass": 5.0, "friction": 0.6}


def crossing(apart: float = 0.0) -> Task:
    """Return a task in which two hands roll two drums along paths that cross, or that are apart by a distance [m]."""

    def hand(x: float, y: float, lower: tuple[float, float], upper: tuple[float, float]) -> dict[str, Any]:
        corners = {"workspace_lower": [*lower, 0.0], "workspace_upper": [*upper, 1.2]}
        return {"classes": ["STATIC END-EFFECTOR"], "properties": HAND | corners, "pose": {"position": [x, y, 0.3]}}

    def drum(x: float, y: float, rpy: list[float]) -> dict[str, Any]:
        shape = {"kind": "cylinder", "radius": 0.1, "length": 0.3}
        return {
            "classes": ["ROLLABLE"],
            "properties": DRUM,
            "shape": shape,
            "pose": {"position": [x, y, 0.1], "rpy": rpy},
        }

    def region(x: float, y: float) -> dict[str, Any]:
        return {"classes": ["REGION"], "properties": {"radius": 0.02}, "pose": {"position": [x, y, 0.0]}}

    tokens = {
        "hand-1": hand(-1.1, -0.1, (-1.8, -0.4), (1.8, 0.4)),
        "hand-2": hand(0.1 + apart, -1.1, (apart - 0.4, -1.8), (apart + 0.4, 1.8)),
        "one": drum(-0.6, 0.0, [1.5707963267948966, 0.0, 0.0]),
        "two": drum(apart, -0.6, [0.0, 1.5707963267948966, 0.0]),
        "east": region(0.6, 0.0),
        "north": region(apart, 0.6),
    }
    goal = [{"inside": ["one", "east"]}, {"inside": ["two", "north"]}]
    return hybrid_tamp.make_task("rolling_tumbling", tokens, goal, agents={"robot": ["hand-1", "hand-2"]})


@pytest.fixture(scope="module")
def crossed() -> PlanOutcome:
    return hybrid_tamp.plan(crossing(), optimise=True)


def rolling(outcome: PlanOutcome) -> list[BlockInstance]:
    assert outcome.plan is not None
    return sorted((each for each in outcome.plan.instances if each.block == "ROLLING"), key=lambda i: i.start)


def test_one_of_two_movements_that_cross_goes_first(crossed: PlanOutcome) -> None:
    first, second = rolling(crossed)
    assert crossed.order == ((first.name, second.name),)
    assert second.start >= first.end - 1e-6
    assert crossed.plan is not None
    precedence = Precedence(crossed.task, crossed.plan)
    assert precedence.is_over_before(first, second)
    assert not precedence.is_over_before(second, first)


def test_the_order_is_kept_in_physics_and_nothing_touches(crossed: PlanOutcome) -> None:
    assert crossed.plan is not None
    with open_backend("pybullet") as physics:
        recording = execute(crossed.task, crossed.plan, physics)
    assert recording.failure is None
    assert all(atom.holds for atom in recording.goal)
    first, second = rolling(crossed)
    times = {each.name: (each.start, each.end) for each in recording.instances}
    assert times[second.name][0] >= times[first.name][1] - 1e-6
    assert not [contact for contact in recording.contacts if not contact.allowed]
    assert recording.plan.makespan == pytest.approx(crossed.makespan, abs=0.1)


def test_movements_that_do_not_cross_happen_at_the_same_time() -> None:
    outcome = hybrid_tamp.plan(crossing(apart=2.0), optimise=True)
    assert outcome.order == ()
    one, other = rolling(outcome)
    assert one.overlaps(other)


def test_an_instance_that_hands_over_its_tokens_is_over_before_the_next_one(crossed: PlanOutcome) -> None:
    plan = crossed.plan
    assert plan is not None
    precedence = Precedence(crossed.task, plan)
    for one, other in combinations(sorted(plan.instances, key=lambda i: (i.start, i.end)), 2):
        if set(one.slots.values()) & set(other.slots.values()):
            assert precedence.is_over_before(one, other)
            assert not precedence.is_over_before(other, one)
