"""Tests of the closed-loop execution: measured events, bounds, failures and the log."""

import json
import logging
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from random_tasks.tumbling import random_tumbling

import hybrid_tamp
from hybrid_tamp.errors import DomainError
from hybrid_tamp.execution.events import Event, EventLog
from hybrid_tamp.execution.execute import execute
from hybrid_tamp.execution.loop import PATIENCE, SETTLING
from hybrid_tamp.model.affordance import TOKEN
from hybrid_tamp.model.block import FLOOR, Duration
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.predicate import Atom, Parameter, Predicate
from hybrid_tamp.model.task import Limits
from hybrid_tamp.physics.analytic import AnalyticBackend
from hybrid_tamp.physics.protocol import open_backend
from hybrid_tamp.report.measures import CONTACT, run_measures

STEP = 1 / 240


def run(task: Any, plan: TaskPlan, **more: Any) -> Any:
    with AnalyticBackend() as backend:
        return execute(task, plan, backend, **more)


def duration(minimum: float, maximum: float) -> Duration:
    return Duration(minimum, maximum, lambda binding, state, hyperparameters: minimum)


def commanding(value: Any, token: str = "pusher", action: str = "force") -> Any:
    """Return a policy factory whose policies always return the same command."""
    return lambda binding, start, parameters: lambda elapsed, state: {(token, action): np.asarray(value)}


@pytest.mark.parametrize("backend_name", ["analytic", "pybullet"])
def test_a_lawful_plan_becomes_a_lawful_run(toys: Any, backend_name: str) -> None:
    task = toys.one_move_task()
    with open_backend(backend_name) as backend:
        recording = execute(task, toys.one_move(), backend)
    assert recording.success
    assert recording.failure is None
    assert recording.backend == backend_name
    assert check_law(task, recording.plan, recording.at) == []
    assert recording.states.shape == (len(recording.times), task.state.layout.size)
    assert recording.commands.shape == (len(recording.times) - 1, 3)
    assert [margin.atom.text for margin in recording.exits["MOVING-1"]] == ["near(pusher, spot)", "at_rest(pusher)"]
    assert all(margin.holds for margin in recording.exits["MOVING-1"])
    assert [margin.atom.text for margin in recording.goal] == ["near(pusher, spot)"]


def pushing_at_a_post(toys: Any, **changes: Any) -> tuple[Any, TaskPlan]:
    world = toys.world.block(**changes) if changes else toys.world
    world = world.pusher().spot().thing("post", toys.box(0.05, 0.1, 0.4), {"mass": 20.0}, position=(0.2, 0, 0.4))
    plan = toys.one_move()
    return world.task(), replace(plan, instances=(*plan.instances, toys.rest("RESTING-post", 0.0, 1.2, "post")))


def test_contacts_are_recorded_with_the_instances_of_the_time(toys: Any) -> None:
    task, plan = pushing_at_a_post(toys)
    task = task.replaced(limits=Limits(contact=1e4))
    with open_backend("pybullet") as backend:
        recording = execute(task, plan, backend)
    floor, contact = sorted(recording.contacts, key=lambda each: each.tokens)
    assert (floor.tokens, floor.instances, floor.allowed) == ((FLOOR, "post"), ("", "RESTING-post"), True)
    assert not floor.between_instances
    assert contact.tokens == ("post", "pusher")
    assert contact.instances == ("RESTING-post", "MOVING-1")
    assert contact.between_instances
    assert contact.force > 5.0
    assert run_measures(plan, recording)[CONTACT] == contact.force
    predicted = run(task, plan)
    assert predicted.contacts == ()
    assert CONTACT not in run_measures(plan, predicted)


def test_a_contact_that_no_block_allows_fails_the_run(toys: Any) -> None:
    task, plan = pushing_at_a_post(toys)
    with open_backend("pybullet") as backend:
        recording = execute(task, plan, backend)
    assert recording.failure is not None
    assert recording.failure.instance == "MOVING-1"
    contact = recording.failure.contact
    assert contact is not None
    assert (contact.tokens, contact.allowed) == (("post", "pusher"), False)
    assert contact.force > task.limits.contact
    assert recording.failure.reason == (
        f"post and pusher touched with {contact.force:.1f} N at {contact.time:.3f} s; "
        "no running block allows more than 20 N between them"
    )
    assert recording.duration == contact.time


def test_the_limit_of_a_contact_is_a_setting_of_the_task(toys: Any) -> None:
    task, plan = pushing_at_a_post(toys)
    with open_backend("pybullet") as backend:
        recording = execute(task.replaced(limits=Limits(contact=1e4)), plan, backend)
    assert recording.failure is None or recording.failure.contact is None
    assert any(c.tokens == ("post", "pusher") and not c.allowed and c.force > 20.0 for c in recording.contacts)


def test_a_block_may_allow_a_contact(toys: Any) -> None:
    allowing = toys.world.block(allowed_contacts=(("pusher", FLOOR),))
    for allowed, world in ((False, toys.world), (True, allowing)):
        task = world.pusher().spot(height=0.0).task()
        with open_backend("pybullet") as backend:
            recording = execute(task, toys.one_move(), backend)
        assert recording.failure is not None  # The floor prevents the pusher from reaching the spot.
        assert (recording.failure.contact is None) == allowed
        assert allowed or recording.failure.reason.startswith("pusher and the floor touched with ")


NEAR_START = Predicate(
    "near_start",
    (Parameter("pusher", TOKEN),),
    lambda state, pusher: 0.1 - np.abs(state[pusher, "position"][..., 0]),
    unit="m",
    scale=0.01,
    reads={"pusher": ("position",)},
    denial="{pusher} is far from its start",
)


def test_an_invariant_that_is_violated_fails_the_run(toys: Any) -> None:
    task = toys.one_move_task(invariants=(NEAR_START("pusher"),))
    recording = run(task, toys.one_move())
    assert recording.failure is not None
    assert recording.failure.instance == "MOVING-1"
    assert recording.failure.reason.startswith("pusher is far from its start at ")
    [margin] = recording.failure.margins
    # The tolerance is half the scale. A control period adds little.
    assert -0.012 < margin.measured < -0.005


def test_a_run_ends_in_the_period_of_the_fault_no_matter_how_many_periods_are_checked_together(
    toys: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Exit conditions that hold only after the fault must not count, and later contacts must not be recorded."""
    task = toys.one_move_task(invariants=(NEAR_START("pusher"),))
    pushed, plan = pushing_at_a_post(toys)
    found = []
    for chunk in (1, 7, 1000):
        monkeypatch.setattr("hybrid_tamp.execution.monitors.CHUNK", chunk)
        with open_backend("pybullet") as backend:
            found.append((run(task, toys.one_move()), execute(pushed, plan, backend)))
    for one, other in zip(found[0] * 2, (*found[1], *found[2]), strict=True):
        assert (one.failure, one.instances, one.contacts) == (other.failure, other.instances, other.contacts)
        assert np.array_equal(one.states, other.states)
        assert np.array_equal(one.commands, other.commands)


def test_a_block_ends_when_its_exit_is_measured_not_when_it_was_planned(toys: Any) -> None:
    task = toys.one_move_task()
    recording = run(task, toys.one_move())
    moving = next(instance for instance in recording.instances if instance.name == "MOVING-1")
    assert moving.start == pytest.approx(0.1)
    conditions = (Atom("near", ("pusher", "spot")), Atom("at_rest", ("pusher",)))
    assert all(task.margin(atom, recording.at(moving.end)) >= 0 for atom in conditions)
    assert any(task.margin(atom, recording.at(moving.end - STEP)) < 0 for atom in conditions)
    assert moving.end != pytest.approx(1.1)


def test_the_last_instances_run_long_enough_to_measure_rest(toys: Any) -> None:
    recording = run(toys.one_move_task(), toys.one_move())
    last = recording.instances[-1]
    assert last.name == "RESTING-2"
    assert last.end - last.start == pytest.approx(SETTLING, abs=STEP)
    slow = replace(toys.resting, duration=duration(0.8, 3600.0))
    task = toys.one_move_task()
    domain = replace(task.domain, blocks=(task.domain.block_by_name["MOVING"], slow))
    recording = run(task.replaced(domain=domain), toys.one_move())
    assert recording.instances[-1].end - recording.instances[-1].start == pytest.approx(0.8, abs=STEP)


def test_hyperparameters_come_from_the_plan_or_initial_values_and_are_recorded(toys: Any) -> None:
    task = toys.one_move_task()
    initial = run(task, toys.one_move())
    given = run(task, toys.one_move(stiffness=100.0))
    values = [
        next(i for i in recording.instances if i.name == "MOVING-1").hyperparameters for recording in (initial, given)
    ]
    assert values == [{"stiffness": 200.0}, {"stiffness": 100.0}]
    assert initial.duration != given.duration


def test_whoever_is_ready_first_goes_first(toys: Any) -> None:
    """Two independent moves end in the measured order, and not in the estimated order of the plan."""
    world = toys.world.pusher("far", position=(0, 1, 0.5)).pusher("close", position=(0.3, 0, 0.5))
    task = world.spot("a", x=0.4).spot("b", x=0.4).task(Atom("near", ("close", "b")))
    state = task.state.replace({("a", "position"): (0.4, 1, 0.5)})
    instances = (
        toys.rest("RESTING-1", 0.0, 0.1, "far"),
        toys.rest("RESTING-2", 0.0, 0.1, "close"),
        toys.move("MOVING-1", 0.1, 1.0, "far", "a", stiffness=100.0),
        toys.move("MOVING-2", 0.1, 2.0, "close", "b", stiffness=200.0),
        toys.rest("RESTING-3", 1.0, 2.1, "far"),
        toys.rest("RESTING-4", 2.0, 2.1, "close"),
    )
    task = task.replaced(state=state)
    recording = run(task, TaskPlan(instances, 2.1))
    assert recording.success
    ends = {instance.name: instance.end for instance in recording.instances}
    assert ends["MOVING-2"] < ends["MOVING-1"]
    assert check_law(task, recording.plan, recording.at) == []


def test_a_hold_waits_for_a_later_event(toys: Any) -> None:
    """Two pushers wait at their spots until both have arrived, because both then move to the same spot."""
    world = toys.world.block(hold=True).pusher("far").pusher("close", position=(0.38, 1, 0.5))
    world = world.spot("a").spot("b").spot("c", x=0.2, radius=0.3)
    task = world.task(Atom("near", ("far", "c")))
    task = task.replaced(state=task.state.replace({("b", "position"): (0.4, 1, 0.5)}))
    instances = (
        toys.move("MOVING-1", 0.0, 1.0, "far", "a"),
        toys.move("MOVING-2", 0.0, 1.0, "close", "b"),
        toys.move("MOVING-3", 1.0, 2.0, "far", "c"),
        toys.move("MOVING-4", 1.0, 2.0, "close", "c", stiffness=50.0),
    )
    task = task.replaced(assignment={"far": "MOVING", "close": "MOVING"})
    recording = run(task, TaskPlan(instances, 2.0))
    ends = {instance.name: instance.end for instance in recording.instances}
    assert ends["MOVING-1"] == ends["MOVING-2"]


def test_overdue_block_fails_with_atom_and_margin(toys: Any) -> None:
    task = toys.one_move_task(duration=duration(0.2, 0.3))
    recording = run(task, toys.one_move())
    failure = recording.failure
    assert not recording.success
    assert failure.step == 2
    assert failure.instance == "MOVING-1"
    assert "exceeded its maximum duration of 0.3 s" in failure.reason
    assert "near(pusher, spot) does not hold (margin -" in failure.reason
    [near, *_] = failure.margins
    assert near.atom.text == "near(pusher, spot)"
    assert near.measured == pytest.approx(task.margin(Atom("near", ("pusher", "spot")), recording.state(-1)))
    assert recording.instances[-1].end == recording.duration == pytest.approx(0.4, abs=2 * STEP)


def test_block_without_hold_that_cannot_leave_fails(toys: Any) -> None:
    """The exit conditions hold, but the next instance cannot begin, because the second pusher never arrives."""
    world = toys.world.pusher("one").pusher("two", position=(0, 1, 0.5)).spot("a").spot("b").spot("c")
    task = world.task(Atom("near", ("one", "c")))
    instances = (
        toys.move("MOVING-1", 0.0, 1.0, "one", "a"),
        toys.move("MOVING-2", 0.0, 1.0, "two", "b", stiffness=1.0),
        toys.move("MOVING-3", 1.0, 2.0, "one", "c"),
        toys.move("MOVING-4", 1.0, 2.0, "two", "c"),
    )
    recording = run(task, TaskPlan(instances, 2.0))
    assert recording.failure.instance == "MOVING-1"
    assert "cannot leave" in recording.failure.reason
    assert recording.duration == pytest.approx(3.0, abs=2 * STEP)


def test_holding_block_must_have_reached_its_exit_in_time(toys: Any) -> None:
    task = toys.one_move_task(duration=duration(0.2, 0.3), hold=True)
    assert "exceeded its maximum duration" in run(task, toys.one_move()).failure.reason


def test_a_wait_that_never_ends_is_a_failure(toys: Any) -> None:
    """RESTING has no effective bound, and the next RESTING never begins, because the pusher is not at rest."""
    task = toys.world.pusher(velocity=(0.5, 0, 0)).task()
    plan = TaskPlan((toys.rest("RESTING-1", 0.0, 0.1), toys.rest("RESTING-2", 0.1, 0.2)), 0.2)
    recording = run(task, plan)
    assert recording.failure.instance == "RESTING-2"
    assert "cannot happen: RESTING-2: at_rest(pusher) does not hold (margin -0.48" in recording.failure.reason
    assert recording.duration == pytest.approx(0.1 + PATIENCE, abs=3 * STEP)


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_command_that_is_not_finite_names_the_block(toys: Any, bad: float) -> None:
    recording = run(toys.one_move_task(policy=commanding([bad, 0.0, 0.0])), toys.one_move())
    assert recording.failure.instance == "MOVING-1"
    assert "the policy of MOVING must command finite values, got force" in recording.failure.reason
    assert np.isfinite(recording.commands).all()


def test_hyperparameter_that_is_not_finite_is_a_failure(toys: Any) -> None:
    recording = run(toys.one_move_task(), toys.one_move(stiffness=math.nan))
    assert recording.failure.instance == "MOVING-1"
    assert "hyperparameter stiffness of MOVING-1 must be finite, got nan" in recording.failure.reason


def test_state_that_is_not_finite_is_a_failure_and_not_recorded(toys: Any) -> None:
    def diverging(binding: Any, start: Any) -> Any:
        return lambda state, commands, dt: state.replace({("pusher", "velocity"): (math.nan, 0, 0)})

    recording = run(toys.one_move_task(system=diverging), toys.one_move())
    assert recording.failure.instance == "MOVING-1"
    assert "the velocity of pusher is not finite" in recording.failure.reason
    assert np.isfinite(recording.states).all()
    assert len(recording.commands) == len(recording.times) - 1


def test_margin_that_is_no_number_counts_as_not_measured(toys: Any) -> None:
    nan = replace(toys.near, margin=lambda state, pusher, spot: np.asarray(math.nan))
    moving = replace(toys.moving, exit=(nan("pusher", "spot"), toys.at_rest("pusher")))
    task = toys.one_move_task()
    domain = replace(task.domain, predicates=(nan, toys.at_rest), blocks=(moving, toys.resting))
    task = task.replaced(domain=domain)
    recording = run(task, toys.one_move())
    assert recording.failure.margins[0].measured is None
    assert "is not a number" in recording.failure.reason


def test_commands_are_cut_to_their_limit_once_for_all_and_it_is_said(toys: Any, caplog: Any) -> None:
    task = toys.world.pusher(limit=2.0).spot().task()
    with caplog.at_level(logging.WARNING):
        recording = run(task, toys.one_move(stiffness=100.0))
    norms = np.linalg.norm(recording.commands, axis=1)
    assert norms.max() == pytest.approx(2.0)
    [said] = recording.warnings
    assert "MOVING-1: the force on pusher was limited" in said
    assert said in caplog.text


@pytest.mark.parametrize(
    ("policy", "said"),
    [
        (commanding(np.zeros(2)), r"MOVING.policy, force of pusher: the result must have the shape \(3,\)"),
        (commanding(np.zeros(3), action="torque"), "an action of a token in a slot of the block; got torque of pusher"),
        (commanding(np.zeros(3), token="spot"), "an action of a token in a slot of the block; got force of spot"),
    ],
)
def test_policy_that_commands_what_it_may_not_is_the_domains_fault(toys: Any, policy: Any, said: str) -> None:
    with pytest.raises(DomainError, match=said):
        run(toys.one_move_task(policy=policy), toys.one_move())


def test_goal_that_is_missed_is_no_failure_of_the_run_but_no_success(toys: Any) -> None:
    task = toys.one_move_task().replaced(goal=(Atom("near", ("pusher", "spot"), positive=False),))
    recording = run(task, toys.one_move())
    assert recording.failure is None
    assert not recording.success
    assert not recording.goal[0].holds


def test_nothing_to_do_is_still_measured(toys: Any) -> None:
    task = toys.world.pusher().task(Atom("at_rest", ("pusher",)))
    recording = run(task, TaskPlan((toys.rest("RESTING-1", 0.0, 0.1),), 0.1))
    assert recording.success
    assert recording.duration == pytest.approx(SETTLING)


def test_events_are_told_as_they_happen(toys: Any, tmp_path: Path) -> None:
    task = toys.one_move_task()
    seen: list[Event] = []
    run(task, toys.one_move(), observer=seen.append)
    assert [event.event for event in seen] == [
        "begin",
        *("reassignment", "end", "begin") * 2,
        "end",
        "goal",
    ]
    with EventLog(tmp_path / "events.jsonl") as log:
        run(task, toys.one_move(), observer=log)
        # The file is flushed, so a reader sees every event.
        lines = (tmp_path / "events.jsonl").read_text(encoding="utf-8").splitlines()
    documents = [json.loads(line) for line in lines]
    assert len(documents) == len(seen)
    begin = next(d for d in documents if d["event"] == "begin" and d["block"] == "MOVING")
    assert begin["instance"] == "MOVING-1"
    assert begin["slots"] == {"pusher": "pusher"}
    assert begin["targets"] == {"spot": "spot"}
    assert begin["hyperparameters"] == {"stiffness": 200.0}
    assert all(set(document) == set(begin) for document in documents)
    assert documents[-1]["margins"][0]["holds"]


def test_event_log_appends_and_has_no_infinity(tmp_path: Path, toys: Any) -> None:
    path = tmp_path / "events.jsonl"
    for _ in range(2):
        with EventLog(path) as log:
            log(Event(0.0, "failure", hyperparameters={"speed": math.inf}, reason="x"))
    first, second = path.read_text(encoding="utf-8").splitlines()
    assert first == second
    assert json.loads(first)["hyperparameters"] == {"speed": None}


def test_failure_is_an_event_too(toys: Any) -> None:
    seen: list[Event] = []
    run(toys.one_move_task(duration=duration(0.2, 0.3)), toys.one_move(), observer=seen.append)
    assert seen[-1].event == "failure"
    assert seen[-1].to_document()["block"] == "MOVING"
    assert [event.event for event in seen].count("begin") == [event.event for event in seen].count("end")


def test_progress_is_told(toys: Any) -> None:
    told: list[tuple[float, float]] = []
    recording = run(toys.one_move_task(), toys.one_move(), progress=lambda now, end: told.append((now, end)))
    assert len(told) == len(recording.commands) // 24
    assert told[0] == (pytest.approx(0.1), 1.2)


def test_who_reads_what_another_holds_waits_until_it_is_still() -> None:
    """Two hands approach a box that two other hands hold tipped, but only after the box is at rest (law 5)."""
    task = random_tumbling(3, hands=4)
    plan = hybrid_tamp.plan(task).required()
    recording = run(task, plan)
    assert recording.success
    assert check_law(task, recording.plan, recording.at) == []
    tipping = next(i for i in recording.instances if i.block == "TIPPING:opposite")
    later = [i for i in recording.instances if i.block == "REACHING:beside" and i.start > tipping.start]
    assert len(later) == 2
    assert all(tipping.reached is not None and i.start >= tipping.reached for i in later)
