"""Comparison of rollouts of populations with single runs in the forward models of the blocks."""

from dataclasses import replace

import numpy as np
import pytest
from midlevel.plans import reach_and_roll
from predicted_runs import predict
from scenes import rolling_task

import hybrid_tamp
from hybrid_tamp.midlevel.measured import measure_run
from hybrid_tamp.midlevel.rollout import Rollouts
from hybrid_tamp.model.affordance import TOKEN
from hybrid_tamp.model.measure import Measure
from hybrid_tamp.model.predicate import Parameter, Predicate
from hybrid_tamp.model.refined import GOAL
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.dmp import DMP
from hybrid_tamp.motion.minimum_jerk import minimum_jerk


def _rolling(**changes: object) -> Task:
    """Return a rolling task with a performance measure of each kind."""
    task = rolling_task()
    rolling = task.domain.block_by_name["ROLLING"]

    def speed(binding, state):  # type: ignore[no-untyped-def]
        return np.linalg.norm(state[binding["object"], "velocity"], axis=-1)

    def force(binding, state, commands):  # type: ignore[no-untyped-def]
        return np.linalg.norm(commands[binding["hand"].name, "force"], axis=-1)

    def way(binding, before, after, hyperparameters):  # type: ignore[no-untyped-def]
        thing = binding["object"]
        return np.linalg.norm(after[thing, "position"] - before[thing, "position"], axis=-1)

    measures = (
        Measure("top_speed", "m/s", 2.0, peak=speed),
        Measure("impulse", "N s", -0.1, scale=10.0, rate=force),
        Measure("way", "m", 1.0, end=way),
    )
    block = replace(rolling, performance=measures, **changes)
    return task.replaced(domain=task.domain.with_blocks([block]))


@pytest.fixture(scope="module")
def task() -> Task:
    return _rolling()


def test_an_invariant_counts_with_its_least_margin() -> None:
    def height(state, hand):  # type: ignore[no-untyped-def]
        return 0.503 - state[hand, "position"][..., 2]

    low = Predicate("low", (Parameter("hand", TOKEN),), height, unit="m", scale=0.01, reads={"hand": ("position",)})
    task = rolling_task()
    behind = task.domain.block_by_name["REACHING:behind"]
    reaching = replace(behind, invariants=(*behind.invariants, low("hand")))
    others = [replace(b, keeps=(*b.keeps, low)) for b in task.domain.blocks if b.name != reaching.name]
    task = task.replaced(domain=task.domain.with_blocks([*others, reaching], [low]))
    plan = reach_and_roll(task)
    run, rollout = predict(task, plan), Rollouts(task, plan)({})
    [highest] = [c for c in rollout.conditions if c.throughout and c.atom.predicate == "low"]
    # A reach is higher in its middle than at both ends.
    assert highest.where == "REACHING-1"
    assert highest.margin[0] == pytest.approx(0.503 - run.trajectory["hand 0", "position"][:, 2].max(), abs=1e-6)
    assert rollout.violation[0] == pytest.approx(max(0.0, -highest.margin[0]) / 0.01)


def test_a_single_rollout_is_the_executors_run(task: Task) -> None:
    plan = reach_and_roll(task)
    run, rollout = predict(task, plan), Rollouts(task, plan)({})
    assert run.success
    np.testing.assert_allclose(rollout.final.values[0], run.states[-1], atol=1e-12)
    for instance in run.instances:
        begin, reached, end = rollout.intervals[instance.name]
        assert (begin[0], reached[0], end[0]) == pytest.approx((instance.start, instance.active.end, instance.end))
    assert rollout.violation[0] == 0.0
    assert rollout.worst() is None


def test_measures_are_those_of_the_recorded_run(task: Task) -> None:
    plan = reach_and_roll(task)
    run, rollout = measure_run(task, predict(task, plan)), Rollouts(task, plan)({})
    assert rollout.figures.keys() == run.figures.keys()
    for key, figure in rollout.figures.items():
        assert figure[0] == pytest.approx(run.figures[key][0], rel=1e-9), key
    assert rollout.value[0] == pytest.approx(run.value[0])
    assert rollout.figures["ROLLING-1", "way"][0] == pytest.approx(0.7, abs=0.02)
    assert {c.atom for c in rollout.conditions} == {c.atom for c in run.conditions}


def test_a_population_is_its_candidates_one_by_one(task: Task) -> None:
    rng = np.random.default_rng(7)
    plan = reach_and_roll(task)
    chosen = {
        ("REACHING-1", "duration"): rng.uniform(1.0, 3.0, 5),
        ("ROLLING-1", "distance"): rng.uniform(0.4, 0.9, 5),
        ("ROLLING-1", "speed"): rng.uniform(0.2, 0.5, 5),
    }
    rollouts = Rollouts(task, plan)
    together = rollouts(chosen, 5)
    for index in range(5):
        alone = Rollouts(task, plan)({key: values[index : index + 1] for key, values in chosen.items()})
        np.testing.assert_allclose(alone.final.values[0], together.final.values[index], atol=1e-12)
        assert alone.violation[0] == pytest.approx(together.violation[index], abs=1e-12)
        assert alone.value[0] == pytest.approx(together.value[index], rel=1e-12)
    again = rollouts(chosen, 5)
    np.testing.assert_array_equal(together.final.values, again.final.values)


def test_a_missed_condition_is_a_violation_and_the_chain_goes_on(task: Task) -> None:
    plan = reach_and_roll(task)
    rollout = Rollouts(task, plan)({("ROLLING-1", "distance"): np.array([0.7, 0.5])}, 2)
    assert rollout.violation[0] == 0.0
    missed = rollout.worst(1)
    assert missed is not None
    assert (missed.where, missed.atom.text) == ("ROLLING-1", "inside(drum 0, region 0)")
    goal = next(c for c in rollout.conditions if c.where == GOAL)
    # The hand continues to its rest 0.2 m short of a region of radius 0.02 m.
    assert goal.margin[1] == pytest.approx(-0.18, abs=0.01)
    assert rollout.violation[1] == pytest.approx(2 * 0.18 / 0.01, rel=0.1)


def test_what_is_not_finite_is_named_and_spoils_no_other_candidate() -> None:
    task = rolling_task()
    whole = task.domain.block_by_name["ROLLING"].system

    def broken(binding, start):  # type: ignore[no-untyped-def]
        system = whole(binding, start)

        def step(state, commands, dt):  # type: ignore[no-untyped-def]
            after = system(state, commands, dt)
            fast = np.linalg.norm(after[binding["object"], "velocity"], axis=-1) > 0.3
            return replace(after, values=np.where(fast[..., None], np.nan, after.values))

        return step

    block = replace(task.domain.block_by_name["ROLLING"], system=broken)
    task = task.replaced(domain=task.domain.with_blocks([block]))
    rollout = Rollouts(task, reach_and_roll(task))({("ROLLING-1", "speed"): np.array([0.2, 0.5])}, 2)
    assert rollout.violation.tolist() == [0.0, np.inf]
    assert {name: where.tolist() for name, where in rollout.failed.items()} == {"ROLLING-1": [False, True]}


def test_until_an_instance_the_rest_is_left_out(task: Task) -> None:
    rollout = Rollouts(task, reach_and_roll(task))({}, 3, until="REACHING-1")
    assert {c.where for c in rollout.conditions} == {"REACHING-1"}
    assert rollout.value.tolist() == [0.0, 0.0, 0.0]


def test_hands_that_hold_while_others_come_are_as_in_the_executor() -> None:
    task = hybrid_tamp.load_task("problems/tumble_four_hands.yaml")
    plan = hybrid_tamp.plan(task).required()
    run, rollout = predict(task, plan), Rollouts(task, plan)({})
    assert run.success
    assert rollout.violation[0] == 0.0
    for instance in run.instances:
        begin, reached, end = rollout.intervals[instance.name]
        assert (begin[0], reached[0], end[0]) == pytest.approx((instance.start, instance.active.end, instance.end))
    # Hands reach for the predicted pose of a tipped box. While the hands approach, the box settles by less than this
    # value.
    np.testing.assert_allclose(rollout.final.values[0], run.states[-1], atol=1e-3)


def test_a_movement_that_begins_slowly_is_not_given_up() -> None:
    """A primitive in which the box does not move during the first half of the time still tips the box."""
    task = hybrid_tamp.load_task("problems/tumble_two_hands.yaml")
    time = np.linspace(0.0, 1.0, 201)
    late = DMP.imitate(time, minimum_jerk(np.clip(2.0 * time - 1.0, 0.0, 1.0))[:, None])
    tipping = task.domain.block_by_name["TIPPING:opposite"]
    assert tipping.taught is not None
    taught = task.replaced(domain=task.domain.with_blocks([tipping.taught(late)]))
    rollout = Rollouts(taught, hybrid_tamp.plan(taught).required())({}, until="TIPPING-1")
    assert rollout.violation[0] == 0.0
