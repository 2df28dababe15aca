"""The end of a run: its last event and its recording."""

import logging
from collections.abc import Callable

from hybrid_tamp.execution.events import Event, Observer
from hybrid_tamp.execution.logbook import Logbook
from hybrid_tamp.execution.running_instance import RunError, describe_shortfall, measure_goal
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.recording import Failure, Recording
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task

_logger = logging.getLogger(__name__)


def record_end(task: Task, state: State, log: Logbook, observer: Observer) -> Recording:
    """Return the recording of a run that ended in a state of shape ``(n,)``."""
    goal = measure_goal(task, state)
    observer(Event(log.time, "goal", margins=goal))
    for margin in (each for each in goal if not each.holds):
        _logger.warning("the run did not reach the goal: %s", describe_shortfall(margin))
    return log.make_recording(goal, None)


def record_failure(
    task: Task,
    state: State,
    log: Logbook,
    observer: Observer,
    plan: TaskPlan,
    error: RunError,
    end_all: Callable[[], None],
) -> Recording:
    """Return the recording of a run that failed in a state of shape ``(n,)``. `end_all` ends all running instances."""
    step = log.step_index
    end_all()
    failure = Failure(step, error.instance, error.reason, error.margins, error.contact)
    failed = next((i for i in plan.instances if i.name == error.instance), None)
    observer(Event(log.time, "failure", failed, margins=error.margins, reason=error.reason))
    _logger.warning("step %d failed: %s", step, error.reason)
    return log.make_recording(measure_goal(task, state), failure)
