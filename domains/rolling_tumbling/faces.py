"""Faces and postures of a box, the symbols of tumbling, and the relations between them.

Faces are fixed to the body. A box lies flat on a face, or stands on the edge between two faces, tipped past the
balance so that it leans over one of them: "over bottom right" was tipped from its bottom towards its right face and
leans over the right one. Tilted back past the balance it leans over the bottom, as if tipped from its right face:
that pose is "over right bottom", and no pose has two names.
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
"""Face to the face on the other side."""

FACE = SymbolSort("face", tuple(NORMALS), "a face of a box, fixed to it: -x, +x, -y, +y, -z, +z")


def adjacent(one: str, other: str) -> bool:
    """Say whether two faces share an edge."""
    return other not in (one, OPPOSITE[one])


def flat(face: str) -> str:
    """Return the posture of a box that lies on a face."""
    return f"flat {face}"


def over(down: str, forward: str) -> str:
    """Return the posture of a box on the edge between two faces, leaning over the second."""
    return f"over {down} {forward}"


EDGES = tuple((down, forward) for down, forward in product(NORMALS, repeat=2) if adjacent(down, forward))
"""Ordered pairs of adjacent faces."""

POSTURES = SymbolSort(
    # Not "posture": types and predicates share one namespace in PDDL.
    "posture of a box",
    (*map(flat, NORMALS), *(over(down, forward) for down, forward in EDGES)),
    "how a box stands: flat on a face, or over the edge between two faces, leaning over the second",
)


def faces_of(posture: str) -> tuple[str, ...]:
    """Return the faces that a posture names: one if the box lies flat, two if it stands on an edge."""
    return tuple(posture.split()[1:])


def edge_between(before: str, after: str) -> tuple[str, str]:
    """Return the faces beside the edge about which a box turns from one posture to another, one of them tipped."""
    one, other = next(faces_of(posture) for posture in (before, after) if len(faces_of(posture)) == 2)
    return one, other


# The relations, as sets of the arguments for which they hold.

TIPS_HOLD = {(OPPOSITE[f], f, flat(d), over(d, f)) for d, f in EDGES}
"""near, far, before, outcome: pushed from the face opposite to `far`, the box turns over the edge below `far`."""
LOWERS_HOLD = {(d, OPPOSITE[d], before, flat(f)) for d, f in EDGES for before in (over(d, f), over(f, d))}
"""near, far, before, outcome: between the face that was down and its opposite, the box comes down on the other face."""
LEANS_HOLD = {(d, f, over(d, f), over(f, d)) for d, f in EDGES}
"""near, far, before, outcome: the box leans over `far`; tilted back, it leans over `near`."""
HOLDS_HOLD = {(f, over(d, f)) for d, f in EDGES}
"""face, posture: one hand on the face over which the box leans holds it."""
EXPOSED_HOLD = {(f, flat(d)) for d, f in EDGES} | {
    (face, over(d, f)) for d, f in EDGES for one in (d, f) for face in (one, OPPOSITE[one])
}
"""face, posture: a hand can stand at the face to turn the box: beside it, or above and below where it is tipped."""
