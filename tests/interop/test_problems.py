"""Tasks become problems of unified_planning, whose plans become plans of the tasks in the users' names."""

from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from texts import load_task_text
from unified_planning.engines.plan_validator import SequentialPlanValidator
from unified_planning.model import InstantaneousAction, Object, Problem
from unified_planning.plans import ActionInstance, PartialOrderPlan, SequentialPlan, TimeTriggeredPlan
from unified_planning.shortcuts import OneshotPlanner, get_environment

import hybrid_tamp
from hybrid_tamp import InputError, Task, TaskPlan, from_unified_planning, to_unified_planning

PROBLEMS = Path(__file__).resolve().parents[2] / "problems"
ENGINES: dict[str, dict[str, Any]] = {
    "fast-downward": {"fast_downward_translate_options": ["--invariant-generation-max-candidates", "200"]},
    "pyperplan": {},
}
"""Engines with their parameters. Without the option, Fast Downward looks for invariants for about 20 s."""


def solve(problem: Problem, engine: str) -> Any:
    with OneshotPlanner(name=engine, params=ENGINES[engine]) as planner:
        return planner.solve(problem).plan


@cache
def rolling() -> tuple[Task, Problem, Any, TaskPlan]:
    """Return a task, its problem, a plan of the problem, and the same plan as a plan of the task."""
    task = hybrid_tamp.load_task("roll_cylinder")
    problem = to_unified_planning(task)
    found = solve(problem, "pyperplan")
    return task, problem, found, from_unified_planning(task, found)


def odd_names() -> Task:
    """Return a task whose tokens have names that unified_planning and PDDL would change."""
    text = (PROBLEMS / "roll_cylinder.yaml").read_text(encoding="utf-8")
    for old, new in {"hand": "Ball-1", "drum": "2go-now?", "goal": "first place"}.items():
        text = text.replace(f"  {old}:\n    classes", f'  "{new}":\n    classes').replace(f"[{old}]", f'["{new}"]')
    return load_task_text(text.replace("[drum, goal]", '["2go-now?", "first place"]'), "odd")


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("name", ["roll_cylinder", "lift_two_hands"])
def test_a_plan_of_an_engine_comes_back(name: str, engine: str) -> None:
    task = hybrid_tamp.load_task(name)
    problem = to_unified_planning(task)
    found = solve(problem, engine)
    assert SequentialPlanValidator().validate(problem, found)
    plan = from_unified_planning(task, found)
    assert hybrid_tamp.check_law(task, plan) == []
    assert {token for each in plan.instances for token in each.slots.values()} == {t.name for t in task.assigned}


@pytest.mark.parametrize("engine", ENGINES)
def test_plans_have_the_users_names(engine: str) -> None:
    task = odd_names()
    plan = from_unified_planning(task, solve(to_unified_planning(task), engine))
    (roll,) = (each for each in plan.instances if each.block == "ROLLING")
    assert roll.roles == {"hand": "Ball-1", "object": "2go-now?", "region": "first place"}


def test_the_problem_belongs_to_the_global_environment() -> None:
    _, problem, _, _ = rolling()
    assert problem.environment is get_environment()
    assert get_environment().error_used_name is False


def test_the_same_task_gives_the_same_problem() -> None:
    task, problem, found, plan = rolling()
    assert to_unified_planning(task) == problem
    assert from_unified_planning(task, found) == plan


def test_a_partially_ordered_plan_comes_back() -> None:
    task, _, found, plan = rolling()
    chain = {one: [other] for one, other in pairwise(found.actions)}
    assert from_unified_planning(task, PartialOrderPlan(chain)) == plan


def broken(how: str) -> Any:
    """Return a plan of `rolling` that is broken in one way."""
    _, problem, found, _ = rolling()
    first, *others = found.actions
    thing = problem.environment.expression_manager.ObjectExp(Object("nobody", first.actual_parameters[0].object().type))
    return {
        "nothing": None,
        "result": "SOLVED_SATISFICING",
        "short": SequentialPlan(found.actions[:-1]),
        "order": SequentialPlan([*others, first]),
        "action": SequentialPlan([ActionInstance(InstantaneousAction("fly"))]),
        "object": SequentialPlan([ActionInstance(first.action, (thing, *first.actual_parameters[1:])), *others]),
        "times": TimeTriggeredPlan([]),
    }[how]


@pytest.mark.parametrize(
    ("how", "message"),
    [
        ("nothing", "NoneType; pass the attribute `plan` of the engine's result, which is None if the engine"),
        ("result", "str; pass the attribute `plan`"),
        ("short", "Goals .* are not satisfied"),
        ("order", "Preconditions .* of 1-th action instance"),
        ("action", "there is no operator 'fly'"),
        ("object", "there is no object 'nobody'"),
        ("times", "can't be converted"),
    ],
)
def test_what_is_not_a_plan_is_refused(how: str, message: str) -> None:
    task, _, _, _ = rolling()
    with pytest.raises(InputError, match=f"^plan: expected a plan of the task roll_cylinder; got .*{message}"):
        from_unified_planning(task, broken(how))


def test_a_plan_of_another_task_is_refused() -> None:
    _, _, found, _ = rolling()
    with pytest.raises(InputError, match="expected a plan of the task hammer_strike"):
        from_unified_planning(hybrid_tamp.load_task("hammer_strike"), found)


def test_a_goal_with_a_choice_has_one_problem_for_each_choice() -> None:
    task = hybrid_tamp.load_task("roll_to_either_region")
    with pytest.raises(InputError, match="must name a token"):
        to_unified_planning(task)
    chosen = task.alternatives()[1]
    plan = from_unified_planning(chosen, solve(to_unified_planning(chosen), "pyperplan"))
    assert hybrid_tamp.check_law(task, plan) == []
