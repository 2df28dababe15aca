"""The verb ``domains``: list the installed domains."""

from hybrid_tamp.model.domain import Domain
from hybrid_tamp.taskfile.domains import available_domains, find_domain


def list_domains() -> list[Domain]:
    """Return the installed domains, sorted by name.

    Raises:
        InputError: a domain cannot be loaded.
    """
    return [find_domain(name) for name in available_domains()]
