"""The verb ``network``: find the domain of a reassignment network."""

from hybrid_tamp.model.domain import Domain
from hybrid_tamp.taskfile.domains import available_domains, find_domain
from hybrid_tamp.verbs.loading import Settings, load


def find_network(name: str, domain: str | None = None) -> Domain:
    """Return the domain with the given name, or the domain of the task with the given name.

    Args:
        name: an installed domain, ``package.module:ATTRIBUTE``, a Python file, or a task.
        domain: domain that replaces the domain of the task.

    Raises:
        InputError: no domain or task has this name, or the domain or task has faults.
    """
    if name in available_domains() or name.endswith(".py") or ":" in name:
        return find_domain(name)
    return load(name, Settings(domain=domain)).domain
