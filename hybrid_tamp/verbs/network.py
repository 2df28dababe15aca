"""The verb ``network``: find the domain whose reassignment network is shown."""

from hybrid_tamp.model.domain import Domain
from hybrid_tamp.taskfile.domains import available_domains, find_domain
from hybrid_tamp.verbs.loading import Settings, load


def find_network(name: str, domain: str | None = None) -> Domain:
    """Return a domain, or the domain of a task.

    Args:
        name: an installed domain, ``package.module:ATTRIBUTE``, a Python file, or a task.
        domain: replaces the domain of a task.

    Raises:
        InputError: there is no such domain or task, or it has faults.
    """
    if name in available_domains() or name.endswith(".py") or ":" in name:
        return find_domain(name)
    return load(name, Settings(domain=domain)).domain
