"""The verb ``explain``: explain why each token is in the plan. If there is no plan, explain why and find remedies."""

from dataclasses import replace
from functools import partial
from pathlib import Path

from hybrid_tamp.model.deadline import Deadline
from hybrid_tamp.model.expectation import Expectations
from hybrid_tamp.model.explanation import TaskExplanation
from hybrid_tamp.model.outcome import PlanOutcome
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.plan import plan_task
from hybrid_tamp.planning.replanning import Progress, avoid_collisions, plan_and_refine
from hybrid_tamp.planning.safety import blame_factors
from hybrid_tamp.questions.explain.causal_links import find_causes
from hybrid_tamp.questions.explain.no_plan import explain_outcome
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.verbs.loading import Settings, load_timed
from hybrid_tamp.verbs.plan import TRIALS as PLAN_TRIALS

TRIALS = 20
"""Default maximum number of changed tasks to try in the search for single changes."""
MOST = 5
"""Default maximum number of single changes that the search finds."""


def explain(
    source: Task | Path | str,
    settings: Settings = Settings(),  # noqa: B008
    *,
    trials: int = TRIALS,
    most: int = MOST,
    optimise: bool = False,
    progress: Progress | None = None,
) -> TaskExplanation:
    """Explain why each token is in the plan of a task, or explain why the task has no plan.

    The explanation contains everything that `plan` reports.

    Args:
        source: a task, the path of a task file, or the name of a bundled task.
        settings: settings that override the task file.
        trials: maximum number of changed tasks to try, in the search for single changes that make the task solvable.
        most: maximum number of single changes to find.
        optimise: whether to optimise the hyperparameters of the plan, and to replan without the bindings that fail.
        progress: called with the completed fraction of the work and the name of the current activity.

    Raises:
        InputError: the task file is wrong, or the planner is unknown or not installed.
        NotFinite: every rollout of a plan failed.
    """
    # Start the planner process first, so that its start-up overlaps with the reading of the task file.
    with PlannerProcess() as process:
        task, deadline = load_timed(source, settings, plans=True)
        planning = partial(plan_task, planner=process, deadline=deadline, expectations=Expectations())
        if optimise:
            planned = plan_and_refine(task, planning, progress, deadline=deadline)
        else:
            planned = avoid_collisions(planning(task), planning, deadline)
        outcome = blame_factors(planned, process, deadline)
    excluded = tuple(each.text for each in outcome.excluded)
    if outcome.plan is not None:
        causes = tuple(find_causes(outcome.chosen or task, outcome.plan))
        return TaskExplanation(task, outcome.status, None, causes, excluded)
    outcome = _explain_widely(outcome, trials, most, deadline)
    return TaskExplanation(task, outcome.status, outcome.explanation, excluded=excluded)


def _explain_widely(outcome: PlanOutcome, trials: int, most: int, deadline: Deadline) -> PlanOutcome:
    """Return the outcome with the explanation of `plan`, extended by the explanation of a wider search."""
    planned = explain_outcome(outcome, min(trials, PLAN_TRIALS), 1, deadline)
    wider = explain_outcome(outcome, trials, most, deadline)
    if planned.explanation is None or wider.explanation is None:
        return wider
    return replace(wider, explanation=wider.explanation.extended(planned.explanation))
