"""Symbols of tumbling: the faces and postures of a box, and the relations between them.

Faces are fixed to the body. A box either lies flat on a face or leans over a face: it stands on an edge and is tipped
past its point of balance. A box in posture "over bottom right" was tipped from its bottom face towards its right face
and leans over its right face. If the box is tilted back past its point of balance, it leans over its bottom face. That
posture is "over right bottom". No pose has two names.
"""

from itertools import product

import numpy as np

from hybrid_tamp.authoring import FloatArray, SymbolSort

NORMALS: dict[str, FloatArray] = {
    "left": np.array([-1.0, 0.0, 0.0]),
    "right": np.array([1.0, 0.0, 0.0]),
    "front": np.array([0.0, -1.0, 0.0]),
    "back": np.array([0.0, 1.0, 0.0]),
    "bottom": np.array([0.0, 0.0, -1.0]),
    "top": np.array([0.0, 0.0, 1.0]),
}
"""Outward normal of each face in the body frame."""

_OPPOSITE = {"left": "right", "front": "back", "bottom": "top"}
OPPOSITE = _OPPOSITE | {other: one for one, other in _OPPOSITE.items()}
"""Maps each face to the opposite face."""

FACE = SymbolSort("face", tuple(NORMALS), "a face of a box; its normal in the body frame is -x, +x, -y, +y, -z or +z")


def adjacent(one: str, other: str) -> bool:
    """Say whether two faces share an edge."""
    return other not in (one, OPPOSITE[one])


def flat(face: str) -> str:
    """Return the posture of a box that lies flat on a face."""
    return f"flat {face}"


def over(down: str, forward: str) -> str:
    """Return the posture of a box that stands on the edge between two faces and leans over the second face."""
    return f"over {down} {forward}"


EDGES = tuple((down, forward) for down, forward in product(NORMALS, repeat=2) if adjacent(down, forward))
"""Ordered pairs of adjacent faces."""

POSTURES = SymbolSort(
    # The name is not "posture" because types and predicates share one namespace in PDDL.
    "posture of a box",
    (*map(flat, NORMALS), *(over(down, forward) for down, forward in EDGES)),
    "posture of a box: flat on a face, or on the edge between two faces and leaning over the second face",
)


def faces_of(posture: str) -> tuple[str, ...]:
    """Return the faces that a posture names: one face if the box lies flat, or two faces if it stands on an edge."""
    return tuple(posture.split()[1:])


def edge_between(before: str, after: str) -> tuple[str, str]:
    """Return the two faces beside the edge about which a box turns between a tipped posture and another posture."""
    one, other = next(faces_of(posture) for posture in (before, after) if len(faces_of(posture)) == 2)
    return one, other


# Each relation is the set of the argument tuples for which it holds.

TIPS_HOLD = {(OPPOSITE[f], f, flat(d), over(d, f)) for d, f in EDGES}
"""Tuples of (near, far, before, outcome). Hands at two opposite faces tip a flat box over the edge below `far`."""
LOWERS_HOLD = {(d, OPPOSITE[d], before, flat(f)) for d, f in EDGES for before in (over(d, f), over(f, d))}
"""Tuples of (near, far, before, outcome). Hands at `near`, a face beside the edge, and at the opposite face lower a
tipped box onto the other face beside the edge."""
LEANS_HOLD = {(d, f, over(d, f), over(f, d)) for d, f in EDGES}
"""Tuples of (near, far, before, outcome). Hands at both faces beside the edge tilt a box that leans over `far` back
until the box leans over `near`."""
HOLDS_HOLD = {(f, over(d, f)) for d, f in EDGES}
"""Pairs of (face, posture). A single hand at the face over which the box leans can hold the box."""
EXPOSED_HOLD = {(f, flat(d)) for d, f in EDGES} | {
    (face, over(d, f)) for d, f in EDGES for one in (d, f) for face in (one, OPPOSITE[one])
}
"""Pairs of (face, posture). A hand that turns the box can be placed at the face. A flat box exposes its sides. A tipped
box exposes the two faces beside its edge and the faces opposite to them."""
