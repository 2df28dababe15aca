"""The trial that tests whether a new object is TUMBLABLE: two hands must tumble the object onto another face."""

import numpy as np

from hybrid_tamp.authoring import (
    Atom,
    Carry,
    Estimate,
    FloatArray,
    State,
    Task,
    Token,
    TrialRecipe,
    cross,
    points_of,
    quaternion_from_axis_angle,
    quaternion_multiply,
    rotate,
)
from hybrid_tamp.skills import HORIZONTAL, NORMALS, UP, StaticEndEffector, can_turn, normal, to_body, z_axis

from .classes import Tumblable
from .faces import FACE, flat
from .metrics import CONTROLLED
from .probing_rolling import mass_of
from .standing import FLAT_TOLERANCE
from .tumbling_geometry import GRIP, sides_around

_OFFSET, _YAW = 0.02, float(np.radians(2.0))
"""Largest random offsets of the initial position [m] and of the initial yaw [rad]."""
_ASIDE, _UP = 0.35, 0.55
"""Initial position of each hand [m]: distance beyond the token's longest half extent, and height above the floor."""


def _align(task: Task, token: Token, labelled: Token) -> FloatArray:
    """Return the identity matrix, because the body axes of each token define its faces."""
    return np.eye(3)


def _estimate(task: Task, token: Token, labelled: Token, carry: Carry) -> Estimate:
    """Return the properties estimated from the bounding box, and the contact points that `carry` maps to the token."""
    halves = np.abs(points_of(token.solid)).max(axis=0)
    contacts: dict[str, tuple[float, float, float]] = {}
    depths = halves.copy()
    turn = _turning_axis(task, token)
    for face, point in _touched(labelled, turn).items():
        x, y, z = carry(point[None])[0].tolist()
        contacts[face] = (x, y, z)
        axis = int(np.argmax(np.abs(NORMALS[face.split()[0]])))
        depths[axis] = min(depths[axis], abs((x, y, z)[axis]))
    properties = {
        "half_extents": tuple(round(float(half), 4) for half in halves),
        "hollow": tuple(round(float(depth), 4) for depth in halves - depths),
        "mass": mass_of(token, labelled),
        "friction": token.properties.get("friction", labelled["friction"]),
    }
    return Estimate(properties, contacts)


def _turning_axis(task: Task, token: Token) -> int:
    """Return the index of the body axis nearest to a hand's axis, or of the y axis if the task has no hand."""
    hand = next((one for one in task.tokens if one.is_member(StaticEndEffector)), None)
    return 1 if hand is None else int(np.argmax(np.abs(to_body(task.state, token, _along(task.state, hand)))))


def _along(state: State, hand: Token) -> FloatArray:
    """Return the axis ``(3,)`` along which a hand lies at the token. A hand that can turn lies along the y axis."""
    return np.array([0.0, 1.0, 0.0]) if can_turn(hand) else z_axis(state, hand)


def _touched(labelled: Token, turn: int) -> dict[str, FloatArray]:
    """Return the contact points on a labelled box that turns about an axis. Each side has one point near each edge."""
    halves = np.asarray(labelled["half_extents"]) - np.asarray(labelled["hollow"])
    found = {}
    for face in FACE.symbols:
        axis = int(np.argmax(np.abs(NORMALS[face])))
        if axis == turn:
            continue
        up = np.eye(3)[3 - axis - turn] * (2.0 * GRIP - 1.0) * labelled["half_extents"][3 - axis - turn]
        for name, way in (("upper", 1.0), ("lower", -1.0)):
            found[f"{face} {name}"] = NORMALS[face] * halves + way * up
    return found


def _task(task: Task, member: Token, rng: np.random.Generator | None) -> Task:
    """Return a task in which two hands, which start on opposite sides of a token, tumble the token.

    If the token lies flat in the original task, its orientation does not change. Otherwise, the token starts upright.
    """
    hands = tuple(token for token in task.tokens if token.is_member(StaticEndEffector))[:2]
    x, y, yaw = (0.0, 0.0, 0.0) if rng is None else rng.uniform(-1.0, 1.0, 3) * (_OFFSET, _OFFSET, _YAW)
    tokens = (*hands, member)
    centre = task.state[member, "position"] * HORIZONTAL
    standing = _standing(task, member)
    turned = quaternion_multiply(quaternion_from_axis_angle(UP, yaw), standing)
    given = {
        (member.name, "orientation"): turned,
        (member.name, "position"): centre + np.array([x, y, _height(member, turned)]),
    }
    aside = _ASIDE + max(member["half_extents"])
    for number, hand in enumerate(hands):
        side = cross(_along(task.state, hand), UP) * (aside if number % 2 else -aside)
        given[hand.name, "position"] = centre + side + _UP * UP
        given[hand.name, "orientation"] = task.state[hand, "orientation"]
    state = State.of(tokens, given)
    goal = (Atom("posture", (member.name, flat(_onto(state, hands, member)))),)
    return task.replaced(name=f"tumble {member.name}", tokens=tokens, state=state, goal=goal, agents={}, assignment={})


def _standing(task: Task, member: Token) -> FloatArray:
    orientation = task.state[member, "orientation"]
    normals = np.array([rotate(orientation, outward) for outward in NORMALS.values()])
    flat_enough = float(-normals[:, 2].min()) >= np.cos(FLAT_TOLERANCE)
    return orientation if flat_enough else np.array([0.0, 0.0, 0.0, 1.0])


def _height(member: Token, orientation: FloatArray) -> float:
    return float(-rotate(orientation, points_of(member.solid))[:, 2].min())


def _onto(state: State, hands: tuple[Token, ...], member: Token) -> str:
    """Return the face whose normal points furthest to the first hand's right, or the right face without hands."""
    if not hands:
        return "right"
    along = _along(state, hands[0])
    right, sides = cross(along, UP), sides_around(int(np.argmax(np.abs(to_body(state, member, along)))))
    return max(sides, key=lambda face: float(normal(state, member, face) @ right))


TRY_TUMBLING = TrialRecipe(Tumblable, _align, _estimate, _task, CONTROLLED)
