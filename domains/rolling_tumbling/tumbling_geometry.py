"""Edges of a tumbling box, and contact points of the hands.

Vectors are in the world frame unless a name says otherwise. Batch dimensions come first.
"""

import numpy as np

from hybrid_tamp.authoring import Cylinder, FloatArray, State, Token, cross, rotate
from hybrid_tamp.skills import (
    NORMALS,
    STANDBY_GAP,
    UP,
    contact_distance,
    dot,
    half_extent,
    normal,
    normals,
    point,
    z_axis,
)

from .faces import faces_of
from .geometry import FLOOR_CLEARANCE
from .turning_hands import own_axis, parallelism

GRIP = 0.72
"""Height of a hand's contact point above the lower edge of its face, as a fraction of the face's height.

The value was found by experiment. With a smaller value, the tipping force is too large. With a larger value, the hands
lift the pivot edge.
"""
_HIGHEST = 0.9
_STEEP = 0.9
"""Vertical component of the normal above which a face points up or down."""
_AXES = np.eye(3)
SAG = float(np.radians(3.0))
"""Angle by which a leaning box may sink onto a hand [rad]."""
PAST_BALANCE = float(np.radians(6.0))
"""Angle by which a tipped box leans past its point of balance [rad]. At this angle, the box does not fall back and a
single hand can hold the box."""


def balance(thing: Token, down: str, forward: str) -> float:
    """Return the tilt [rad] from `down` towards `forward` at which the centre of the box is above the edge."""
    return float(np.arctan2(half_extent(thing, forward), half_extent(thing, down)))


def tilt(state: State, thing: Token, down: str, forward: str) -> FloatArray:
    """Return the angle ``(...)`` [rad] by which the box has turned from lying on `down` towards lying on `forward`."""
    heights = normals(state, thing, forward, down)[..., 2]
    return np.arctan2(-heights[..., 0], -heights[..., 1])


def nominal_tilt(thing: Token, posture: str, down: str, forward: str) -> float:
    """Return the tilt [rad], from `down` towards `forward`, of a box in a posture that names `down` or `forward`."""
    faces = faces_of(posture)
    if len(faces) == 1:
        return 0.0 if faces[0] == down else np.pi / 2
    beyond = PAST_BALANCE if faces == (down, forward) else -PAST_BALANCE
    return float(balance(thing, down, forward) + beyond)


def edge_position(state: State, thing: Token, down: str, forward: str) -> FloatArray:
    """Return the midpoint ``(..., 3)`` [m] of the edge between two faces."""
    middle = NORMALS[down] * half_extent(thing, down) + NORMALS[forward] * half_extent(thing, forward)
    return point(state, thing, middle)


def edge_axis(state: State, thing: Token, down: str, forward: str) -> FloatArray:
    """Return the axis ``(..., 3)`` about which the box turns over an edge, from `down` towards `forward`."""
    return rotate(state[thing, "orientation"], cross(NORMALS[forward], NORMALS[down]))


def side_below(state: State, hand: Token, thing: Token, face: str) -> FloatArray:
    """Return the outward normal ``(..., 3)``, in the body frame, of the lower of a face's two neighbours.

    The neighbours are the adjacent faces whose normals are perpendicular to the axis of a hand at `face`. The height of
    a hand on `face` is measured from the edge between `face` and its lower neighbour.
    """
    along = parallelism(state, hand, thing) + 2.0 * np.abs(NORMALS[face])
    across = _AXES[np.argmin(along, axis=-1)]
    height = rotate(state[thing, "orientation"], across)[..., 2]
    return np.asarray(across * np.where(height > 0, -1.0, 1.0)[..., None])


def contact_in_body(state: State, hand: Token, thing: Token, face: str) -> FloatArray:
    """Return the contact point ``(..., 3)`` [m] of a hand on a face, in the body frame of the box."""
    halves = np.asarray(thing["half_extents"])
    below = side_below(state, hand, thing, face)
    extent = 2.0 * dot(np.abs(below), halves)
    clear = height_above_edge(hand, extent, 2.0 * half_extent(thing, face))
    height = np.minimum(np.maximum(clear, GRIP * extent), _HIGHEST * extent)
    return np.asarray(NORMALS[face] * contact_distance(thing, face) + below * (extent / 2.0 - height)[..., None])


def height_above_edge(hand: Token, extent: FloatArray | float, width: float) -> FloatArray:
    """Return the smallest height ``(...)`` [m] above the edge at which a hand below a leaning box clears the ground.

    Args:
        hand: the hand, whose radius matters.
        extent: height of the face ``(...)`` [m].
        width: extent of the box along the face's normal [m].
    """
    # Angle between the face and the ground if the box leans over the face. A hand at the face must not touch the
    # ground, even if the weight of the box presses the hand down.
    angle = np.arctan2(extent, width) - PAST_BALANCE - SAG
    return np.asarray(hand["radius"] * (1.0 + np.cos(angle)) / np.sin(angle) + FLOOR_CLEARANCE)


def room_below(hand: Token, extent: float, width: float) -> float:
    """Return the height [m] of the highest contact point of a face, minus the height at which a hand has room below.

    Half of the clearance is enough: in physics, a hand with less than this touched the floor.
    """
    return float(_HIGHEST * extent - height_above_edge(hand, extent, width) + FLOOR_CLEARANCE / 2.0)


def place_at(state: State, hand: Token, thing: Token, face: str, gap: float = STANDBY_GAP) -> FloatArray:
    """Return the standby position ``(..., 3)`` [m] of a hand's centre at a face of a box."""
    contact = contact_in_body(state, hand, thing, face) + NORMALS[face] * (hand["radius"] + gap)
    return above_ground(hand, thing, point(state, thing, contact))


def above_ground(hand: Token, thing: Token, position: FloatArray) -> FloatArray:
    """Raise positions ``(..., 3)`` [m] of a level hand where necessary, so that it clears the ground of a box."""
    assert isinstance(hand.shape, Cylinder), "the shape of a STATIC END-EFFECTOR must be a cylinder"
    lowest = np.array([-np.inf, -np.inf, thing.ground.height + hand.shape.radius + FLOOR_CLEARANCE])
    return np.asarray(np.maximum(position, lowest))


def lowest_point(state: State, thing: Token) -> FloatArray:
    """Return the height ``(...)`` [m] of the box's lowest corner above its ground."""
    halves = np.asarray(thing["half_extents"])
    heights = np.abs(rotate(state[thing, "orientation"][..., None, :], _AXES)[..., 2])
    return np.asarray(state[thing, "position"][..., 2] - heights @ halves - thing.ground.height)


def landing(state: State, thing: Token, face: str) -> FloatArray:
    """Return how deep [m] a flat box, for a single state, lies within its ground after a tumble towards a face.

    If the face points up or down, or if the ground has no edge, the result is 1.
    """
    outward = normal(state, thing, face)
    if thing.ground.top is None or abs(float(outward[2])) > _STEEP:
        return np.asarray(1.0)
    down = min(NORMALS, key=lambda each: float(normal(state, thing, each)[2]))
    pivot, axis = edge_position(state, thing, down, face), edge_axis(state, thing, down, face)
    beside = axis * dot(np.abs(cross(NORMALS[down], NORMALS[face])), np.asarray(thing["half_extents"]))
    beyond = outward * 2.0 * half_extent(thing, down)
    corners = np.array([pivot + side + ahead for side in (-beside, beside) for ahead in (0.0 * beyond, beyond)])
    return np.asarray(thing.ground.depth(corners[:, :2]).min())


def sides_around(axis: int) -> tuple[str, ...]:
    """Return the four faces of a box that are parallel to a body axis, given by its index."""
    return tuple(face for face in NORMALS if not NORMALS[face][axis])


def sections(thing: Token, axis: int) -> tuple[float, float]:
    """Return the lengths [m] of the two edges of the box that are perpendicular to a body axis."""
    one, other = (2.0 * extent for index, extent in enumerate(thing["half_extents"]) if index != axis)
    return one, other


def outlook(state: State, hand: Token, thing: Token, face: str, posture: str) -> float:
    """Return the component, from -1 to 1, of a face's normal towards the hand's right if the box is in a posture.

    The state must be a single state. Boxes turn about the hand's axis only, so the posture and the current pose
    determine the normal. The hand's right is the cross product of its axis and the upward direction. If the hand's
    axis crosses the face, the result is 0.
    """
    if not {face, *faces_of(posture)} <= set(sides_around(own_axis(state, hand, thing))):
        return 0.0
    down, *others = faces_of(posture)
    turned = -np.pi / 2 - _angle(state, hand, thing, down)
    for forward in others:
        ahead = np.cos(_angle(state, hand, thing, forward) + turned)
        turned -= float(np.sign(ahead)) * nominal_tilt(thing, posture, down, forward)
    return float(np.cos(_angle(state, hand, thing, face) + turned))


def to_the_right(state: State, hand: Token) -> FloatArray:
    """Return the horizontal unit vector ``(..., 3)`` that points to the right of a level hand's axis."""
    return cross(z_axis(state, hand), UP)


def _angle(state: State, hand: Token, thing: Token, face: str) -> float:
    """Return the angle [rad] of a face's normal in the plane perpendicular to the hand's axis, from right to up."""
    outward = normal(state, thing, face)
    return float(np.arctan2(outward[2], outward @ to_the_right(state, hand)))
