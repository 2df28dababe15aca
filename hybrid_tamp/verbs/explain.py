"""The verb ``explain``: why each token is in the plan of a task, or why there is no plan and what would give one."""

from pathlib import Path

from hybrid_tamp.model.explanation import TaskExplanation
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.plan import plan_task
from hybrid_tamp.questions.explain.causal_links import find_causes
from hybrid_tamp.questions.explain.no_plan import explain_failure
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.verbs.loading import Settings, load

SECONDS = 20.0
"""Default time to search for single changes [s]."""
MOST = 5
"""Default number of single changes after which the search stops."""


def explain(
    source: Task | Path | str,
    settings: Settings = Settings(),  # noqa: B008
    *,
    seconds: float = SECONDS,
    most: int = MOST,
) -> TaskExplanation:
    """Explain why each token is in the plan of a task, or why the task has no plan.

    Args:
        source: a task, the path of a task file, or the name of a bundled task.
        settings: settings that replace those of the task file.
        seconds: time to search for single changes that would give a plan [s].
        most: number of changes after which the search stops.

    Raises:
        InputError: the task file is wrong, or the planner is unknown or not installed.
    """
    # The planner's process starts while the task file is read.
    with PlannerProcess() as process:
        task = load(source, settings, plans=True)
        outcome = plan_task(task, process)
    if outcome.plan is not None:
        return TaskExplanation(task, outcome.status, None, tuple(find_causes(outcome.chosen or task, outcome.plan)))
    return TaskExplanation(task, outcome.status, explain_failure(outcome, seconds, most))
