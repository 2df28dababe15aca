"""The trial that tests whether a new object is ROLLABLE: a hand must roll the object over 0.6 m."""

from collections.abc import Mapping

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
    across,
    points_of,
    quaternion_from_axis_angle,
    quaternion_multiply,
    quaternion_of_rotation,
    rolling_radius,
    roundest_axis,
    silhouette,
    volume_of,
)
from hybrid_tamp.skills import HORIZONTAL, UP, Region, StaticEndEffector, z_axis

from .classes import Rollable
from .geometry import heading
from .predicates import WITHIN_WORKSPACE

DISTANCE, TOLERANCE = 0.6, 0.05
"""Distance of the trial roll, and largest final distance from the goal in a passed trial [m]."""
ROLLED: Mapping[str, tuple[float, float]] = {"final_distance [m]": (0.0, TOLERANCE), "roll_ratio": (0.9, 1.1)}
"""Maps each metric to its bounds in a passed trial. The distance rejects an object that turns once and stops."""
_OFFSET, _YAW = 0.02, float(np.radians(1.0))
"""Largest random offsets of the initial position [m] and of the initial yaw [rad]."""
_HAND = (0.25, -0.45, 0.3)
"""Initial position of the hand [m]: along the roll, beyond the token's end, and above the floor."""


def mass_of(token: Token, labelled: Token) -> float:
    """Return the known mass of a token [kg], or an estimate from the density of a labelled token."""
    if "mass" in token.properties:
        return float(token["mass"])
    return round(float(labelled["mass"]) * volume_of(token.solid) / volume_of(labelled.solid), 3)


def _align(task: Task, token: Token, labelled: Token) -> FloatArray:
    """Return the rotation that turns the labelled token's axis of rotation onto the new shape's roundest axis."""
    return np.asarray(frame(roundest_axis(token.solid)) @ frame(np.asarray(labelled["axis_of_rotation"])).T)


def frame(axis: FloatArray) -> FloatArray:
    """Return a rotation matrix ``(3, 3)`` that turns the z axis onto the given axis."""
    return np.column_stack([*across(axis), axis])


def _estimate(task: Task, token: Token, labelled: Token, carry: Carry) -> Estimate:
    """Return the estimated properties and contact points. `carry` maps points of the labelled token to the new one."""
    old = np.asarray(labelled["axis_of_rotation"])
    end = old * float((points_of(labelled.solid) @ old).max())
    ends = carry(np.array([end, -end]))
    axis = ends[0] - ends[1]
    axis /= np.linalg.norm(axis)
    one, other = across(old)
    sides = carry(labelled["radius_of_rotation"] * np.array([one, -one, other, -other]))
    properties = {
        "axis_of_rotation": tuple(round(float(component), 4) + 0.0 for component in axis),
        "radius_of_rotation": round(rolling_radius(token.solid, axis), 4),
        "mass": mass_of(token, labelled),
        "friction": token.properties.get("friction", labelled["friction"]),
        "rolling_friction": token.properties.get("rolling_friction", labelled["rolling_friction"]),
    }
    contacts = {f"side {number}": (x, y, z) for number, (x, y, z) in enumerate(sides.tolist(), start=1)}
    return Estimate(properties, contacts)


def _task(task: Task, member: Token, rng: np.random.Generator | None) -> Task:
    """Return a task in which a hand rolls a token to a region. The token's axis is parallel to a level hand."""
    hand = next((token for token in task.tokens if token.is_member(StaticEndEffector)), None)
    x, y, yaw = (0.0, 0.0, 0.0) if rng is None else rng.uniform(-1.0, 1.0, 3) * (_OFFSET, _OFFSET, _YAW)
    place = task.state[member, "position"] + np.array([x, y, 0.0])
    turned, height = _lying(task, member, hand, yaw)
    region = Token.make("place to roll to", [Region], {"radius": TOLERANCE})
    tokens = (*(() if hand is None else (hand,)), member, region)
    given = {
        (member.name, "position"): np.array([place[0], place[1], height]),
        (member.name, "orientation"): turned,
        **({} if hand is None else {(hand.name, "orientation"): task.state[hand, "orientation"]}),
    }
    starts = [_towards(State.of(tokens, given), member, hand, region, sign) for sign in (1.0, -1.0)]
    rooms = [0.0 if hand is None else float(WITHIN_WORKSPACE.evaluate(start, hand, member, region)) for start in starts]
    start = starts[0] if rooms[0] >= min(rooms[1], 0.0) else starts[1]
    goal = (Atom("inside", (member.name, region.name)),)
    return task.replaced(name=f"roll {member.name}", tokens=tokens, state=start, goal=goal, agents={}, assignment={})


def _towards(state: State, member: Token, hand: Token | None, region: Token, sign: float) -> State:
    along = sign * heading(state, member)
    centre = state[member, "position"]
    changes = {(region.name, "position"): (centre + DISTANCE * along) * HORIZONTAL}
    if hand is not None:
        ahead, beyond, up = _HAND
        aside = beyond - float(np.abs(points_of(member.solid) @ np.asarray(member["axis_of_rotation"])).max())
        start = centre * HORIZONTAL + ahead * along + aside * np.cross(UP, along) + up * UP
        inside = np.clip(start, hand["workspace_lower"], hand["workspace_upper"])
        changes[hand.name, "position"] = inside
    return state.replace(changes)


def _lying(task: Task, member: Token, hand: Token | None, yaw: float) -> tuple[FloatArray, float]:
    """Return the orientation of a token that lies on its widest side, and the height of the token's centre [m]."""
    axis = np.asarray(member["axis_of_rotation"])
    along = np.array([0.0, 1.0, 0.0]) if hand is None else z_axis(task.state, hand) * HORIZONTAL
    along = along / np.linalg.norm(along) if np.linalg.norm(along) > 0.5 else np.array([0.0, 1.0, 0.0])
    points = points_of(member.solid)
    reach = silhouette(points, axis)
    one, other = across(axis)
    angle = 2.0 * np.pi * int(np.argmin(reach)) / len(reach)
    down = np.cos(angle) * one + np.sin(angle) * other
    body = np.column_stack([axis, -down, np.cross(axis, -down)])
    world = np.column_stack([along, UP, np.cross(along, UP)])
    lying = quaternion_of_rotation(world @ body.T)
    return quaternion_multiply(quaternion_from_axis_angle(UP, yaw), lying), float(reach.min())


TRY_ROLLING = TrialRecipe(Rollable, _align, _estimate, _task, ROLLED)
