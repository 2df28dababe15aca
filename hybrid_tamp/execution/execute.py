"""Closed-loop execution of one plan, or of several plans that differ only in their hyperparameters."""

import logging
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from hybrid_tamp.execution.events import Observer
from hybrid_tamp.execution.loop import Progress, Run
from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.recording import AtomMargin, Recording
from hybrid_tamp.model.refined import GOAL
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.protocol import Backend

_LOG = logging.getLogger(__name__)


def execute(
    task: Task,
    plan: TaskPlan,
    backend: Backend,
    progress: Progress | None = None,
    observer: Observer | None = None,
    deadline: Deadline = NEVER,
) -> Recording:
    """Run a plan and return its recording.

    Args:
        task: task that the plan solves.
        plan: plan that obeys the law of assignment. Missing hyperparameters take their initial values.
        backend: physics backend, which is reset to the task's initial state.
        progress: callback for the simulated time, called ten times per simulated second.
        observer: callback for the events of the run.
        deadline: deadline of the command.

    Returns:
        The recording up to the end of the plan or the first failure.

    Raises:
        LimitReached: the deadline passes.
        InputError: the backend cannot simulate the task.
        DomainError: a policy reads a token outside its roles, or its commands are faulty (see `check_commands`).
    """
    run = Run(task, plan, backend, observer, deadline)
    run.advance(progress=progress)
    recording = run.make_recording()
    _LOG.info("ran %.2f s of simulated time", recording.duration)
    return recording


def execute_variants(
    task: Task, plans: Sequence[TaskPlan], backend: Backend, until: str | None = None, deadline: Deadline = NEVER
) -> Iterator[Recording]:
    """Run plans that differ only in their hyperparameters. Each recording equals the result of `execute` bit for bit.

    All plans share the run until the first instance with different hyperparameters may begin. Then each plan continues
    from a snapshot.

    Args:
        task: task that the plans solve.
        plans: plans that differ only in their hyperparameters, at least one.
        backend: physics backend, which is reset to the task's initial state.
        until: name of an instance. Every run stops when this instance ends. Instances that are still running are not
            recorded.
        deadline: deadline of the command.

    Yields:
        The recording of each plan, in the order of `plans`.

    Raises:
        LimitReached: the deadline passes.
        InputError: the backend cannot simulate the task.
        DomainError: a policy reads a token outside its roles, or its commands are faulty (see `check_commands`).
    """
    trunk = Run(task, plans[0], backend, deadline=deadline)
    trunk.advance(before=_find_changed(plans), until=until)
    with backend.snapshot() as go_back:
        for plan in plans:
            go_back()
            run = trunk.branch(plan)
            run.advance(until=until)
            yield run.make_recording()


def _find_changed(plans: Sequence[TaskPlan]) -> frozenset[str]:
    """Return the names of the instances whose hyperparameters differ between the plans."""
    first = plans[0]
    return frozenset(
        one.name
        for plan in plans[1:]
        for one, other in zip(first.instances, plan.instances, strict=True)
        if one.hyperparameters != other.hyperparameters
    )


def add_predictions(measured: Recording, expected: Mapping[tuple[str, Atom], float | None]) -> Recording:
    """Return a copy of a recording that also contains the predicted margins.

    Args:
        measured: recording of a run.
        expected: maps each pair of (instance name or `GOAL`, atom) to the margin that the forward models predict.
    """

    def add(where: str, margins: tuple[AtomMargin, ...]) -> tuple[AtomMargin, ...]:
        return tuple(replace(margin, predicted=expected.get((where, margin.atom))) for margin in margins)

    exits = {instance: add(instance, margins) for instance, margins in measured.exits.items()}
    return replace(measured, exits=exits, goal=add(GOAL, measured.goal))
