"""The delete relaxation contains all reachable facts, and only facts that a sequence of operators adds."""

import pytest
from planning_problems import DELIVER, ODD, random_problem, shortest
from scenes import rolling_task

from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.relaxation import may_be_solvable, reachable


@pytest.mark.parametrize("seed", range(3000, 3080))
def test_what_has_a_plan_is_never_ruled_out(seed: int) -> None:
    problem = random_problem(seed)
    if shortest(problem) is not None:
        assert may_be_solvable(problem)


def test_it_proves_some_to_have_no_plan_and_only_those() -> None:
    problems = [random_problem(seed) for seed in range(3000, 3080)]
    ruled_out = [problem for problem in problems if not may_be_solvable(problem)]
    assert len(ruled_out) > 5
    assert all(shortest(problem) is None for problem in ruled_out)


def test_what_only_exhaustion_shows_is_left_to_the_planner() -> None:
    assert may_be_solvable(ODD)


def test_a_condition_that_nothing_brings_about() -> None:
    assert may_be_solvable(DELIVER)
    facts = reachable(DELIVER)
    assert ("at", "first", "shop") in facts
    assert ("done",) not in facts


def test_a_region_off_the_line_is_ruled_out() -> None:
    assert may_be_solvable(compile_task(rolling_task()).problem)
    assert not may_be_solvable(compile_task(rolling_task(regions=[(0.7, 0.1)])).problem)
