"""Checks during a run: contacts that no running block allows, and invariants of the running blocks."""

from collections.abc import Collection
from math import isnan

from hybrid_tamp.execution.logbook import Logbook
from hybrid_tamp.execution.running_instance import RunError, Running
from hybrid_tamp.model.contacts import Contact, ContactRules
from hybrid_tamp.model.recording import AtomMargin
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task

TOLERANCE = 0.5
"""Largest shortfall of an invariant in a run, as a share of the scale of its predicate. Servos are not exact."""


class Monitors:
    """Checks of the running instances after every control period."""

    def __init__(self, task: Task, running: Collection[Running]) -> None:
        self._task = task
        # The instances of tokens change only at a reassignment, and each reassignment makes new monitors.
        self._within = {token: each.instance.name for each in running for token in each.instance.slots.values()}
        self._acting = {each.instance.name for each in running if each.block.name != task.domain.resting}
        self._invariants = [
            (each, literal, task.bind(each.instance.roles)) for each in running for literal in each.block.invariants
        ]
        self._rules = ContactRules(task.domain.block_by_name, [each.instance for each in running])

    def check(self, log: Logbook, state: State) -> None:
        """Record the contacts of the last control period, and check the contacts and the invariants.

        Args:
            log: log of the run.
            state: state at the end of the control period, shape ``(n,)``.

        Raises:
            RunError: a contact that no running block allows exceeds the limit of the task, or an invariant is violated.
        """
        self._check_contact(log.record_contacts(self._within, self._rules))
        for running, literal, binding in self._invariants:
            margin = float(literal.margin(state, binding))
            if not margin >= -TOLERANCE * literal.predicate.scale:
                atom = literal.ground(binding)
                denial = literal.predicate.sentence(atom.arguments, not literal.positive)
                reason = f"{denial} at {log.time:.3f} s (off by {-margin:.4g} {literal.predicate.unit})"
                raise RunError(running.instance.name, reason, [AtomMargin(atom, None if isnan(margin) else margin)])

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
