"""Disagreements between the properties of a token and its shape."""

from collections.abc import Iterator

from hybrid_tamp.geometry.agreement import Disagreement, MomentsOfInertia, ShapeFeature
from hybrid_tamp.geometry.compounds import find_compound_fault
from hybrid_tamp.geometry.shapes import Compound
from hybrid_tamp.model.authored import authored
from hybrid_tamp.model.token import Token

_INERTIA = "inertia"
"""Name of the property that simulators use as the moments of inertia, whichever class declares it."""


def find_shape_fault(token: Token) -> Disagreement | None:
    """Return the first fault of a token's shape, e.g. parts that lie apart, or None.

    A fixed body never moves, so its parts may lie apart, and its centre of mass does not matter.
    """
    if not isinstance(token.shape, Compound) or token.fixed_body:
        return None
    return find_compound_fault(token.shape, even=_INERTIA not in token.properties and not token.basic_actions)


def find_disagreements(token: Token) -> Iterator[tuple[str, Disagreement]]:
    """Yield a pair of (property, disagreement) for each property of a token that disagrees with the token's shape."""
    if token.shape is None:
        return
    for (name, feature), owner in _features(token).items():
        if name not in token.properties:
            continue
        with authored(f"{owner}.of_shape", {"token": token}):
            fault = feature.find_fault(token[name], token.shape, token.properties)
        if fault is not None:
            yield name, fault


def _features(token: Token) -> dict[tuple[str, ShapeFeature], str]:
    """Map each pair of (property, feature) to the name of a class that declares it, without duplicates."""
    found: dict[tuple[str, ShapeFeature], str] = {}
    if not token.basic_actions:
        found[_INERTIA, MomentsOfInertia()] = "token"
    for member in (*token.classes, *token.unknown):
        for name, feature in member.of_shape.items():
            found.setdefault((name, feature), member.name)
    return found
