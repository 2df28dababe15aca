"""Operators that are removed as impossible are really impossible, so no plan is lost."""

from pathlib import Path

import pytest
from scenes import reach_and_roll, rolling_task

from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.engines.plain import without_impossible
from hybrid_tamp.symbolic.engines.unified import unify
from hybrid_tamp.taskfile.loader import load_task

PROBLEMS = Path(__file__).resolve().parents[2] / "problems"


def test_without_a_box_there_is_no_tumbling() -> None:
    problem = compile_task(rolling_task()).problem
    smaller = without_impossible(problem)
    names = {operator.name for operator in smaller.domain.operators}
    assert "begin-rolling-from-resting" in names
    assert not any("tipping" in name or "beside" in name for name in names)
    assert not any("flat" in constant for constant, _ in smaller.domain.constants)
    assert {name for name, _ in smaller.domain.predicates} >= {fact[0] for fact in (*smaller.init, *smaller.goal)}


def test_a_plan_of_the_one_is_a_plan_of_the_other() -> None:
    problem = compile_task(rolling_task()).problem
    plan = reach_and_roll("hand-0", "drum-0", "region-0")
    assert unify(without_impossible(problem)).fault(plan) == unify(problem).fault(plan) == ""
    assert unify(without_impossible(problem)).fault(plan[:-1])


@pytest.mark.parametrize("name", ["roll_cylinder", "tumble_two_hands", "tumble_two_boxes_four_hands"])
def test_every_kept_fact_has_its_predicate_and_its_objects(name: str) -> None:
    smaller = without_impossible(compile_task(load_task(PROBLEMS / f"{name}.yaml")).problem)
    predicates = {name for name, _ in smaller.domain.predicates}
    objects = {name for name, _ in (*smaller.objects, *smaller.domain.constants)}
    for fact in (*smaller.init, *smaller.goal):
        assert fact[0] in predicates
        assert set(fact[1:]) <= objects
