"""Checks during a run: contacts that no running block allows."""

from collections.abc import Collection

from hybrid_tamp.execution.logbook import Logbook
from hybrid_tamp.execution.running_instance import RunError, Running
from hybrid_tamp.model.contacts import Contact, ContactRules
from hybrid_tamp.model.task import Task


class Monitors:
    """Checks of the running instances after every control period."""

    def __init__(self, task: Task, running: Collection[Running]) -> None:
        self._task = task
        self._running = tuple(running)
        self._rules = ContactRules(task.domain.block_by_name, [each.instance for each in running])

    def check(self, log: Logbook) -> None:
        """Record the contacts of the last control period and check them.

        Raises:
            RunError: a contact that no running block allows exceeds the limit of the task.
        """
        contact, limit = log.record_contacts(self._running, self._rules), self._task.limits.contact
        if contact is not None and contact.force > limit:
            one, other = contact.tokens
            reason = (
                f"{one} and {other} touched with {contact.force:.1f} N at {contact.time:.3f} s; "
                f"no running block allows more than {limit:g} N between them"
            )
            raise RunError(self._blame(contact), reason, contact=contact)

    def _blame(self, contact: Contact) -> str:
        """Return the first instance in the contact that moves its token, or an empty string."""
        acting = {each.instance.name for each in self._running if each.block.name != self._task.domain.resting}
        return next((name for name in contact.instances if name in acting), "")
