"""Routes that lead a hand around a box to a face, or away from the box.

A route lies in the plane perpendicular to the axis along which the hand lies at its face. A hand that turns far, or
that moves to the opposite face, makes a wide detour: there it can turn in any direction and pass another hand that
waits at a face. While such a hand moves around the box, it stays beside the plane, so that two hands that move around
the box in opposite directions do not meet.
"""

from itertools import pairwise

import numpy as np

from hybrid_tamp.authoring import FloatArray, State, Token, rotate
from hybrid_tamp.skills import (
    HORIZONTAL,
    NORMALS,
    OPPOSITE,
    STANDBY_GAP,
    can_turn,
    half_extent,
    normal,
    to_body,
    z_axis,
)

from .curves import Route
from .geometry import FLOOR_CLEARANCE
from .tumbling_geometry import above_ground, place_at, sides_around
from .turning_hands import ALIGNMENT, axis_beside, own_axis

_ROOM = 0.055
"""Gap [m] between a box and a passing hand. The gap is wide enough for another hand."""
_TOUCHING = 0.005
_BLOCKED = 100.0
_AWAY = 5.5
"""Final distance, in hand radii, of a departing hand from the space that the turning box may occupy."""
_STRAIGHT = float(np.radians(6.0))
"""Largest turn of a hand close to the box [rad]."""
_SPARE = 0.01
"""Gap [m] between a hand on a wide detour and everything that it passes."""
_FACING_DOWN = -0.95
"""Vertical component of the normal of a face below which no hand fits."""


def off_the_face(start: State, hand: Token, thing: Token) -> FloatArray:
    """Return the outward normal ``(..., 3)`` of the face that the hand touches, or zero if the hand touches no face."""
    rows = [State(start.layout, row) for row in start.values.reshape(-1, start.values.shape[-1])]
    return np.array([_outward(state, hand, thing) for state in rows]).reshape(*start.values.shape[:-1], 3)


def _outward(state: State, hand: Token, thing: Token) -> FloatArray:
    face, distance = _face_beside(state, hand, thing, own_axis(state, hand, thing))
    touching = distance < hand["radius"] + _TOUCHING and _beside_box(state, hand, thing)
    return normal(state, thing, face) if touching else np.zeros(3)


def _beside_box(state: State, hand: Token, thing: Token) -> bool:
    """Return whether a hand is near the box along its own axis. A hand that cannot turn is always near its box."""
    if not can_turn(hand):
        return True
    axis = own_axis(state, hand, thing)
    offset = to_body(state, thing, state[hand, "position"] - state[thing, "position"])
    return bool(abs(float(offset[axis])) < thing["half_extents"][axis] + hand["length"] / 2.0)


def _around(axis: int) -> tuple[str, str, str, str]:
    """Return the four faces that are parallel to a body axis, in their order around the box."""
    one, _, other, _ = sides_around(axis)
    return one, other, OPPOSITE[one], OPPOSITE[other]


def _face_beside(state: State, hand: Token, thing: Token, axis: int) -> tuple[str, float]:
    """Return the face around a body axis that is nearest to the hand, and its distance [m] from the hand's centre."""
    offset = to_body(state, thing, state[hand, "position"] - state[thing, "position"])
    faces = [face for face in _around(axis) if float(normal(state, thing, face)[2]) > _FACING_DOWN]
    distances = {face: float(NORMALS[face] @ offset) - half_extent(thing, face) for face in faces}
    face = max(distances, key=lambda name: distances[name])
    return face, distances[face]


def _off_face(state: State, hand: Token, thing: Token, axis: int, room: float) -> tuple[str, FloatArray]:
    """Return the face nearest to the hand, and a position ``(3,)`` [m] at which the hand is clear of this face.

    `room` is the smallest distance [m] between the face and the surface of the hand.
    """
    face, distance = _face_beside(state, hand, thing, axis)
    outward = normal(state, thing, face)
    return face, state[hand, "position"] + outward * max(0.0, hand["radius"] + room - distance)


def route_to_face(state: State, hand: Token, thing: Token, face: str) -> Route:
    """Return the hand's route around the box to a face. The cheaper direction is chosen."""
    axis = axis_beside(state, hand, thing, face)
    nearest, _ = _face_beside(state, hand, thing, axis)
    angle = float(ALIGNMENT.angle(state, hand, thing, face)) if can_turn(hand) else 0.0
    wide = can_turn(hand) and (angle > _STRAIGHT or nearest == OPPOSITE[face])
    room = _wide_room(hand) if wide else _ROOM
    place = place_at(state, hand, thing, face)
    before = place + normal(state, thing, face) * (room - STANDBY_GAP)
    origin, free = _off_face(state, hand, thing, axis, room)
    routes = []
    for step in (1, -1):
        beside = (hand["length"] / 2.0 + _SPARE) * step if wide else 0.0
        corners = _corners(state, hand, thing, axis, (origin, face), step, room, beside)
        routes.append([state[hand, "position"], free, *corners, before, place])
    lowest = thing.ground.height + (_half_diagonal(hand) + FLOOR_CLEARANCE if wide else 0.0)
    best = min(routes, key=lambda route: _cost(hand, thing, route, lowest))
    raised = [_raised(hand, thing, point, lowest) for point in best[1:-2]]
    return Route([best[0], *raised, *(above_ground(hand, thing, point) for point in best[-2:])], angle)


def _half_diagonal(hand: Token) -> float:
    """Return the radius [m] of the sphere in which a hand turns about its centre."""
    return float(np.hypot(hand["radius"], hand["length"] / 2.0))


def _wide_room(hand: Token) -> float:
    """Return the gap [m] between a box and a level hand on a wide detour. A like hand may wait at the face."""
    return STANDBY_GAP + float(hand["radius"]) + _half_diagonal(hand) + _SPARE


def _raised(hand: Token, thing: Token, point: FloatArray, lowest: float) -> FloatArray:
    """Return a position ``(3,)`` [m] raised to a height of at least `lowest` and to the height of a level hand."""
    return above_ground(hand, thing, np.maximum(point, np.array([-np.inf, -np.inf, lowest])))


def _corners(
    state: State,
    hand: Token,
    thing: Token,
    axis: int,
    ends: tuple[str, str],
    step: int,
    room: float,
    beside: float,
) -> list[FloatArray]:
    """Return the corners ``(3,)`` [m] on the route between two faces that are parallel to a body axis.

    Args:
        state: single state.
        hand: the hand.
        thing: the box.
        axis: index of the body axis.
        ends: the first and the last face.
        step: direction around the box, which is 1 or -1.
        room: gap between the box and the hand [m].
        beside: displacement of the corners along the body axis, out of the plane of the goal [m].
    """
    faces, (origin, goal) = _around(axis), ends
    here, found = faces.index(origin), []
    for _ in range((faces.index(goal) - here) * step % len(faces)):
        after = (here + step) % len(faces)
        away = sum(
            (NORMALS[faces[i]] * (half_extent(thing, faces[i]) + hand["radius"] + room) for i in (here, after)),
            start=np.zeros(3),
        )
        offset = to_body(state, thing, place_at(state, hand, thing, goal) - state[thing, "position"])
        # The hand moves in the plane perpendicular to the axis along which it lies at the goal.
        along = np.eye(3)[axis] if can_turn(hand) else to_body(state, thing, z_axis(state, hand))
        away = away + along * (offset @ along + beside)
        found.append(state[thing, "position"] + rotate(state[thing, "orientation"], away))
        here = after
    return found


def _cost(hand: Token, thing: Token, route: list[FloatArray], lowest: float) -> float:
    """Return the length of a route [m], plus a penalty if the route passes through the ground."""
    length = sum(float(np.linalg.norm(b - a)) for a, b in pairwise(route))
    sunk = sum(float(np.linalg.norm(_raised(hand, thing, point, lowest) - point)) for point in route[2:-2])
    return length + _BLOCKED * (sunk > 0)


def route_away(state: State, hand: Token, thing: Token) -> Route:
    """Return a route out of the space that the turning box may occupy."""
    axis = own_axis(state, hand, thing)
    face, free = _off_face(state, hand, thing, axis, _ROOM)
    outward = normal(state, thing, face) * HORIZONTAL
    if np.linalg.norm(outward) < 0.2:  # A hand above the box moves to the nearer side.
        outward = (state[hand, "position"] - state[thing, "position"]) * HORIZONTAL
        outward = outward - z_axis(state, hand) * (outward @ z_axis(state, hand))
    outward = outward / max(float(np.linalg.norm(outward)), 1e-9)
    halves = [half_extent(thing, side) for side in _around(axis)]
    have = float((free - state[thing, "position"]) @ outward)
    further = max(0.0, 2.0 * max(halves) + _AWAY * hand["radius"] - have)
    beyond = (above_ground(hand, thing, point) for point in (free, free + outward * further))
    return Route([state[hand, "position"], *beyond])
