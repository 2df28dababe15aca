import pytest
from clocks import hurried
from scenes import reach_and_roll, rolling_task

from hybrid_tamp.errors import LimitReached
from hybrid_tamp.model.deadline import Deadline
from hybrid_tamp.model.law import check_law
from hybrid_tamp.symbolic.decode import decode
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.estimates import Estimates
from hybrid_tamp.symbolic.pddl.operators import rename_arguments
from hybrid_tamp.symbolic.schedule import schedule
from hybrid_tamp.symbolic.strategies.rebinding import interchangeable, rebind_tokens

TASK = rolling_task(hands=2, drums=[(0, 0), (0, 0.5)], regions=[(0.7, 0), (0.7, 0.5)], goal=[(0, 0), (1, 1)])
ONE_HAND = reach_and_roll("hand-0", "drum-0", "region-0") + reach_and_roll("hand-0", "drum-1", "region-1")


def test_a_second_hand_takes_over_and_both_drums_roll_at_once() -> None:
    compilation = compile_task(TASK)
    plan = schedule(TASK, decode(compilation, ONE_HAND), ONE_HAND)
    shorter = rebind_tokens(compilation, plan, Estimates(TASK))
    assert shorter.makespan < 0.6 * plan.makespan
    assert check_law(TASK, shorter) == []
    assert {i.slots["hand"] for i in shorter.instances if i.block == "ROLLING"} == {"hand 0", "hand 1"}


def test_two_hands_change_places_where_each_is_nearer_to_the_others_drum() -> None:
    state = TASK.state.replace({("hand 0", "position"): (0.2, 0.5, 0.3), ("hand 1", "position"): (0.2, -0.4, 0.3)})
    task = TASK.replaced(state=state)
    actions = reach_and_roll("hand-0", "drum-0", "region-0") + reach_and_roll("hand-1", "drum-1", "region-1")
    compilation = compile_task(task)
    plan = schedule(task, decode(compilation, actions), actions)
    shorter = rebind_tokens(compilation, plan, Estimates(task))
    assert shorter.makespan < plan.makespan
    hands = {i.slots["object"]: i.slots["hand"] for i in shorter.instances if i.block == "ROLLING"}
    assert hands == {"drum 0": "hand 1", "drum 1": "hand 0"}


def test_a_count_of_actions_ends_the_search() -> None:
    compilation = compile_task(TASK)
    plan = schedule(TASK, decode(compilation, ONE_HAND), ONE_HAND)
    few = len(ONE_HAND) - 1
    assert rebind_tokens(compilation, plan, Estimates(TASK), most_actions=few) is plan


def test_no_clock_decides_which_tokens_are_rebound(monkeypatch: pytest.MonkeyPatch) -> None:
    compilation = compile_task(TASK)
    plan = schedule(TASK, decode(compilation, ONE_HAND), ONE_HAND)
    shorter = rebind_tokens(compilation, plan, Estimates(TASK))
    hurried(monkeypatch, jump=3600.0)
    assert rebind_tokens(compilation, plan, Estimates(TASK)) == shorter
    with pytest.raises(LimitReached):
        rebind_tokens(compilation, plan, Estimates(TASK), Deadline.after(60.0))


def test_only_equal_tokens_that_no_goal_names_take_over() -> None:
    assert interchangeable(TASK) == [["hand 0", "hand 1"]]
    assert interchangeable(rolling_task(hands=1)) == []


def test_a_hand_out_of_reach_takes_nothing_over() -> None:
    compilation = compile_task(TASK)
    tampered = [rename_arguments(action, {"hand-0": "hand-9"}) for action in ONE_HAND]
    assert compilation.reaches_goal(ONE_HAND)
    assert not compilation.reaches_goal(tampered)
    assert not compilation.reaches_goal(ONE_HAND[:-1])


@pytest.mark.parametrize("objective", ["length", "makespan"])
def test_the_objective_is_the_tasks(objective: str) -> None:
    assert TASK.replaced(objective=objective).objective == objective
