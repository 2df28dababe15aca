"""The places at which hands bear a box.

Hands squeeze a box along its own x axis, at its left face (-x) and its right face (+x). At each face there is either
one hand in the middle, or one hand in the front half (-y) and one hand in the back half (+y). Each hand is upright, so
it touches its face along a vertical line for every yaw of the box. The lower end of each hand is above the centre of
the box, so the box hangs stably. Vectors are in the world frame unless a name says otherwise. Batch dimensions come
first.
"""

from itertools import product

import numpy as np

from hybrid_tamp.authoring import FloatArray, State, SymbolSort, Token, rotate
from hybrid_tamp.skills import to_body

SPOTS: dict[str, tuple[float, float]] = {
    "left": (-1.0, 0.0),
    "right": (1.0, 0.0),
    "left front": (-1.0, -0.5),
    "left back": (-1.0, 0.5),
    "right front": (1.0, -0.5),
    "right back": (1.0, 0.5),
}
"""Maps each place to a pair of (sign of its side along x, position along y as a fraction of the half extent)."""
PLACE = SymbolSort("place", tuple(SPOTS), "place of a hand: side -x or +x of a box, in the middle or towards -y or +y")

CREWS: dict[str, tuple[str, ...]] = {
    "two hands": ("left", "right"),
    "four hands": ("left front", "left back", "right front", "right back"),
}
"""Maps each crew to the places of its hands."""
CREW = SymbolSort("crew", tuple(CREWS), "number of hands that lift a box together")

ABOVE_CENTRE = 0.01
"""Height of the lower end of a hand above the centre of a box [m]."""
STANDBY_GAP = 0.012
"""Gap between a face and a hand in its standby position [m]."""
FLOOR_TOLERANCE = 0.01
"""Largest distance of a bottom corner from the floor at which a box counts as standing on the floor [m]."""


def offset_in_box(state: State, hand: Token, thing: Token) -> FloatArray:
    """Return the position ``(..., 3)`` [m] of a hand's centre in the body frame of a box."""
    return to_body(state, thing, state[hand, "position"] - state[thing, "position"])


def outward(state: State, thing: Token, place: str) -> FloatArray:
    """Return the outward normal ``(..., 3)`` of a box's face at a place."""
    return rotate(state[thing, "orientation"], np.array([SPOTS[place][0], 0.0, 0.0]))


def place_at(state: State, hand: Token, thing: Token, place: str, gap: float = STANDBY_GAP) -> FloatArray:
    """Return the position ``(..., 3)`` [m] of a hand's centre for a place at a box and a gap [m] to the box's face."""
    side, along = SPOTS[place]
    half_x, half_y, _ = thing["half_extents"]
    in_body = np.array([side * (half_x + hand["radius"] + gap), along * half_y, ABOVE_CENTRE + hand["length"] / 2.0])
    return np.asarray(state[thing, "position"] + rotate(state[thing, "orientation"], in_body))


def gap_at(state: State, hand: Token, thing: Token, place: str) -> FloatArray:
    """Return the distance ``(...)`` [m] between a hand's surface and the plane of the face at a place."""
    across = SPOTS[place][0] * offset_in_box(state, hand, thing)[..., 0]
    return np.asarray(across - thing["half_extents"][0] - hand["radius"])


def corner_heights(state: State, thing: Token) -> FloatArray:
    """Return the heights ``(..., 4)`` [m] of the four corners of a box's bottom face."""
    halves, orientation = np.asarray(thing["half_extents"]), state[thing, "orientation"]
    corners = (np.array([x, y, -1.0]) * halves for x, y in product((-1.0, 1.0), repeat=2))
    return np.stack([state[thing, "position"][..., 2] + rotate(orientation, each)[..., 2] for each in corners], axis=-1)
