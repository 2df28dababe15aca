"""Checks during a run: contacts that no running block allows, and invariants of the running blocks.

The margins of the invariants are computed for several control periods at once, which takes little longer than for one.
A fault is therefore found up to `CHUNK` periods late. The run then ends with the period that has the fault, and the
later periods are not recorded.
"""

from collections.abc import Collection
from math import isnan

import numpy as np

from hybrid_tamp.execution.logbook import Logbook, Period
from hybrid_tamp.execution.running_instance import RunError, Running
from hybrid_tamp.model.contacts import Contact, ContactRules
from hybrid_tamp.model.predicate import Binding, Literal
from hybrid_tamp.model.recording import AtomMargin
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task

TOLERANCE = 0.5
"""Largest shortfall of an invariant in a run, as a share of the scale of its predicate. Servos are not exact."""
CHUNK = 24
"""Largest number of control periods that are checked together."""

_Invariant = tuple[Running, Literal, Binding]


def _least(literal: Literal) -> float:
    return -TOLERANCE * literal.predicate.scale


class Monitors:
    """Checks of the running instances in each control period."""

    def __init__(self, task: Task, running: Collection[Running]) -> None:
        self._task = task
        self._periods: list[Period] = []
        # The instances of tokens change only at a reassignment, and each reassignment makes new monitors.
        self._within = {token: each.instance.name for each in running for token in each.instance.slots.values()}
        self._acting = {each.instance.name for each in running if each.block.name != task.domain.resting}
        self._invariants: list[_Invariant] = [
            (each, literal, task.bind(each.instance.roles)) for each in running for literal in each.block.invariants
        ]
        instances = [each.instance for each in running]
        self._rules = ContactRules(task.domain.block_by_name, instances, task.fixed_bodies, task.token_by_name)

    def add(self, period: Period) -> None:
        """Add a control period, which `settle` checks later."""
        self._periods.append(period)

    @property
    def full(self) -> bool:
        """Whether `CHUNK` control periods wait for their check."""
        return len(self._periods) >= CHUNK

    def settle(self, log: Logbook) -> None:
        """Check and record the control periods since the last call, up to the first period that has a fault.

        Raises:
            RunError: a contact that no running block allows exceeds the limit of the task, or an invariant is violated.
        """
        periods, self._periods = self._periods, []
        if not periods:
            return
        run = State(periods[0].state.layout, np.array([period.state.values for period in periods]))
        margins = [np.broadcast_to(each.margin(run, binding), len(periods)) for _, each, binding in self._invariants]
        bad = [~(each >= _least(literal)) for each, (_, literal, _) in zip(margins, self._invariants, strict=True)]
        faulty = np.logical_or.reduce(bad, axis=0) if bad else np.zeros(len(periods), dtype=bool)
        for step, period in enumerate(periods):
            self._check_contact(log.record_step(period, self._within, self._rules))
            if faulty[step]:
                first = next(index for index, each in enumerate(bad) if each[step])
                raise self._broken(self._invariants[first], float(margins[first][step]), log.time)

    def _broken(self, invariant: _Invariant, margin: float, time: float) -> RunError:
        """Return the failure of an instance whose invariant has a margin that is too small at a time [s]."""
        running, literal, binding = invariant
        atom = literal.ground(binding)
        denial = literal.predicate.sentence(atom.arguments, not literal.positive)
        reason = f"{denial} at {time:.3f} s (off by {-margin:.4g} {literal.predicate.unit})"
        return RunError(running.instance.name, reason, [AtomMargin(atom, None if isnan(margin) else margin)])

    def _check_contact(self, contact: Contact | None) -> None:
        limit = self._task.limits.contact
        if contact is not None and contact.force > limit:
            reason = (
                f"{contact.pair} touched with {contact.force:.1f} N at {contact.time:.3f} s; "
                f"no running block allows more than {limit:g} N between them"
            )
            raise RunError(self._blame(contact), reason, contact=contact)

    def _blame(self, contact: Contact) -> str:
        """Return the first instance in the contact that moves its token, or an empty string."""
        return next((name for name in contact.instances if name in self._acting), "")
