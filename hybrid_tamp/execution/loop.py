"""Closed-loop execution of a plan, or of several plans that begin alike."""

from collections.abc import Iterator, Sequence

from hybrid_tamp.execution.events import Observer
from hybrid_tamp.execution.run import Progress, Run
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.recording import Recording
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
        plan: what to run; hyperparameters that its instances do not give get their initial values when they begin.
        backend: who moves the tokens; it is reset to the task's initial state.
        progress: called now and then.
        observer: called with every event as it happens.

    Returns:
        What was measured and commanded until the plan's end or the first failure.

    Raises:
        InputError: the backend cannot simulate the task.
        DomainError: a policy commands something that its block does not hold.
    """
    run = Run(task, plan, backend, observer)
    run.advance(progress=progress)
    return run.recording()


def execute_variants(
    task: Task, plans: Sequence[TaskPlan], backend: Backend, until: str | None = None
) -> Iterator[Recording]:
    """Run plans that differ in hyperparameters only, with the same results to the bit as `execute`.

    The part before the first instance in which they differ is run once; each plan continues from a snapshot.

    Args:
        task: the task.
        plans: one or more plans.
        backend: who moves the tokens.
        until: name of an instance; the runs end when it ends, and the recording omits instances that still run then.

    Yields:
        A recording for each plan, in their order.

    Raises:
        InputError: the backend cannot simulate the task.
        DomainError: a policy commands something that its block does not hold.
    """
    trunk = Run(task, plans[0], backend)
    trunk.advance(before=_different(plans), until=until)
    with backend.snapshot() as go_back:
        for plan in plans:
            go_back()
            run = trunk.branch(plan)
            run.advance(until=until)
            yield run.recording()


def _different(plans: Sequence[TaskPlan]) -> frozenset[str]:
    """Return the names of the instances whose hyperparameters are not the same in all plans."""
    first = plans[0]
    return frozenset(
        one.name
        for plan in plans[1:]
        for one, other in zip(first.instances, plan.instances, strict=True)
        if one.hyperparameters != other.hyperparameters
    )
