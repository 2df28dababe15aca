"""Tests of the segmentation of recordings into blocks, with noise and with tokens that take no part."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import hybrid_tamp
from hybrid_tamp.execution.execute import execute
from hybrid_tamp.model.imitation import Segmentation
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.protocol import open_backend
from hybrid_tamp.questions.imitate.movement_check import count_pauses
from hybrid_tamp.questions.imitate.observation import Observation
from hybrid_tamp.questions.imitate.segmentation import segment
from hybrid_tamp.taskfile.loader import load_task

PROBLEMS = Path(__file__).resolve().parents[2] / "problems"
NEAR = 0.3
"""Largest accepted error of a boundary between instances [s]."""
UNSEEN = 0.02
"""A reach over a shorter distance [m] is not detected."""


@cache
def recorded(name: str, backend: str = "analytic") -> tuple[Task, Recording]:
    task = load_task(PROBLEMS / f"{name}.yaml")
    with open_backend(backend) as physics:
        recording = execute(task, hybrid_tamp.plan(task).required(), physics)
    assert recording.success
    return task, recording


def kind(instance: BlockInstance) -> tuple[object, ...]:
    return instance.block, tuple(sorted(instance.slots.items())), tuple(sorted(instance.targets.items()))


def visible(recording: Recording) -> list[BlockInstance]:
    """Return the instances without useless reaches, in which a hand reaches to the place where it already is.

    A plan may contain such a reach, with a rest after it. Nobody can see it in a recording. A plan in which the next
    instance begins earlier explains the recording as well.
    """
    found = list(recording.instances)
    for reach in [each for each in found if each.action == "REACHING"]:
        hand = reach.slots["hand"]
        before, after = (recording.at(time)[hand, "position"] for time in (reach.start, reach.end))
        mine = sorted((i for i in recording.instances if hand in i.slots.values()), key=lambda each: each.start)
        later = mine[mine.index(reach) + 1 :][:2]
        if np.linalg.norm(after - before) < UNSEEN and len(later) == 2 and later[0].action == "RESTING":
            found = [each for each in found if each not in (reach, *later)]
            found.append(replace(later[1], start=reach.start))
    return found


def check_given_back(recording: Recording, found: Segmentation) -> None:
    seen, whole, seeable = (
        sorted(instances, key=lambda i: (kind(i), i.start))
        for instances in (found.plan.instances, recording.instances, visible(recording))
    )
    true = whole if len(seen) == len(whole) else seeable
    assert list(map(kind, seen)) == list(map(kind, true))
    for a, b in zip(true, seen, strict=True):
        assert b.start == pytest.approx(a.start, abs=NEAR)
        assert b.end == pytest.approx(a.end, abs=NEAR)
    assert not found.unexplained


@pytest.mark.parametrize(
    ("name", "backend"),
    [
        ("roll_cylinder", "analytic"),
        ("roll_cylinder", "pybullet"),
        ("tumble_two_hands", "analytic"),
        ("tumble_two_hands", "pybullet"),
        ("tumble_four_hands", "analytic"),
        ("tumble_twice", "analytic"),
        ("tumble_two_boxes_four_hands", "analytic"),
        ("tumble_three_boxes_six_hands", "analytic"),
        ("lift_two_hands", "pybullet"),  # ends with a block that only holds
        ("hammer_push", "analytic"),
        ("hammer_strike", "pybullet"),
        ("hammer_push_then_strike", "analytic"),
    ],
)
def test_a_recording_is_given_back(name: str, backend: str) -> None:
    task, recording = recorded(name, backend)
    found = segment(task, Observation.of(recording.times, recording.trajectory))
    check_given_back(recording, found)
    assert not found.violations


def noisy(states: State, deviation: float) -> State:
    rng = np.random.default_rng(0)
    changes = {}
    for token, name, size in states.layout.entries:
        values = states[token, name] + deviation * rng.standard_normal((*states.values.shape[:-1], size))
        changes[token, name] = values / np.linalg.norm(values, axis=-1, keepdims=True) if size == 4 else values
    return states.replace(changes)


@pytest.mark.parametrize(
    ("name", "backend"),
    [
        ("roll_cylinder", "analytic"),
        ("roll_by_another_agent", "pybullet"),  # rests between two movements for no time
        ("tumble_two_hands", "analytic"),
        ("tumble_twice", "pybullet"),  # rests briefly
        ("hammer_push_then_strike", "pybullet"),  # noise decides to which side of its tool a hand leaves
    ],
)
def test_a_millimetre_of_noise_changes_nothing(name: str, backend: str) -> None:
    task, recording = recorded(name, backend)
    states = noisy(recording.trajectory, 0.001)
    check_given_back(recording, segment(task, Observation.of(recording.times, states)))


def test_noise_is_measured_and_margins_are_as_exact_as_that() -> None:
    task, recording = recorded("roll_cylinder")
    clean = Observation.of(recording.times, recording.trajectory)
    shaken = Observation.of(recording.times, noisy(recording.trajectory, 0.001))
    # Five rows are averaged.
    assert shaken.deviation["hand", "position"] == pytest.approx(np.full(3, 0.001 / np.sqrt(5.0)), rel=0.3)
    assert np.abs(clean.deviation["hand", "position"]).max() < 2e-5
    rest = task.domain.predicate_by_name["at_rest"]("token")
    loose, exact = (shaken.truth(rest, {"token": task.token_by_name["hand"]}, sure=sure) for sure in (3.0, 0.0))
    assert (loose | ~exact).all()
    assert loose.sum() > exact.sum()


def test_a_reach_was_for_what_was_made_use_of() -> None:
    """Two regions are almost in one line. The same place of the hand fits both, but the object rolls to one."""
    task = load_task(PROBLEMS / "roll_second_round.yaml")
    outcome = hybrid_tamp.plan(task, optimise=True)
    with open_backend("pybullet") as physics:
        recording = execute(task, outcome.required(), physics)
    found = segment(task, Observation.of(recording.times, recording.trajectory))
    check_given_back(recording, found)


def with_passer_by() -> tuple[Task, Recording, State]:
    """Return a recording of a roll in which a second hand moves around instead of resting."""
    task, recording = recorded("tumble_four_hands")
    states, rows = recording.trajectory, recording.times
    place = states["hand-4", "position"][0]
    phase = np.clip((rows - 0.5) / 1.5, 0.0, 1.0)
    aside = (np.sin(np.pi * phase) * 0.4)[:, None] * np.array([1.0, 0.5, 0.0])
    position = np.where((rows < 2.0)[:, None], place + aside, states["hand-4", "position"])
    velocity = np.gradient(position, rows, axis=0)
    return task, recording, states.replace({("hand-4", "position"): position, ("hand-4", "velocity"): velocity})


def test_a_hand_that_passes_by_without_purpose_is_told_and_spoils_nothing_else() -> None:
    task, recording, states = with_passer_by()
    found = segment(task, Observation.of(recording.times, states))
    assert {movement.token for movement in found.unexplained} == {"hand-4"}
    assert found.unexplained[0].start == pytest.approx(0.6, abs=NEAR)
    assert found.unexplained[-1].end == pytest.approx(2.0, abs=NEAR)
    assert any(violation.law == 1 and violation.where == "hand-4" for violation in found.violations)
    resting = task.domain.resting
    busy = sorted(kind(i) for i in recording.instances if i.block != resting)
    assert sorted(kind(i) for i in found.plan.instances if i.block != resting) == busy


def test_a_thing_that_moves_by_itself_is_told() -> None:
    task, recording = recorded("roll_cylinder")
    states = recording.trajectory
    still = np.broadcast_to(states["hand", "position"][0], states["hand", "position"].shape)
    frozen = states.replace({("hand", "position"): still, ("hand", "velocity"): 0.0})
    found = segment(task, Observation.of(recording.times, frozen))
    assert {movement.token for movement in found.unexplained} == {"drum"}
    assert all(instance.block == task.domain.resting for instance in found.plan.instances)


def test_nothing_but_states_is_read() -> None:
    """Tokens have another order and another start. A recording that is cut in the middle has the same first blocks."""
    task, recording = recorded("roll_cylinder")
    rows = recording.times < 5.0
    found = segment(task, Observation.of(recording.times[rows], State(recording.layout, recording.states[rows])))
    assert "REACHING:behind" in {instance.block for instance in found.plan.instances}
    assert "drum" in {movement.token for movement in found.unexplained}


def test_pauses_are_between_movements_only() -> None:
    time = np.arange(0.0, 4.0, 0.01)
    moving = ((time > 0.5) & (time < 1.5)) | ((time > 2.0) & (time < 3.0))
    speeds = np.where(moving, 0.2, 0.0)
    assert count_pauses(speeds, 0.01) == 1
    assert count_pauses(speeds[:170], 0.01) == 0
    assert count_pauses(speeds[:3], 0.01) == 0
    assert count_pauses(speeds + 0.05, 0.01) == 0
    assert count_pauses(speeds + 0.05, 0.01, slow=0.08) == 1
