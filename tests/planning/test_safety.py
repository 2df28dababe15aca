"""If only a safety factor excludes all plans, the task is not proven unsolvable, and the answer states both figures."""

from collections.abc import Iterator

import pytest
from bank import problem

import hybrid_tamp
from hybrid_tamp.feasibility.safety_figures import find_blocked
from hybrid_tamp.model.change import SetFactor
from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.facts import static_facts
from hybrid_tamp.model.outcome import PlanOutcome
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.plan import plan_task
from hybrid_tamp.planning.safety import blame_factors
from hybrid_tamp.questions.changes import apply_change
from hybrid_tamp.questions.explain.no_plan import explain_outcome
from hybrid_tamp.questions.explain.property_changes import find_factor_changes
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess

BEARS = [Atom("bears", (hand, "crate", "two hands")) for hand in ("left-hand", "right-hand")]


@pytest.fixture(scope="module")
def planner() -> Iterator[PlannerProcess]:
    with PlannerProcess() as process:
        yield process


def crate(mass: float, factor: float = 1.5) -> Task:
    """Return a task in which two hands lift a crate, with a safety factor. Two hands bear 222.8 N by friction."""
    return problem("lift_heavy_two_hands", ("mass: 24", f"mass: {mass}")).with_safety({"bears": factor})


def plan_safely(task: Task, planner: PlannerProcess, deadline: Deadline = NEVER) -> PlanOutcome:
    return blame_factors(plan_task(task, planner), planner, deadline)


def test_a_message_says_what_physics_forbids_and_what_blocks_cannot_do() -> None:
    askew, heavy = (
        [reason.message for reason in outcome.explanation.reasons]
        for outcome in (hybrid_tamp.plan(problem("roll_cylinder_off_axis")), hybrid_tamp.plan(crate(24)))
        if outcome.explanation is not None
    )
    assert any("(off by 0.078 m; a limit of the available actions, not of physics)" in message for message in askew)
    assert heavy
    assert not any("limit of the blocks" in message for message in heavy)


@pytest.mark.parametrize(
    ("mass", "factor", "status"),
    [(24, 1.5, "unsolvable"), (24, 1.0, "unsolvable"), (20, 1.5, "unknown"), (20, 1.1, "solved"), (15, 1.5, "solved")],
)
def test_only_the_physical_bound_proves_anything(
    planner: PlannerProcess, mass: float, factor: float, status: str
) -> None:
    outcome = plan_safely(crate(mass, factor), planner)
    assert outcome.status == status
    assert outcome.task.domain.safety == {"bears": factor}


def test_the_answer_names_the_facts_and_both_figures(planner: PlannerProcess) -> None:
    outcome = plan_safely(crate(20), planner)
    error = outcome.error
    assert error is not None
    assert error.exit_status == 11
    assert outcome.failure is not None
    assert outcome.failure.detail == (
        "bears(left-hand, crate, two hands) and bears(right-hand, crate, two hands): 196.2 N needed; left-hand and "
        "right-hand bear 154.6 N with safety factor 1.5, 222.8 N without the factor."
    )


def test_a_suggestion_lowers_the_factor(planner: PlannerProcess) -> None:
    outcome = explain_outcome(plan_safely(crate(20), planner), 3, 1, NEVER)
    assert outcome.explanation is not None
    assert outcome.explanation.kind == "safety"
    (suggestion,) = outcome.explanation.suggestions
    assert isinstance(suggestion.change, SetFactor)
    assert suggestion.change.what == "safety factor of bears lowered from 1.5 to 1.15"
    (reason, *_) = outcome.explanation.reasons
    assert "and 154.6 N in total with safety factor 1.5, 222.8 N without" in reason.message


def test_a_lowered_factor_is_as_large_as_possible() -> None:
    task = crate(20)
    (change,) = find_factor_changes(task, BEARS[0])
    assert change.factor == 1.15
    assert set(BEARS) <= static_facts(apply_change(task, change))
    assert not set(BEARS) & static_facts(task.with_safety({"bears": 1.17}))
    assert not list(find_factor_changes(crate(24), BEARS[0]))
    assert not list(find_factor_changes(crate(15), BEARS[0]))


def test_facts_that_only_the_factor_excludes() -> None:
    assert find_blocked(crate(20)) == BEARS
    assert find_blocked(crate(24)) == find_blocked(crate(15)) == find_blocked(crate(20, 1.0)) == []


def test_every_condition_of_every_block_has_the_factor_of_the_task() -> None:
    task = crate(20, 1.25)
    used = [
        literal.predicate
        for block in task.domain.blocks
        for literal in (*block.entry, *block.exit, *block.invariants)
        if literal.predicate.safety is not None
    ]
    assert used
    assert {predicate.safety.factor for predicate in used if predicate.safety} == {1.25}
    assert set(used) <= set(task.domain.predicates)


def test_a_limit_during_the_second_search_is_a_limit(planner: PlannerProcess) -> None:
    """If the second search has no answer, nothing is known about plans with the physical bounds."""
    assert plan_safely(crate(20), planner, Deadline.after(1e-9)).status == "limit"
