"""Five engines solve the exported files, read back as anyone would read them; VAL judges each plan."""

from pathlib import Path

import pytest
from scenes import rolling_task
from validation import val_accepts

from hybrid_tamp import pipeline
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.task import Limits
from hybrid_tamp.symbolic.planner import PlannerProcess
from hybrid_tamp.symbolic.problem import compile_task

ENGINES = ["fast-downward", "symk", "enhsp", "pyperplan", "aries"]


@pytest.mark.parametrize("engine", ENGINES)
def test_engine_solves_the_task(engine: str, tmp_path: Path) -> None:
    task = rolling_task(hands=2, drums=[(0, 0), (0, 0.5)], regions=[(0.7, 0), (0.7, 0.5)], goal=[(0, 0)])
    task = task.replaced(planner=engine, limits=Limits(time=60.0))
    outcome = pipeline.plan(task)
    plan = outcome.required()
    assert outcome.document.planner.name == engine
    assert check_law(task, plan) == []
    actions = [tuple(line.strip("()").split()) for line in plan.actions]
    assert val_accepts(tmp_path, compile_task(task).problem, actions)


@pytest.mark.parametrize("engine", ["fast-downward", "symk", "enhsp", "pyperplan"])
def test_engine_proves_that_there_is_no_plan(engine: str) -> None:
    task = rolling_task(regions=[(0.7, 0.3)]).replaced(planner=engine, limits=Limits(time=60.0))
    outcome = pipeline.plan(task)
    assert outcome.document.status == "unsolvable"
    assert outcome.error is not None
    assert outcome.error.exit_status == 10


def test_optimal_engines_need_no_more_actions_than_the_default() -> None:
    task = rolling_task(hands=2)
    with PlannerProcess() as planner:
        fast = pipeline.plan(task, planner)
    best = pipeline.plan(task.replaced(planner="fast-downward-opt"))
    assert best.document.cost == 5
    assert fast.document.cost is not None
    assert fast.document.cost >= best.document.cost
