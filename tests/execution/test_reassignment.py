"""Tests of the order of events that a plan determines."""

from typing import Any

from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.reassignment import initial, reassignments


def two_movers(toys: Any, spots: tuple[str, str] = ("a", "b"), second: float = 0.1) -> Any:
    """Return a plan in which two pushers move to two spots at about the same time."""
    task = toys.world.pusher("one").pusher("two", position=(0, 1, 0.5)).spot("a").spot("b").task()
    instances = (
        toys.rest("RESTING-1", 0.0, 0.1, "one"),
        toys.rest("RESTING-2", 0.0, second, "two"),
        toys.move("MOVING-1", 0.1, 1.0, "one", spots[0]),
        toys.move("MOVING-2", second, 2.0, "two", spots[1]),
        toys.rest("RESTING-3", 1.0, 3.0, "one"),
        toys.rest("RESTING-4", 2.0, 3.0, "two"),
    )
    return task, TaskPlan(instances, 3.0)


def test_events_without_a_common_token_are_apart_and_in_no_order(toys: Any) -> None:
    task, plan = two_movers(toys)
    assert {instance.name for instance in initial(plan)} == {"RESTING-1", "RESTING-2"}
    first, second, third, fourth, last = reassignments(task, plan)
    assert first.ending == ("RESTING-1",)
    assert second.ending == ("RESTING-2",)
    assert first.after == second.after == frozenset()
    assert third.ending == ("MOVING-1",)
    assert third.after == {0}
    assert fourth.after == {1}
    assert last.final
    assert last.ending == ("RESTING-3", "RESTING-4")
    assert last.after == {0, 1, 2, 3}
    assert last.starting == ()


def test_events_with_a_common_place_keep_their_order(toys: Any) -> None:
    task, plan = two_movers(toys, ("a", "a"), second=0.2)
    events = reassignments(task, plan)
    assert events[1].after == {0}
    assert events[2].after == {0, 1}


def test_coincidence_with_a_common_place_is_one_event(toys: Any) -> None:
    task, plan = two_movers(toys, ("a", "a"))
    first, *_ = reassignments(task, plan)
    assert first.ending == ("RESTING-1", "RESTING-2")
    assert {instance.name for instance in first.starting} == {"MOVING-1", "MOVING-2"}


def test_a_plan_without_reassignments_has_only_its_end(toys: Any) -> None:
    task = toys.world.pusher().task()
    [end] = reassignments(task, TaskPlan((toys.rest("RESTING-1", 0.0, 0.1),), 0.1))
    assert end.final
    assert end.ending == ("RESTING-1",)
