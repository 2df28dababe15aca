"""Bodies that several families of random tasks share."""

from collections.abc import Iterable

from hybrid_tamp.geometry.shapes import BoxPart, Compound
from hybrid_tamp.model.token import Token
from hybrid_tamp.skills import StaticEndEffector

Triple = tuple[float, float, float]


def small_hand(radius: float, length: float) -> Token:
    """Return a hand of 1 kg and 100 N with a large workspace."""
    properties = {
        "radius": radius,
        "length": length,
        "mass": 1.0,
        "maximal_force": 100.0,
        "workspace_lower": (-2.0, -2.0, 0.0),
        "workspace_upper": (2.0, 2.0, 2.0),
    }
    return Token.make("hand", [StaticEndEffector], properties)


def compound_of(boxes: Iterable[tuple[Triple, Triple]]) -> Compound:
    """Return a compound of boxes, given as pairs of (half extents, position) [m]."""
    parts = tuple(BoxPart(kind="box", half_extents=halves, position=place) for halves, place in boxes)
    return Compound(kind="compound", parts=parts)
