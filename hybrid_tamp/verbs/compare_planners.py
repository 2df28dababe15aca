"""The option ``plan --compare-planners``: plan one task with all installed engines."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from hybrid_tamp.errors import InputError
from hybrid_tamp.model.listings import EngineResult
from hybrid_tamp.model.outcome import PlanOutcome
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.plan import plan_task
from hybrid_tamp.planning.replanning import Progress
from hybrid_tamp.symbolic.engines.installed import list_engines
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.verbs.loading import Settings, load_timed


def compare_planners(
    source: Task | Path | str,
    settings: Settings = Settings(),  # noqa: B008
    progress: Progress | None = None,
) -> list[EngineResult]:
    """Plan a task with each installed engine, and return the results in the order of `list_engines`.

    Args:
        source: a task, the path of a task file, or the name of a bundled task.
        settings: settings that override the task file. The time limit applies to each engine.
        progress: called with the completed fraction of the work and the name of the current engine.

    Raises:
        InputError: the task file has faults.
    """
    tell = progress or (lambda share, what: None)
    names = [engine.name for engine in list_engines() if engine.version is not None]
    with PlannerProcess() as process:
        return list(_results(source, process, settings, names, tell))


def _results(
    source: Task | Path | str, planner: PlannerProcess, settings: Settings, names: list[str], tell: Progress
) -> Iterator[EngineResult]:
    for number, name in enumerate(names):
        tell(number / len(names), name)
        task, deadline = load_timed(source, replace(settings, planner=name, began=None))
        try:
            yield _summarise(name, plan_task(task, planner, deadline))
        except InputError as error:
            yield EngineResult(name, None, None, None, None, str(error.issues[0]))


def _summarise(name: str, outcome: PlanOutcome) -> EngineResult:
    messages = {"solved": outcome.planner.fewest or "", "unsolvable": ""}
    known = messages.get(outcome.status, outcome.failure.message if outcome.failure else "")
    actions = None if outcome.plan is None else len(outcome.plan.actions)
    return EngineResult(name, outcome.status, actions, outcome.makespan, outcome.planner.seconds, known)
