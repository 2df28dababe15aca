"""The reassignments of a plan that have not happened yet, in the order that the plan determines."""

from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.reassignment import Reassignment, reassignments
from hybrid_tamp.model.task import Task


class PendingEvents:
    """The reassignments that have not happened yet. A reassignment is enabled once all earlier ones have happened."""

    def __init__(self, task: Task, plan: TaskPlan) -> None:
        self._task = task
        self._pending = dict(enumerate(reassignments(task, plan)))
        self._enabled_at = {index: 0.0 for index, event in self._pending.items() if not event.after}
        self._enabled = self._list_enabled()

    def with_plan(self, plan: TaskPlan) -> "PendingEvents":
        """Return a copy with the events of another plan, which differs only in its hyperparameters."""
        other = PendingEvents(self._task, plan)
        other._pending = {index: other._pending[index] for index in self._pending}
        other._enabled_at = dict(self._enabled_at)
        other._enabled = other._list_enabled()
        return other

    @property
    def enabled(self) -> tuple[tuple[int, Reassignment], ...]:
        """Pair of (index, reassignment) for each enabled reassignment, in order."""
        return self._enabled

    def _list_enabled(self) -> tuple[tuple[int, Reassignment], ...]:
        return tuple((index, self._pending[index]) for index in sorted(self._enabled_at))

    def enabled_at(self, index: int) -> float:
        """Return the time at which a reassignment was enabled [s]."""
        return self._enabled_at[index]

    def remove(self, index: int, time: float) -> None:
        """Remove a reassignment that happens at a time [s].

        Later reassignments are enabled from the next step on, so ordered reassignments never happen at the same time.
        """
        del self._pending[index], self._enabled_at[index]
        for other, later in self._pending.items():
            if other not in self._enabled_at and not later.after & self._pending.keys():
                self._enabled_at[other] = time
        self._enabled = self._list_enabled()
