"""The verb ``pddl``: write a task as PDDL files for other planners."""

from pathlib import Path
from typing import Literal

from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.plan import plan_task
from hybrid_tamp.planning.safety import blame_factors
from hybrid_tamp.report.folder import RunFolder
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.encoding.task_words import settle_goal
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.symbolic.pddl.temporal_text import temporal_domain_text, temporal_plan_text, temporal_problem_text
from hybrid_tamp.symbolic.pddl.text import domain_text, plan_text, problem_text
from hybrid_tamp.symbolic.reencode import plan_actions
from hybrid_tamp.symbolic.temporal.compilation import compile_durative
from hybrid_tamp.symbolic.temporal.reencoding import reencode_durative
from hybrid_tamp.symbolic.whereabouts.export import encoded_task
from hybrid_tamp.verbs.loading import Settings, load_timed

Encoding = Literal["classical", "temporal"]
"""How blocks become planning actions: one action per slot (classical) or one durative action per block (temporal)."""


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
        folder: folder for the files.
        settings: settings that override the task file.
        encoding: how blocks become planning actions.
        solve: whether to plan the task and write the plan as well.
        force: whether to replace the files of another run.

    Returns:
        The written files.

    Raises:
        InputError: the task file is wrong, the folder cannot be used, or the goal has wildcards but `solve` is false.
        NoPlan: there is no plan, or no plan was found.
        LimitReached: a time or memory limit was reached.
    """
    task, deadline = load_timed(source, settings)
    target = RunFolder.open(folder, force=force)
    plan = None
    if solve:
        with PlannerProcess() as process:
            plan = blame_factors(plan_task(task, process, deadline), process, deadline).required()
    return export(task, target, plan, encoding)


def export(task: Task, folder: RunFolder, plan: TaskPlan | None = None, encoding: Encoding = "classical") -> list[Path]:
    """Write the PDDL of a task, and of a plan if a plan is given.

    Args:
        task: the task.
        folder: folder for the files.
        plan: a plan of the task. The plan may come from either encoding.
        encoding: how blocks become planning actions.

    Raises:
        InputError: the goal has wildcards, but no plan is given to bind the wildcards.
    """
    if plan is not None and len(task.alternatives()) > 1:
        task = next(each for each in task.alternatives() if not check_law(each, plan))
    task, plan = encoded_task(settle_goal(task), plan)
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
