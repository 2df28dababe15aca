"""The verb ``pddl``: a task goes in, PDDL files that any planner reads come out."""

from pathlib import Path
from typing import Literal

from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.plan import plan_task
from hybrid_tamp.report.folder import RunFolder
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.symbolic.pddl.temporal_text import temporal_domain_text, temporal_plan_text, temporal_problem_text
from hybrid_tamp.symbolic.pddl.text import domain_text, plan_text, problem_text
from hybrid_tamp.symbolic.reencode import plan_actions
from hybrid_tamp.symbolic.temporal.compilation import compile_durative
from hybrid_tamp.symbolic.temporal.reencoding import reencode_durative
from hybrid_tamp.verbs.loading import Settings, load

Encoding = Literal["classical", "temporal"]
"""Slot by slot without time, or one durative action for each block."""


def pddl(
    source: Task | Path | str,
    folder: RunFolder | Path | str,
    settings: Settings = Settings(),  # noqa: B008
    *,
    encoding: Encoding = "classical",
    solve: bool = False,
    force: bool = False,
) -> list[Path]:
    """Write a task as PDDL.

    Args:
        source: a task, the path of a task file, or the name of a bundled task.
        folder: where the files go.
        settings: what replaces what the file says.
        encoding: how blocks become planning actions.
        solve: whether to plan the task and to write the plan, too.
        force: whether the files may replace another run's.

    Returns:
        The files that were written.

    Raises:
        InputError: the task file is wrong, the folder cannot be used, or the goal leaves a choice that no plan makes.
        NoPlan: there is no plan to write, or none was found.
        LimitReached: the planner reached a limit.
    """
    task = load(source, settings)
    target = RunFolder.open(folder, force=force)
    plan = None
    if solve:
        with PlannerProcess() as process:
            plan = plan_task(task, process).required()
    return export(task, target, plan, encoding)


def export(task: Task, folder: RunFolder, plan: TaskPlan | None = None, encoding: Encoding = "classical") -> list[Path]:
    """Write the PDDL of a task, and of its plan where given.

    Args:
        task: the task.
        folder: where the files go.
        plan: a plan of it, whatever encoding it was found in.
        encoding: how blocks become planning actions.

    Raises:
        InputError: the goal leaves a choice, and there is no plan that would make it.
    """
    if plan is not None and len(task.alternatives()) > 1:
        task = next(each for each in task.alternatives() if not check_law(each, plan))
    domain, problem, lines = _classical(task, plan) if encoding == "classical" else _temporal(task, plan)
    files = [folder.write_text("domain.pddl", domain), folder.write_text("problem.pddl", problem)]
    return files if plan is None else [*files, folder.write_text("plan.pddl", lines)]


def _classical(task: Task, plan: TaskPlan | None) -> tuple[str, str, str]:
    compilation = compile_task(task)
    actions = () if plan is None else plan_actions(compilation, plan)
    return domain_text(compilation.problem.domain), problem_text(compilation.problem), plan_text(actions)


def _temporal(task: Task, plan: TaskPlan | None) -> tuple[str, str, str]:
    compilation = compile_durative(task)
    problem, actions = (compilation.problem, ()) if plan is None else reencode_durative(compilation, plan)
    return temporal_domain_text(problem.domain), temporal_problem_text(problem), temporal_plan_text(actions)
