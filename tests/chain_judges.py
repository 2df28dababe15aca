"""Helpers for tests of chains: solve, decode, schedule, check, and re-encode."""

from pathlib import Path

from exhaustive import shortest_plan
from validation import val_accepts

from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import PlannedAction, TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.decode import decode
from hybrid_tamp.symbolic.encoding.problem import Compilation, compile_task
from hybrid_tamp.symbolic.reencode import reencode
from hybrid_tamp.symbolic.schedule import schedule


def chains(of: Task) -> list[str]:
    """Return the chains of a task as text."""
    return [blocks for _, blocks in compile_task(of).encoded.chains.comments]


def timeline(plan: TaskPlan, token: str) -> list[str]:
    return [instance.block for instance, _ in plan.timeline(token)]


def lawful(folder: Path, compilation: Compilation, actions: list[PlannedAction]) -> TaskPlan:
    """Return the plan with the given actions. VAL and the law checker must accept this plan, also after re-encoding."""
    assert val_accepts(folder, compilation.problem, actions)
    plan = schedule(compilation.task, decode(compilation, actions))
    assert check_law(compilation.task, plan) == []
    assert val_accepts(folder, compilation.problem, reencode(compilation, plan))
    return plan


def solved(folder: Path, of: Task) -> TaskPlan:
    compilation = compile_task(of)
    actions = shortest_plan(compilation.problem)
    assert actions is not None
    return lawful(folder, compilation, actions)
