"""The verb ``explain``: why a task has the plan that it has, or why it has none and what would give it one."""

from pathlib import Path

from hybrid_tamp.model.explanation import TaskExplanation
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.plan import plan_task
from hybrid_tamp.questions.explain.causal_links import causes
from hybrid_tamp.questions.explain.explanation import explain_failure
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.verbs.loading import Settings, load

SECONDS = 20.0
"""How long single changes are searched for [s]."""
MOST = 5
"""How many single changes are enough."""


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
        settings: what replaces what the file says.
        seconds: how long single changes are searched for [s].
        most: how many changes are enough.

    Raises:
        InputError: the task file is wrong, or the engine is unknown or not installed.
    """
    # The planner's process starts up while the task file is read.
    with PlannerProcess() as process:
        task = load(source, settings, plans=True)
        outcome = plan_task(task, process)
    if outcome.plan is not None:
        return TaskExplanation(task, outcome.status, None, tuple(causes(outcome.chosen or task, outcome.plan)))
    return TaskExplanation(task, outcome.status, explain_failure(outcome, seconds, most))
