"""The verb ``explain``: explain why each token is in the plan. If there is no plan, explain why and find remedies."""

from pathlib import Path

from hybrid_tamp.model.explanation import TaskExplanation
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.plan import plan_task
from hybrid_tamp.planning.safety import blame_factors
from hybrid_tamp.questions.explain.causal_links import find_causes
from hybrid_tamp.questions.explain.no_plan import explain_outcome
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.verbs.loading import Settings, load_timed

TRIALS = 20
"""Default number of changed tasks to plan in the search for single changes."""
MOST = 5
"""Default maximum number of single changes that the search finds."""


def explain(
    source: Task | Path | str,
    settings: Settings = Settings(),  # noqa: B008
    *,
    trials: int = TRIALS,
    most: int = MOST,
) -> TaskExplanation:
    """Explain why each token is in the plan of a task, or explain why the task has no plan.

    Args:
        source: a task, the path of a task file, or the name of a bundled task.
        settings: settings that replace those of the task file.
        trials: largest number of changed tasks to plan, to find single changes that make the task solvable.
        most: maximum number of single changes to find.

    Raises:
        InputError: the task file is wrong, or the planner is unknown or not installed.
    """
    # Start the planner process first, so that its start-up overlaps with the reading of the task file.
    with PlannerProcess() as process:
        task, deadline = load_timed(source, settings, plans=True)
        outcome = blame_factors(plan_task(task, process, deadline), process, deadline)
    if outcome.plan is not None:
        return TaskExplanation(task, outcome.status, None, tuple(find_causes(outcome.chosen or task, outcome.plan)))
    outcome = explain_outcome(outcome, trials, most, deadline)
    return TaskExplanation(task, outcome.status, outcome.explanation)
