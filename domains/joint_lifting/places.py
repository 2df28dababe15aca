"""The places at which hands bear a box.

Hands squeeze a box along its own x axis, at its left face (-x) and its right face (+x). At each face there is either
one hand in the middle, or one hand in the front half (-y) and one hand in the back half (+y). Each hand is upright, so
it touches its face along a vertical line for every yaw of the box. The lower end of a hand is above the centre of the
box, so the box hangs stably. A hand that can turn is lower if the box is low, because its wrist bears only a limited
moment. Vectors are in the world frame unless a name says otherwise. Batch dimensions come first.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np

from hybrid_tamp.authoring import Binding, FloatArray, State, SymbolSort, Token, rotate
from hybrid_tamp.skills import NORMALS, STANDBY_GAP, UP, Alignment, can_turn, get_token, point

SPOTS: dict[str, tuple[str, float]] = {
    "left": ("left", 0.0),
    "right": ("right", 0.0),
    "left front": ("left", -0.5),
    "left back": ("left", 0.5),
    "right front": ("right", -0.5),
    "right back": ("right", 0.5),
}
"""Maps each place to a pair of (face, position along y as a fraction of the half extent)."""
PLACE = SymbolSort("place", tuple(SPOTS), "place of a hand: side -x or +x of a box, in the middle or towards -y or +y")

CREWS: dict[str, tuple[str, ...]] = {
    "two hands": ("left", "right"),
    "four hands": ("left front", "left back", "right front", "right back"),
}
"""Maps each crew to the places of its hands."""
CREW = SymbolSort("crew", tuple(CREWS), "number of hands that lift a box together")
SLOTS = ("first", "second", "third", "fourth")
"""Slots of the hands, in the same order as the places in `CREWS`."""

VERTICAL = Alignment(lambda state, hand, *values: UP, float(np.radians(3.0)))
"""How a hand lies at its place: upright."""
_ABOVE_CENTRE = 0.01
"""Height of the lower end of a hand above the centre of a box [m]."""
_BELOW_TOP = 0.03
"""Smallest depth of the centre of a hand that can turn below the top of a box, if the floor allows it [m]."""
_ABOVE_GROUND = 0.01
"""Smallest height of the lower end of a hand above the ground of a box [m]."""
FLOOR_TOLERANCE = 0.01
"""Largest distance of a bottom corner from the floor at which a box counts as standing on the floor [m]."""


@dataclass(frozen=True)
class Roles:
    """The hands and the box of a block instance.

    Attributes:
        crew: symbol for the number of hands.
        hands: pairs of (hand, place).
        thing: the box.
    """

    crew: str
    hands: tuple[tuple[Token, str], ...]
    thing: Token

    @classmethod
    def of(cls, crew: str, binding: Binding) -> "Roles":
        """Return the roles in a binding."""
        hands = tuple((get_token(binding, slot), place) for slot, place in places_of(crew))
        return cls(crew, hands, get_token(binding, "object"))

    @property
    def contacts(self) -> tuple[tuple[Token, str], ...]:
        """Pairs of (hand, face)."""
        return tuple((hand, SPOTS[place][0]) for hand, place in self.hands)


def places_of(crew: str) -> tuple[tuple[str, str], ...]:
    """Return a pair of (slot, place) for each hand of a crew."""
    return tuple(zip(SLOTS, CREWS[crew], strict=False))


def crew_at(place: str) -> str:
    """Return the symbol for the number of hands of the crew in which a hand is at a place."""
    return next(crew for crew, places in CREWS.items() if place in places)


def height_of_hand(hand: Token, thing: Token) -> float:
    """Return the height [m] of the centre of a hand at its place above the centre of a box."""
    half_length, half_height = float(hand["length"]) / 2.0, float(thing["half_extents"][2])
    usual = _ABOVE_CENTRE + half_length
    if not can_turn(hand):
        return usual
    return max(min(usual, half_height - _BELOW_TOP), half_length + _ABOVE_GROUND - half_height)


def contact_length(hand: Token, thing: Token) -> float:
    """Return the length [m] of the line along which a hand at its place touches its face. It may be negative."""
    half_length, half_height = float(hand["length"]) / 2.0, float(thing["half_extents"][2])
    centre = height_of_hand(hand, thing)
    return min(half_height, centre + half_length) - max(-half_height, centre - half_length)


def place_at(state: State, hand: Token, thing: Token, place: str, gap: float = STANDBY_GAP) -> FloatArray:
    """Return the position ``(..., 3)`` [m] of a hand's centre for a place at a box and a gap [m] to the box's face."""
    face, along = SPOTS[place]
    half_x, half_y, _ = thing["half_extents"]
    aside = NORMALS[face][0] * (half_x + hand["radius"] + gap)
    return point(state, thing, np.array([aside, along * half_y, height_of_hand(hand, thing)]))


def corner_heights(state: State, thing: Token) -> FloatArray:
    """Return the heights ``(..., 4)`` [m] of the four corners of a box's bottom face above the ground of the box."""
    halves, orientation = np.asarray(thing["half_extents"]), state[thing, "orientation"]
    corners = (np.array([x, y, -1.0]) * halves for x, y in product((-1.0, 1.0), repeat=2))
    middle = state[thing, "position"][..., 2] - thing.ground.height
    return np.stack([middle + rotate(orientation, each)[..., 2] for each in corners], axis=-1)


def height(state: State, thing: Token) -> FloatArray:
    """Return the height ``(...)`` [m] of the lowest point of a box above its ground."""
    return np.asarray(corner_heights(state, thing).min(axis=-1))
