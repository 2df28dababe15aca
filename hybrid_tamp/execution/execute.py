"""Closed-loop execution of a plan, or of several plans with the same beginning."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from hybrid_tamp.execution.events import Observer
from hybrid_tamp.execution.loop import Progress, Run
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.recording import AtomMargin, Recording
from hybrid_tamp.model.refined import GOAL
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.protocol import Backend


def execute(
    task: Task,
    plan: TaskPlan,
    backend: Backend,
    progress: Progress | None = None,
    observer: Observer | None = None,
) -> Recording:
    """Run a lawful plan.

    Args:
        task: the task.
        plan: the plan; any hyperparameter that it lacks is set to its initial value when its instance begins.
        backend: moves the tokens; it is reset to the task's initial state.
        progress: called every few steps.
        observer: called with every event as it happens.

    Returns:
        The recording until the end of the plan or the first failure.

    Raises:
        InputError: the backend cannot simulate the task.
        DomainError: a policy commands a token that its block does not hold.
    """
    run = Run(task, plan, backend, observer)
    run.advance(progress=progress)
    return run.make_recording()


def execute_variants(
    task: Task, plans: Sequence[TaskPlan], backend: Backend, until: str | None = None
) -> Iterator[Recording]:
    """Run plans that differ in hyperparameters only; the results are the same to the bit as those of `execute`.

    The part before the first instance in which they differ is run once; each plan continues from a snapshot.

    Args:
        task: the task.
        plans: one or more plans.
        backend: moves the tokens.
        until: name of an instance; the runs end when it ends, and the recording omits instances that still run then.

    Yields:
        A recording for each plan, in their order.

    Raises:
        InputError: the backend cannot simulate the task.
        DomainError: a policy commands a token that its block does not hold.
    """
    trunk = Run(task, plans[0], backend)
    trunk.advance(before=_find_changed(plans), until=until)
    with backend.snapshot() as go_back:
        for plan in plans:
            go_back()
            run = trunk.branch(plan)
            run.advance(until=until)
            yield run.make_recording()


def _find_changed(plans: Sequence[TaskPlan]) -> frozenset[str]:
    """Return the names of the instances whose hyperparameters are not the same in all plans."""
    first = plans[0]
    return frozenset(
        one.name
        for plan in plans[1:]
        for one, other in zip(first.instances, plan.instances, strict=True)
        if one.hyperparameters != other.hyperparameters
    )


def add_predictions(measured: Recording, expected: Mapping[tuple[str, Atom], float | None]) -> Recording:
    """Return a recording with the predictions of the forward models beside its measured margins.

    Args:
        measured: the recording.
        expected: maps (instance or `GOAL`, atom) to the predicted margin; other conditions get no prediction.
    """

    def add(where: str, margins: tuple[AtomMargin, ...]) -> tuple[AtomMargin, ...]:
        return tuple(replace(margin, predicted=expected.get((where, margin.atom))) for margin in margins)

    exits = {instance: add(instance, margins) for instance, margins in measured.exits.items()}
    return replace(measured, exits=exits, goal=add(GOAL, measured.goal))
