"""Closed-loop control of one run.

The plan determines only the order of reassignments. A reassignment happens at the first control step at which three
conditions are true: the minimum durations of all ending instances are over, their exit conditions hold, and the entry
conditions of all starting instances hold. Until then the running instances continue.

A reassignment is due once the preceding events have happened and the maximum durations of the instances that must
finish first are over. The run fails if the reassignment has not happened `PATIENCE` seconds later, so every run ends.
"""

from collections.abc import Callable, Collection, Iterable
from copy import copy

from hybrid_tamp.errors import DomainError
from hybrid_tamp.execution.ending import record_end, record_failure
from hybrid_tamp.execution.events import Event, Observer
from hybrid_tamp.execution.logbook import Logbook, Period
from hybrid_tamp.execution.monitors import Monitors
from hybrid_tamp.execution.pending import PendingEvents
from hybrid_tamp.execution.running_instance import (
    RunError,
    Running,
    blame_state,
    blame_waiting,
    command_instances,
    measure_conditions,
)
from hybrid_tamp.model.commands import CommandLayout
from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.plan import TIME_TOLERANCE, BlockInstance, TaskPlan
from hybrid_tamp.model.precedence import must_wait
from hybrid_tamp.model.reassignment import Reassignment, initial
from hybrid_tamp.model.recording import AtomMargin, Recording
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import are_finite
from hybrid_tamp.physics.protocol import Backend

Progress = Callable[[float, float], None]
"""Callback that receives the simulated time and the expected makespan [s], ten times per simulated second."""

PATIENCE = 5.0
"""Longest delay of a due reassignment before the run fails [s]."""
SETTLING = 0.5
"""Minimum duration of the last instances [s], so that the run measures whether tokens stay at rest."""
_PROGRESS_STEPS = 24


class Run:
    """One execution of a plan."""

    def __init__(
        self, task: Task, plan: TaskPlan, backend: Backend, observer: Observer | None = None, deadline: Deadline = NEVER
    ) -> None:
        self._task, self._plan, self._backend, self._deadline = task, plan, backend, deadline
        self._observer: Observer = observer or (lambda event: None)
        self._layout = CommandLayout.of(task)
        self._log = Logbook(task, self._layout, backend)
        self._pending = PendingEvents(task, plan)
        self._running: dict[str, Running] = {}
        self._steps, self._time, self._state = 0, 0.0, task.state
        self._monitors = Monitors(task, ())
        self._ended = False
        self._error: RunError | None = None

    def advance(
        self, *, before: Collection[str] = (), until: str | None = None, progress: Progress | None = None
    ) -> None:
        """Run until the end of the plan or a failure.

        Args:
            before: names of instances. The run stops at the first control step at which one of them might begin.
            until: name of an instance. The run stops when this instance has ended.
            progress: callback for the simulated time.

        Raises:
            LimitReached: the deadline passes.
        """
        try:
            try:
                self._go_on(before, until, progress)
            except (RunError, DomainError):
                self._settle()  # An earlier fault takes precedence.
                raise
            self._settle()
        except RunError as error:
            self._error = error

    def _go_on(self, before: Collection[str], until: str | None, progress: Progress | None) -> None:
        if not self._log.started:
            self._start()
        while not (self._over or self._might_begin(before)):
            self._carry_out_events()
            if self._over or (until is not None and self._log.has_ended(until)):
                return
            self._deadline.check()
            self._step()
            if progress is not None and self._steps % _PROGRESS_STEPS == 0:
                progress(self._time, self._plan.makespan)

    def _settle(self) -> None:
        """Check the last control periods and record them. If one has a fault, go back to it and raise it."""
        try:
            self._monitors.settle(self._log)
        except RunError:
            self._time, self._state = self._log.time, self._log.last_state
            for running in self._running.values():
                running.forget_after(self._time)
            raise

    def branch(self, plan: TaskPlan) -> "Run":
        """Return a copy of the run that continues with another plan. The caller must restore the backend's state.

        The plans may differ only in the hyperparameters of instances that have not begun.
        """
        other = copy(self)
        other._plan = plan
        other._pending = self._pending.with_plan(plan)
        other._running = {name: copy(running) for name, running in self._running.items()}
        other._log = self._log.copy()
        other._monitors = Monitors(self._task, other._running.values())
        return other

    def make_recording(self) -> Recording:
        """Return the recording so far. The goal is measured only if the run has ended or failed."""
        known = (self._task, self._state, self._log, self._observer)
        if self._error is not None:
            return record_failure(*known, self._plan, self._error, self._end_all)
        return record_end(*known) if self._ended else self._log.make_recording((), None)

    @property
    def _over(self) -> bool:
        return self._ended or self._error is not None

    def _start(self) -> None:
        self._state = self._backend.reset(self._task, self._task.state)
        self._log.start(self._state)
        self._begin(initial(self._plan))

    def _might_begin(self, names: Collection[str]) -> bool:
        """Return whether one of the named instances might begin now, because all instances that it replaces can end."""
        return bool(names) and any(
            any(instance.name in names for instance in event.starting) and self._are_ready(event.ending)
            for _, event in self._pending.enabled
        )

    def _are_ready(self, names: Iterable[str]) -> bool:
        return all(self._running[name].is_ready(self._time, self._state) for name in names)

    def _carry_out_events(self) -> None:
        """Carry out every event that can happen at this step."""
        for running in self._running.values():
            if running.reached is None:  # `is_ready` records when the exit conditions first hold
                running.is_ready(self._time, self._state)
        for index, event in self._pending.enabled:
            if self._can_happen(event):
                self._carry_out(index, event)
            else:
                self._check_wait(index, event)
        if not self._ended:
            for running in self._running.values():
                running.check_overdue(self._time, self._state)

    def _can_happen(self, event: Reassignment) -> bool:
        if event.final and self._time - self._log.last_event < SETTLING - TIME_TOLERANCE:
            return False
        if not self._are_ready(event.ending):
            return False
        return len(self._awaited(event)) == len(event.ending) and all(
            margin.holds for instance in event.starting for margin in self._entries(instance)
        )

    def _carry_out(self, index: int, event: Reassignment) -> None:
        self._settle()
        names = tuple(instance.name for instance in event.starting)
        if not event.final:
            self._observer(Event(self._time, "reassignment", ending=event.ending, starting=names))
        for name in event.ending:
            self._end(self._running.pop(name))
        self._begin(event.starting)
        self._ended = event.final
        self._log.last_event = self._time
        self._pending.remove(index, self._time)

    def _check_wait(self, index: int, event: Reassignment) -> None:
        """Check that an event is not overdue.

        Raises:
            RunError: the reassignment has been due for more than `PATIENCE`.
        """
        if self._time <= self._pending.enabled_at(index) + PATIENCE:
            return
        due = (
            max(self._pending.enabled_at(index), *(self._running[name].latest for name in self._awaited(event)))
            + PATIENCE
        )
        if self._time <= due:
            return
        missing = [(name, m) for name in event.ending for m in self._running[name].measure_exits(self._state)]
        missing += [(instance.name, m) for instance in event.starting for m in self._entries(instance)]
        raise blame_waiting([(name, m) for name, m in missing if not m.holds], due - PATIENCE, event.ending[0])

    def _awaited(self, event: Reassignment) -> list[str]:
        """Return the ending instances, and all instances whose exit a starting instance must await."""
        others = [
            name
            for name, running in self._running.items()
            if name not in event.ending
            and running.reached is None
            and any(must_wait(self._task, self._plan, running.instance, instance) for instance in event.starting)
        ]
        return [*event.ending, *others]

    def _begin(self, instances: tuple[BlockInstance, ...]) -> None:
        for instance in instances:
            running = self._running[instance.name] = Running(self._task, instance, self._time, self._state)
            margins = tuple(self._entries(instance))
            chosen = running.hyperparameters
            self._observer(Event(self._time, "begin", instance, hyperparameters=chosen, margins=margins))
        self._backend.assign([running.instance for running in self._running.values()])
        self._monitors = Monitors(self._task, self._running.values())

    def _end(self, running: Running) -> None:
        margins, values = tuple(running.measure_exits(self._state)), running.hyperparameters
        self._log.record_end(running, self._time, margins)
        self._observer(Event(self._time, "end", running.instance, hyperparameters=values, margins=margins))

    def _end_all(self) -> None:
        for running in list(self._running.values()):
            self._end(running)

    def _entries(self, instance: BlockInstance) -> list[AtomMargin]:
        entries = self._task.domain.block_by_name[instance.block].measured_entries
        return measure_conditions(self._task, entries, instance, self._state)

    def _step(self) -> None:
        """Apply the policies' commands for one control period and record the measured state.

        Raises:
            RunError: a command or the measured state is not finite.
        """
        commanded = command_instances(self._layout, self._running.values(), self._time, self._state)
        row, cut = self._layout.limited(commanded)
        after = self._backend.step(self._layout.commands(row))
        if not are_finite(after.values):
            raise blame_state(after, self._running.values(), self._time)
        self._steps += 1
        self._state, self._time = after, self._steps * self._backend.timestep
        self._monitors.add(Period(after, row, cut, self._backend.contact_forces()))
        if self._monitors.full:
            self._settle()
