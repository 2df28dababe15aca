"""Tests of the mid-level planner in a toy world with closed forms."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from clocks import hurried
from midlevel.pucks import APART, FIRST, JOINT, SECOND, puck_plan, puck_task, with_dummies

from hybrid_tamp.errors import LimitReached
from hybrid_tamp.midlevel.plan_search import NotFinite
from hybrid_tamp.midlevel.refinement import refine
from hybrid_tamp.model.deadline import Deadline
from hybrid_tamp.model.kind import Kind
from hybrid_tamp.model.measure import Measure
from hybrid_tamp.model.predicate import Parameter, Predicate, SymbolSort
from hybrid_tamp.model.refined import RefinedPlan


def values(refined: RefinedPlan) -> dict[str, float]:
    return {tuned.name: tuned.value for tuned in refined.hyperparameters}


@pytest.mark.parametrize("optimiser", ["cma", "grid"])
def test_planning_ahead_finds_the_joint_optimum(optimiser: str) -> None:
    refined = refine(puck_task(optimiser=optimiser), puck_plan())
    tolerance = 2e-3 if optimiser == "cma" else 0.05
    assert values(refined) == pytest.approx({"a": 0.5, "b": 0.5}, abs=tolerance)
    assert refined.best.value == pytest.approx(JOINT, abs=tolerance**2 * 6)
    assert refined.best.violation == 0.0
    assert refined.apart is not None
    assert refined.apart.value == pytest.approx(APART, abs=1e-3)
    assert [tuned.apart for tuned in refined.hyperparameters] == pytest.approx([0.2, 0.2], abs=1e-2)
    assert refined.defaults.value == pytest.approx(-(0.2**2) - 0.8**2)
    assert refined.plan.timeline("puck")[1][0].hyperparameters["a"] == values(refined)["a"]


def test_it_is_told_what_each_hyperparameter_moves() -> None:
    moves = {tuned.name: tuned.moves for tuned in refine(puck_task(), puck_plan()).hyperparameters}
    assert moves == {
        "a": (("FIRST-1", "start"), ("SECOND-1", "later"), ("SECOND-1", "along")),
        "b": (("SECOND-1", "along"),),
    }


def test_where_actions_do_not_interact_the_joint_optimum_is_the_separate_one() -> None:
    second = replace(SECOND, performance=(Measure("own", "m^2", 1.0, end=_second_alone),))
    refined = refine(puck_task(second=second), puck_plan())
    assert values(refined) == pytest.approx({"a": 0.2, "b": -0.3}, abs=2e-3)
    assert refined.apart is not None
    assert refined.best.value == pytest.approx(refined.apart.value, abs=1e-5)


def _second_alone(b: Any, before: Any, after: Any, h: Any) -> Any:
    return -((after[b["puck"], "place"][..., 1] + 0.3) ** 2)


def test_equal_choices_are_taken_from_the_middle() -> None:
    def plateau(b: Any, before: Any, after: Any, h: Any) -> Any:
        return -np.maximum(np.abs(after[b["puck"], "place"][..., 0] - 0.4) - 0.3, 0.0)

    first = replace(FIRST, performance=(Measure("plateau", "m", 1.0, end=plateau),))
    refined = refine(puck_task(first=first), puck_plan())
    assert refined.hyperparameters[0].apart == pytest.approx(0.4, abs=0.01)


@pytest.mark.parametrize("optimiser", ["cma", "grid"])
def test_one_hyperparameter_is_searched_as_it_is(optimiser: str) -> None:
    def plateau(b: Any, before: Any, after: Any, h: Any) -> Any:
        return -np.maximum(np.abs(after[b["puck"], "place"][..., 0] - 0.4) - 0.3, 0.0)

    first = replace(FIRST, performance=(Measure("plateau", "m", 1.0, end=plateau),))
    still = replace(SECOND.hyperparameters[0], lower=0.0, upper=0.0)
    second = replace(SECOND, hyperparameters=(still,), performance=())
    a, b = refine(puck_task(first, second, optimiser=optimiser), puck_plan()).hyperparameters
    # At the end, all candidates are equally good, but the hyperparameter still has an effect.
    assert (a.status, a.moves, b.status) == ("optimised", (("FIRST-1", "plateau"),), "fixed")
    assert 0.1 <= a.value <= 0.7
    idle = replace(first, performance=(Measure("idle", "m", 1.0, end=lambda b, s, e, h: 0.0 * h["a"]),))
    a, b = refine(puck_task(idle, second, optimiser=optimiser), puck_plan()).hyperparameters
    assert (a.status, a.moves, a.value) == ("free", (), a.default)


def test_dummies_are_free_and_what_acts_through_an_interaction_is_not() -> None:
    def together(b: Any, before: Any, after: Any, h: Any) -> Any:
        # At the defaults, which are all zero, neither hyperparameter has an effect.
        return 0.1 * h["c"] * (h["d"] - 0.0) - 0.05 * h["d"] ** 2

    along = SECOND.performance[1]
    second = with_dummies(["c", "d", "z1", "z2"], SECOND)
    second = replace(second, performance=(along, Measure("together", "1", 1.0, end=together)))
    refined = refine(puck_task(with_dummies(["z3", "z4", "z5"]), second), puck_plan())
    status = {tuned.name: tuned.status for tuned in refined.hyperparameters}
    assert {name for name, each in status.items() if each == "free"} == {"z1", "z2", "z3", "z4", "z5"}
    free = [tuned for tuned in refined.hyperparameters if tuned.status == "free"]
    assert all(tuned.value == tuned.default and not tuned.moves for tuned in free)


def test_the_same_seed_gives_the_same_bits() -> None:
    one, other = (refine(puck_task(), puck_plan()) for _ in range(2))
    assert one.hyperparameters == other.hyperparameters
    assert (one.best, one.history) == (other.best, other.history)
    another = refine(puck_task().replaced(seed=1), puck_plan())
    assert another.history != one.history


def test_no_clock_decides_which_hyperparameters_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    idle = refine(puck_task(), puck_plan())
    hurried(monkeypatch, jump=3600.0)
    busy = refine(puck_task(), puck_plan())
    assert replace(busy, seconds=0.0) == replace(idle, seconds=0.0)


def test_the_progress_counts_evaluations(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[tuple[float, int]] = []
    hurried(monkeypatch)
    refine(puck_task(evaluations=1000), puck_plan(), lambda share, best: told.append((share, best.evaluations)))
    shares, counts = np.array(told).T
    assert 0.0 < shares[0] < shares[-1] <= 1.0
    left = counts / shares
    assert left == pytest.approx(left[0])


def test_a_deadline_ends_a_rollout() -> None:
    with pytest.raises(LimitReached, match="time limit of 0 s"):
        refine(puck_task(), puck_plan(), deadline=Deadline.after(0.0))


def test_weights_decide() -> None:
    start = FIRST.performance[0]
    first = replace(FIRST, performance=(replace(start, weight=1000.0),))
    assert values(refine(puck_task(first=first), puck_plan()))["a"] == pytest.approx(0.2, abs=5e-3)


def test_without_measures_defaults_that_do_are_kept() -> None:
    task = puck_task(*(replace(block, performance=()) for block in (FIRST, SECOND)))
    refined = refine(task, puck_plan())
    assert {tuned.status for tuned in refined.hyperparameters} == {"kept"}
    assert (refined.evaluations, refined.optimiser) == (1, "")


def test_what_is_not_a_number_everywhere_names_the_block() -> None:
    def nothing(b: Any, before: Any, after: Any, h: Any) -> Any:
        return after[b["puck"], "place"][..., 0] * np.nan

    second = replace(SECOND, performance=(Measure("nothing", "m", 1.0, end=nothing),))
    with pytest.raises(NotFinite, match=r"SECOND-1.*block SECOND"):
        refine(puck_task(second=second), puck_plan())


def test_the_violation_comes_first() -> None:
    # The exit of SECOND requires y < 2, so a weight that favours a larger b does not increase b beyond the limit.
    def far(b: Any, before: Any, after: Any, h: Any) -> Any:
        return after[b["puck"], "place"][..., 1]

    def low(state: Any, puck: Any) -> Any:
        return 0.25 - state[puck, "place"][..., 1]

    task = puck_task(second=replace(SECOND, performance=(Measure("far", "m", 1e6, end=far),)))
    strict = replace(task.domain.predicates[0], margin=low, scale=0.01)
    blocks = [replace(block, exit=(strict("puck"),)) for block in task.domain.blocks[:2]]
    domain = replace(task.domain, predicates=(strict,), blocks=(*blocks, task.domain.blocks[2]))
    refined = refine(task.replaced(domain=domain), puck_plan())
    assert refined.best.violation == 0.0
    # Half a scale of the goal's margin is reserved for errors in physics.
    assert values(refined)["b"] == pytest.approx(0.245, abs=2e-3)


def test_the_result_of_an_earlier_action_keeps_a_reserve_too() -> None:
    # The measure of FIRST is best at x = 0.2, but its exit conditions require x < 0.15, which is not a goal of the
    # task.
    def left(state: Any, puck: Any, zone: str) -> Any:
        return 0.15 - state[puck, "place"][..., 0]

    task = puck_task(second=replace(SECOND, performance=()))
    zone = Parameter("zone", SymbolSort("zone", ("left",)))
    parameters = (*task.domain.predicates[0].parameters, zone)
    within = Predicate("within", parameters, left, "m", 0.01, {"puck": ("place",)}, Kind.FUNCTIONAL, "zone")
    first, second, *others = task.domain.blocks
    first = replace(first, exit=(*first.exit, within("puck", "left")))
    second = replace(second, keeps=(within,))
    domain = replace(task.domain, predicates=(*task.domain.predicates, within), blocks=(first, second, *others))
    refined = refine(task.replaced(domain=domain), puck_plan())
    assert refined.best.violation == 0.0
    assert values(refined)["a"] == pytest.approx(0.145, abs=2e-3)
