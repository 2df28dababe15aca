"""Read the safety factors in a task file, and apply them to the domain."""

from typing import Any

from hybrid_tamp.model.domain import Domain
from hybrid_tamp.taskfile.places import Faults, KeyPath, shown


def read_safety(data: dict[str, Any], faults: Faults, domain: Domain | None) -> Domain | None:
    """Return the domain with the safety factors of the task file, and record faults."""
    given = data.get("safety")
    if domain is None or not isinstance(given, dict):
        return domain
    known = domain.safety
    for key in given:
        path: KeyPath = ("safety", key)
        if key not in known:
            wanted = f"must be a predicate of the domain {domain.name} with a safety factor"
            remedy = "" if known else f"no predicate of {domain.name} has a safety factor"
            faults.at(path, wanted, shown(key), list(known), remedy, key=True)
    if not faults.sound(("safety",)):
        return domain
    return domain.with_safety({key: float(factor) for key, factor in given.items()})
