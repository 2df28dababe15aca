"""Which movements of a plan are over before others begin, in every timing that the reassignments allow."""

from functools import cached_property

from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.reassignment import Reassignment, reassignments
from hybrid_tamp.model.task import Task


class Precedence:
    """The partial order of the movements of a plan."""

    def __init__(self, task: Task, plan: TaskPlan) -> None:
        self._task, self._plan = task, plan
        self._events: tuple[Reassignment, ...] = reassignments(task, plan)
        self._start = {each.name: index for index, event in enumerate(self._events) for each in event.starting}
        self._end = {name: index for index, event in enumerate(self._events) for name in event.ending}

    @cached_property
    def _before(self) -> list[frozenset[int]]:
        """The reassignments that happen before each reassignment."""
        found: list[frozenset[int]] = []
        for event in self._events:
            found.append(event.after.union(*(found[index] for index in event.after)))
        return found

    def is_over_before(self, one: BlockInstance, other: BlockInstance) -> bool:
        """Return whether `one` always ends, or reaches its exit, before `other` begins."""
        begin = self._start.get(other.name)
        if begin is None:
            return False
        earlier = self._before[begin] | {begin}
        return self._end[one.name] in earlier or any(self._waits_for(index, one) for index in earlier)

    def may_overlap(self, one: BlockInstance, other: BlockInstance) -> bool:
        """Return whether the movements of two instances may happen at the same time."""
        return not (self.is_over_before(one, other) or self.is_over_before(other, one))

    def start_together(self, one: BlockInstance, other: BlockInstance) -> bool:
        """Return whether two instances always start at the same instant."""
        return self._start.get(one.name) == self._start.get(other.name)

    def _waits_for(self, index: int, one: BlockInstance) -> bool:
        """Return whether a reassignment waits until a running instance has reached its exit."""
        begun = self._start.get(one.name)
        return (begun is None or begun in self._before[index]) and any(
            must_wait(self._task, self._plan, one, reader) for reader in self._events[index].starting
        )


def must_wait(task: Task, plan: TaskPlan, running: BlockInstance, starting: BlockInstance) -> bool:
    """Return whether an instance cannot start before a running instance reaches its exit.

    The running instance writes a property that the starting instance reads from its targets (law 5), or the plan orders
    the two instances.
    """
    written = task.domain.block_by_name[running.block].writes
    return (running.name, starting.name) in plan.order or any(
        starting.targets[target.name] == token and set(target.reads) & set(written.get(slot, ()))
        for target in task.domain.block_by_name[starting.block].targets
        for slot, token in running.slots.items()
    )
