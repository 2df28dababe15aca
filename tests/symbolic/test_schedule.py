from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenes import reach_and_roll, rolling_task
from validation import read_action

from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import PlannedAction, at
from hybrid_tamp.symbolic.decode import OrderedInstance, UndecodableError, decode
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.schedule import InfeasibleScheduleError, schedule


def test_independent_blocks_run_at_once() -> None:
    task = rolling_task(hands=2, drums=[(0, 0), (0, 0.5)], regions=[(0.7, 0), (0.7, 0.5)], goal=[(0, 0), (1, 1)])
    actions = reach_and_roll("hand-0", "drum-0", "region-0") + reach_and_roll("hand-1", "drum-1", "region-1")
    plan = schedule(task, decode(compile_task(task), actions))
    rolls = [i for i in plan.instances if i.block == "ROLLING"]
    assert rolls[0].overlaps(rolls[1])


def test_one_hand_rolls_one_after_the_other() -> None:
    task = rolling_task(drums=[(0, 0), (0, 0.5)], regions=[(0.7, 0), (0.7, 0.5)], goal=[(0, 0), (1, 1)])
    actions = reach_and_roll("hand-0", "drum-0", "region-0") + reach_and_roll("hand-0", "drum-1", "region-1")
    plan = schedule(task, decode(compile_task(task), actions))
    rolls = [i for i in plan.instances if i.block == "ROLLING"]
    assert not rolls[0].overlaps(rolls[1])


def test_blocks_abut_and_the_second_roll_starts_where_the_first_ended() -> None:
    task = rolling_task(regions=[(0.7, 0), (-0.2, 0)], goal=[(0, 1)])
    actions = reach_and_roll("hand-0", "drum-0", "region-0")
    actions += reach_and_roll("hand-0", "drum-0", "region-1", "region-0")
    plan = schedule(task, decode(compile_task(task), actions))
    for token in ("hand 0", "drum 0"):
        spans = [i for i, _ in plan.timeline(token)]
        assert all(at(a.end, b.start) for a, b in pairwise(spans))
    second = [i for i in plan.instances if i.block == "ROLLING"][1]
    # The rollout of the first roll ends within 2 mm of the middle of its region.
    assert second.hyperparameters["distance"] == pytest.approx(0.9, abs=2e-3)


def test_an_infeasible_order_is_refused_with_its_cycle() -> None:
    task = rolling_task(hands=2, drums=[(0, 0), (0, 0.5)], regions=[(0.7, 0), (0.9, 0.5)])
    near = OrderedInstance("ROLLING-1", "ROLLING", {"hand": "hand 0", "object": "drum 0"}, {"region": "region 0"}, 1, 2)
    far = OrderedInstance("ROLLING-2", "ROLLING", {"hand": "hand 1", "object": "drum 1"}, {"region": "region 1"}, 1, 2)
    with pytest.raises(InfeasibleScheduleError, match=r"ROLLING-2 lasts .* ROLLING-1 lasts|ROLLING-1 lasts .*"):
        schedule(task, [near, far])


def test_what_is_no_plan_is_not_decoded() -> None:
    compilation = compile_task(rolling_task())
    with pytest.raises(UndecodableError, match="no action"):
        decode(compilation, [PlannedAction("jump", ("hand-0",))])
    with pytest.raises(UndecodableError, match="all slots of ROLLING must be filled"):
        decode(compilation, [read_action("(begin-rolling-from-resting drum-0 region-0 no-region-of-inside)")])


@given(st.floats(0.2, 1.0), st.floats(-0.8, 0.8), st.floats(0.15, 0.6))
def test_every_schedule_obeys_the_law_whatever_its_durations(distance: float, side: float, height: float) -> None:
    task = rolling_task(regions=[(distance, 0.0)])
    task = task.replaced(state=task.state.replace({("hand 0", "position"): (0.4, side, height)}))
    plan = schedule(task, decode(compile_task(task), reach_and_roll("hand-0", "drum-0", "region-0")))
    assert check_law(task, plan) == []
