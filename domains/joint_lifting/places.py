"""Where hands bear a box: world frame unless a name says otherwise, batch first.

A box is squeezed along its own x axis: hands are at its left face (-x) and at its right one (+x), one in the middle of
each, or two side by side on each, in the front half (-y) and in the back half (+y). A hand stands upright, its lower
end above the box's centre. So it touches the face along a line, however the box is turned about the vertical, and the
box hangs from its hands, wherever on those lines the forces are.
"""

from itertools import product

import numpy as np

from hybrid_tamp.authoring import FloatArray, State, SymbolSort, Token, quaternion_conjugate, rotate

SPOTS: dict[str, tuple[float, float]] = {
    "left": (-1.0, 0.0),
    "right": (1.0, 0.0),
    "left front": (-1.0, -0.5),
    "left back": (-1.0, 0.5),
    "right front": (1.0, -0.5),
    "right back": (1.0, 0.5),
}
"""Place to the side of the box along x, and to where it is along y as a share of the half extent."""
PLACE = SymbolSort("place", tuple(SPOTS), "where a hand bears a box: at -x or +x, in the middle or at -y or +y")

CREWS: dict[str, tuple[str, ...]] = {
    "two hands": ("left", "right"),
    "four hands": ("left front", "left back", "right front", "right back"),
}
"""How many hands lift together, and the places where they do."""
CREW = SymbolSort("crew", tuple(CREWS), "how many hands lift a box together")

ABOVE_CENTRE = 0.01
"""How far above the centre of a box the lower end of a hand is [m]."""
STANDBY_GAP = 0.012
"""Gap between hand and face where a hand stands by [m]."""
FLOOR_TOLERANCE = 0.01
"""How far from the floor the corners of a box may be that stands on it [m]."""
UP = np.array([0.0, 0.0, 1.0])


def dot(one: FloatArray, other: FloatArray) -> FloatArray:
    """Return the inner product over the last axis, ``(...)``."""
    return np.asarray(np.sum(one * other, axis=-1))


def in_box(state: State, thing: Token, vectors: FloatArray) -> FloatArray:
    """Return vectors in the box's frame ``(..., 3)``."""
    return rotate(quaternion_conjugate(state[thing, "orientation"]), vectors)


def offset_in_box(state: State, hand: Token, thing: Token) -> FloatArray:
    """Return where the centre of a hand is in the box's frame, ``(..., 3)`` [m]."""
    return in_box(state, thing, state[hand, "position"] - state[thing, "position"])


def outward(state: State, thing: Token, place: str) -> FloatArray:
    """Return the outward normal ``(..., 3)`` of the face at a place."""
    return rotate(state[thing, "orientation"], np.array([SPOTS[place][0], 0.0, 0.0]))


def place_at(state: State, hand: Token, thing: Token, place: str, gap: float = STANDBY_GAP) -> FloatArray:
    """Return where the centre of a hand is ``(..., 3)`` [m] that stands at a place."""
    side, along = SPOTS[place]
    half_x, half_y, _ = thing["half_extents"]
    in_body = np.array([side * (half_x + hand["radius"] + gap), along * half_y, ABOVE_CENTRE + hand["length"] / 2.0])
    return np.asarray(state[thing, "position"] + rotate(state[thing, "orientation"], in_body))


def gap_at(state: State, hand: Token, thing: Token, place: str) -> FloatArray:
    """Return the distance ``(...)`` [m] between a hand's surface and the plane of the face at a place."""
    across = SPOTS[place][0] * offset_in_box(state, hand, thing)[..., 0]
    return np.asarray(across - thing["half_extents"][0] - hand["radius"])


def corner_heights(state: State, thing: Token) -> FloatArray:
    """Return the heights of the four corners of the bottom face, ``(..., 4)`` [m]."""
    signs = (np.array([x, y, -1.0]) for x, y in product((-1.0, 1.0), repeat=2))
    halves = np.asarray(thing["half_extents"])
    return np.stack([_height(state, thing, sign * halves) for sign in signs], axis=-1)


def _height(state: State, thing: Token, point: FloatArray) -> FloatArray:
    return np.asarray(state[thing, "position"][..., 2] + rotate(state[thing, "orientation"], point)[..., 2])
