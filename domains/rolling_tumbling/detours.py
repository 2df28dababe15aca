"""Curves that lead a hand around a box: rounded polylines in the plane perpendicular to the hand's axis."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from hybrid_tamp.authoring import FloatArray, Profile, State, Token, rotate
from hybrid_tamp.skills import HORIZONTAL, NORMALS, OPPOSITE, STANDBY_GAP, advance, half_extent, normal, to_body, z_axis

from .tumbling_geometry import above_floor, place_at, sides_across

_ROOM = 0.055
"""Gap [m] between a box and a passing hand. The gap is wide enough for another hand."""
_ROUNDING = 0.05
_TOUCHING = 0.005
_SAMPLES = 8
_BLOCKED = 100.0
_AWAY = 5.5
"""Final distance, in hand radii, of a departing hand from the space that the turning box may occupy."""
_LONGEST = 7


@dataclass(frozen=True, eq=False)
class Curve:
    """A curve along which a hand moves from rest to rest.

    Attributes:
        points: densely sampled points of the curve ``(..., p, 3)`` [m].
        arcs: arc length from the start to each point ``(..., p)`` [m].
    """

    points: FloatArray
    arcs: FloatArray

    @property
    def length(self) -> FloatArray:
        """Arc length of the curve ``(...)`` [m]."""
        return np.asarray(self.arcs[..., -1])

    def at(self, elapsed: FloatArray, duration: FloatArray, profile: Profile) -> tuple[FloatArray, FloatArray]:
        """Return the hand's position [m] and velocity [m/s], each ``(..., 3)``, for a movement with a speed profile."""
        travelled, speed = advance(profile, elapsed, duration, self.length)
        index = np.clip(np.sum(self.arcs <= travelled[..., None], axis=-1), 1, self.arcs.shape[-1] - 1)
        # The open grid of indices lets each member of the batch read its own curve.
        members = np.indices(self.arcs.shape[:-1], sparse=True)
        before, after = (*members, index - 1), (*members, index)
        low, high, start = self.points[before], self.points[after], self.arcs[before]
        along = high - low
        span = np.linalg.norm(along, axis=-1)
        direction = along / np.maximum(span, 1e-12)[..., None]
        return low + direction * (travelled - start)[..., None], direction * speed[..., None]


def off_the_face(start: State, hand: Token, thing: Token) -> FloatArray:
    """Return the outward normal ``(..., 3)`` of the face that the hand touches, or zero if the hand touches no face."""
    rows = [State(start.layout, row) for row in start.values.reshape(-1, start.values.shape[-1])]
    return np.array([_outward(state, hand, thing) for state in rows]).reshape(*start.values.shape[:-1], 3)


def _outward(state: State, hand: Token, thing: Token) -> FloatArray:
    face, distance = _face_beside(state, hand, thing)
    touching = distance < hand["radius"] + _TOUCHING
    return normal(state, thing, face) if touching else np.zeros(3)


def curve_through(start: State, make: Callable[[State], list[FloatArray]]) -> Curve:
    """Return a curve with rounded corners for each state of a batch. ``make(state)`` returns the corners."""
    rows = start.values.reshape(-1, start.values.shape[-1])
    polylines = [_padded(make(State(start.layout, row))) for row in rows]
    points = _rounded(np.array(polylines))
    steps = np.linalg.norm(np.diff(points, axis=-2), axis=-1)
    arcs = np.concatenate([np.zeros((len(rows), 1)), np.cumsum(steps, axis=-1)], axis=-1)
    batch = start.values.shape[:-1]
    return Curve(points.reshape(*batch, -1, 3), arcs.reshape(*batch, -1))


def _padded(corners: list[FloatArray]) -> FloatArray:
    """Repeat the last corner of a polyline until it has as many corners as the longest polyline."""
    return np.array(corners + [corners[-1]] * (_LONGEST - len(corners)))


def _rounded(corners: FloatArray) -> FloatArray:
    """Replace each inner corner of polylines ``(n, c, 3)`` with a short parabola. Return points ``(n, p, 3)``."""
    pieces = [corners[:, :1]]
    part = np.linspace(0.0, 1.0, _SAMPLES)[:, None]
    for index in range(1, corners.shape[1] - 1):
        corner = corners[:, index : index + 1]
        into = _shortened(corners[:, index - 1 : index] - corner)
        out = _shortened(corners[:, index + 1 : index + 2] - corner)
        pieces.append(corner + into * (1.0 - part) ** 2 + out * part**2)
    return np.concatenate([*pieces, corners[:, -1:]], axis=1)


def _shortened(leg: FloatArray) -> FloatArray:
    """Return the part of a leg that a rounded corner replaces, which is at most half of the leg."""
    length = np.linalg.norm(leg, axis=-1, keepdims=True)
    return np.asarray(leg * np.minimum(0.5, _ROUNDING / np.maximum(length, 1e-9)))


def _around(state: State, hand: Token, thing: Token) -> tuple[str, str, str, str]:
    """Return the four faces whose normals are perpendicular to the hand's axis, in their order around the box."""
    one, _, other, _ = sides_across(state, hand, thing)
    return one, other, OPPOSITE[one], OPPOSITE[other]


def _face_beside(state: State, hand: Token, thing: Token) -> tuple[str, float]:
    """Return the face nearest to the hand, and the distance [m] between this face and the hand's centre."""
    offset = to_body(state, thing, state[hand, "position"] - state[thing, "position"])
    distances = {face: float(NORMALS[face] @ offset) - half_extent(thing, face) for face in _around(state, hand, thing)}
    face = max(distances, key=lambda name: distances[name])
    return face, distances[face]


def _off_face(state: State, hand: Token, thing: Token) -> tuple[str, FloatArray]:
    """Return the face nearest to the hand, and a position ``(3,)`` [m] at which the hand is clear of this face."""
    face, distance = _face_beside(state, hand, thing)
    outward = normal(state, thing, face)
    return face, state[hand, "position"] + outward * max(0.0, hand["radius"] + _ROOM - distance)


def corners_to_face(state: State, hand: Token, thing: Token, face: str) -> list[FloatArray]:
    """Return the corners ``(3,)`` [m] of the hand's route around the box to a face. The cheaper direction is chosen."""
    place = place_at(state, hand, thing, face)
    outward = normal(state, thing, face)
    before = place + outward * (_ROOM - STANDBY_GAP)
    origin, free = _off_face(state, hand, thing)
    faces = _around(state, hand, thing)
    routes = [_corners(state, hand, thing, faces, origin, face, step) for step in (1, -1)]
    whole = [[state[hand, "position"], free, *corners, before, place] for corners in routes]
    best = min(whole, key=lambda route: _cost(hand, route))
    return [route_point if index == 0 else above_floor(hand, route_point) for index, route_point in enumerate(best)]


def _corners(
    state: State, hand: Token, thing: Token, faces: tuple[str, ...], origin: str, goal: str, step: int
) -> list[FloatArray]:
    """Return the corners on the route between two faces. The direction around the box is `step`, which is 1 or -1."""
    here, found = faces.index(origin), []
    while faces[here] != goal:
        after = (here + step) % len(faces)
        away = sum(
            (NORMALS[faces[i]] * (half_extent(thing, faces[i]) + hand["radius"] + _ROOM) for i in (here, after)),
            start=np.zeros(3),
        )
        # The hand moves in the plane perpendicular to its own axis.
        axis = to_body(state, thing, z_axis(state, hand))
        offset = to_body(state, thing, place_at(state, hand, thing, goal) - state[thing, "position"])
        away = away + axis * (offset @ axis)
        found.append(state[thing, "position"] + rotate(state[thing, "orientation"], away))
        here = after
    return found


def _cost(hand: Token, route: list[FloatArray]) -> float:
    """Return the length of a route [m], plus a penalty if the route passes through the floor."""
    length = sum(float(np.linalg.norm(b - a)) for a, b in pairwise(route))
    sunk = sum(float(np.linalg.norm(above_floor(hand, point) - point)) for point in route[2:-2])
    return length + _BLOCKED * (sunk > 0)


def corners_away(state: State, hand: Token, thing: Token) -> list[FloatArray]:
    """Return the corners, each ``(3,)`` [m], of a route out of the space that the turning box may occupy."""
    face, free = _off_face(state, hand, thing)
    outward = normal(state, thing, face) * HORIZONTAL
    if np.linalg.norm(outward) < 0.2:  # A hand above the box moves to the nearer side.
        outward = (state[hand, "position"] - state[thing, "position"]) * HORIZONTAL
        outward = outward - z_axis(state, hand) * (outward @ z_axis(state, hand))
    outward = outward / max(float(np.linalg.norm(outward)), 1e-9)
    halves = [half_extent(thing, side) for side in _around(state, hand, thing)]
    have = float((free - state[thing, "position"]) @ outward)
    further = max(0.0, 2.0 * max(halves) + _AWAY * hand["radius"] - have)
    return [state[hand, "position"], above_floor(hand, free), above_floor(hand, free + outward * further)]
