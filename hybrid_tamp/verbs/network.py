"""Show the reassignment network of a domain, or of the domain of a task."""

from hybrid_tamp.model.domain import Domain
from hybrid_tamp.taskfile.domains import available_domains, find_domain
from hybrid_tamp.verbs.loading import Settings, load


def find_network(name: str, domain: str | None = None) -> Domain:
    """Return the domain whose network is meant.

    Args:
        name: an installed domain, ``package.module:ATTRIBUTE``, a Python file, or a task.
        domain: the domain of a task, in place of the one that its file names.

    Raises:
        InputError: there is no such domain or task, or it has faults; each with its place.
    """
    if name in available_domains() or name.endswith(".py") or ":" in name:
        return find_domain(name)
    return load(name, Settings(domain=domain)).domain
