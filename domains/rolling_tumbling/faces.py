"""Symbols of tumbling: the faces and postures of a box, and the relations between them.

Faces are fixed to the body. A box either lies flat on a face, or stands on an edge and leans over one of the two faces
beside the edge. A box leans over a face if the box is tilted towards this face past its point of balance. In posture
"over bottom right", the box stands on the edge between its bottom and right faces and leans over its right face. In
posture "over right bottom", the box stands on the same edge and leans over its bottom face.
"""

from itertools import product

from hybrid_tamp.authoring import SymbolSort
from hybrid_tamp.skills import NORMALS, OPPOSITE

FACE = SymbolSort("face", tuple(NORMALS), "face of a box, whose body-frame normal is -x, +x, -y, +y, -z or +z")


def adjacent(one: str, other: str) -> bool:
    """Say whether two faces share an edge."""
    return other not in (one, OPPOSITE[one])


def flat(face: str) -> str:
    """Return the posture of a box that lies flat on a face."""
    return f"flat {face}"


def over(down: str, forward: str) -> str:
    """Return the posture of a box that stands on the edge between two faces and leans over the face `forward`."""
    return f"over {down} {forward}"


EDGES = tuple((down, forward) for down, forward in product(NORMALS, repeat=2) if adjacent(down, forward))
"""Ordered pairs of adjacent faces."""

POSTURES = SymbolSort(
    # A predicate is named "posture", and in PDDL a type cannot have the name of a predicate.
    "posture of a box",
    (*map(flat, NORMALS), *(over(down, forward) for down, forward in EDGES)),
    "posture of a box: flat on a face, or standing on an edge between two faces and leaning over the second of them",
)


def faces_of(posture: str) -> tuple[str, ...]:
    """Return the faces that a posture names: one face for a flat box, or two faces for a box on an edge."""
    return tuple(posture.split()[1:])


def edge_between(before: str, after: str) -> tuple[str, str]:
    """Return the two faces beside the edge about which a box turns. At least one of the postures must be tipped."""
    one, other = next(faces_of(posture) for posture in (before, after) if len(faces_of(posture)) == 2)
    return one, other


# Each relation is the set of the argument tuples for which it holds.

TIPS_HOLD = {(OPPOSITE[f], f, flat(d), over(d, f)) for d, f in EDGES}
"""Tuples of (near, far, before, outcome). Hands at opposite faces tip a flat box over the lower edge of `far`."""
LOWERS_HOLD = {(d, OPPOSITE[d], before, flat(f)) for d, f in EDGES for before in (over(d, f), over(f, d))}
"""Tuples of (near, far, before, outcome). A box stands on an edge of `near`. Hands at `near` and at the opposite face
lower the box onto the other face beside this edge."""
LEANS_HOLD = {(d, f, over(d, f), over(f, d)) for d, f in EDGES}
"""Tuples of (near, far, before, outcome). A box stands on the edge between `near` and `far` and leans over `far`.
Hands at both faces tilt the box back until it leans over `near`."""
HOLDS_HOLD = {(f, over(d, f)) for d, f in EDGES}
"""Pairs of (face, posture). A single hand at the face over which the box leans can hold the box."""
EXPOSED_HOLD = {(f, flat(d)) for d, f in EDGES} | {
    (face, over(d, f)) for d, f in EDGES for one in (d, f) for face in (one, OPPOSITE[one])
}
"""Pairs of (face, posture). A hand that turns the box can be placed at the face. A flat box exposes its four sides. A
tipped box exposes both faces beside its edge and their opposite faces."""
