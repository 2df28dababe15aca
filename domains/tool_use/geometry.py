"""Positions and orientations of a hand and its tool while the tool is grasped, stands, pushes or strikes.

A tool swings in the vertical plane of its heading. This plane contains the x axis of the body frame, which points along
the handle, and the z axis of this frame. The swing angle is 0 if the tool stands on its head, with x down and z ahead.
The angle is -pi/2 if the tool is level, with its head ahead and its striking face down. The angle is -pi if the head is
up. Vectors are in the world frame unless a name says otherwise. Batch dimensions come first.
"""

from functools import cache

import numpy as np

from hybrid_tamp.authoring import (
    Box,
    Cylinder,
    FloatArray,
    Part,
    State,
    Token,
    quaternion_conjugate,
    quaternion_from_rpy,
    rotate,
    solids_of,
)
from hybrid_tamp.skills import HORIZONTAL, STANDOFF, UP, dot, extent, height_below, norm, point, to_body

LEVEL = -np.pi / 2
"""Swing angle at which a tool strikes [rad]."""
RAISED = -np.pi
"""Swing angle of a tool that is raised for a strike [rad]."""
CLEARANCE = 0.012
"""Gap between a pushing tool and the floor [m]."""
BESIDE = 0.09
"""Distance between a handle and a hand that waits before or after a grasp [m]."""
_RIGHT, _AHEAD_OF_SIDE = np.array([1, 0, 2]), np.array([1.0, -1.0, 0.0])
"""Indices and signs of the components in the cross product of a vector and `UP`."""


def hand_in_tool(state: State, hand: Token, tool: Token) -> FloatArray:
    """Return the position ``(..., 3)`` [m] of the hand's centre in the tool's body frame."""
    return in_box(state, tool, state[hand, "position"])


def handle_length(tool: Token) -> float:
    """Return the length of the graspable segment [m]."""
    return float(tool["handle_to"][0] - tool["handle_from"][0])


def on_handle(tool: Token, location: FloatArray | float) -> FloatArray:
    """Return the point ``(..., 3)`` [m] of the handle, in the body frame, at a distance [m] from ``handle_to``."""
    return np.asarray(tool["handle_to"] - np.asarray(location)[..., None] * np.array([1.0, 0.0, 0.0]))


def location(state: State, hand: Token, tool: Token) -> FloatArray:
    """Return the distance ``(...)`` [m] along the handle from ``handle_to`` to the hand."""
    return np.asarray(tool["handle_to"][0] - hand_in_tool(state, hand, tool)[..., 0])


def off_handle(state: State, hand: Token, tool: Token) -> FloatArray:
    """Return the distance ``(...)`` [m] between the hand's centre and the graspable segment."""
    place = hand_in_tool(state, hand, tool)
    along = np.clip(place[..., 0], tool["handle_from"][0], tool["handle_to"][0])
    return norm(
        place - np.concatenate([along[..., None], np.broadcast_to(tool["handle_to"][1:], (*along.shape, 2))], -1)
    )


def beside(state: State, hand: Token, tool: Token) -> FloatArray:
    """Return the waiting position ``(..., 3)`` [m] of a hand beside the middle of a handle, on the hand's side."""
    aside = np.where(hand_in_tool(state, hand, tool)[..., 1] < 0, -BESIDE, BESIDE)
    middle = on_handle(tool, handle_length(tool) / 2)
    return point(state, tool, middle + aside[..., None] * np.array([0.0, 1.0, 0.0]))


def side(state: State, tool: Token) -> FloatArray:
    """Return the y axis ``(..., 3)`` of the tool, which is the axis of its swings."""
    return rotate(state[tool, "orientation"], np.array([0.0, 1.0, 0.0]))


def heading(state: State, tool: Token) -> FloatArray:
    """Return the horizontal unit vector ``(..., 3)`` that points ahead of the tool."""
    across = side(state, tool)
    return _unit(across.take(_RIGHT, -1) * _AHEAD_OF_SIDE)


def yaw(state: State, tool: Token) -> FloatArray:
    """Return the angle ``(...)`` [rad] of the tool's heading about the vertical axis."""
    ahead = heading(state, tool)
    return np.arctan2(ahead[..., 1], ahead[..., 0])


def swing_angle(state: State, tool: Token) -> FloatArray:
    """Return the swing angle ``(...)`` [rad] of the tool, from -3/2 pi to pi/2."""
    along = rotate(state[tool, "orientation"], np.array([1.0, 0.0, 0.0]))
    angle = np.arctan2(-dot(along, heading(state, tool)), -along[..., 2])
    return np.asarray(np.where(angle > np.pi / 2, angle - 2 * np.pi, angle))


def tool_orientation(direction: FloatArray, angle: FloatArray | float) -> FloatArray:
    """Return the orientation ``(..., 4)`` of a tool with a yaw [rad] and a swing angle [rad]."""
    turned, swung = np.broadcast_arrays(direction, np.asarray(angle) + np.pi / 2)
    return quaternion_from_rpy(np.stack([np.zeros_like(turned), swung, turned], axis=-1))


def foot(tool: Token) -> float:
    """Return the height [m] of the centre of mass of a tool that stands on its head."""
    return max(map(_ahead, solids_of(tool.solid)))


def butt(tool: Token) -> FloatArray:
    """Return the corner ``(3,)`` [m] of the handle, in the body frame, that may hit a struck object or the floor."""
    back = max(_ahead(part, -1.0) for part in solids_of(tool.solid))
    return np.array([-back, 0.0, tool["handle_to"][2] - tool["handle_width"] / 2])


@cache
def _ahead(part: Part, way: float = 1.0) -> float:
    """Return how far [m] a part of a shape extends along the body's x axis, or along -x if `way` is -1."""
    along = rotate(quaternion_conjugate(quaternion_from_rpy(part.rpy)), np.array([way, 0.0, 0.0]))
    if isinstance(part, Box):
        reach = float(np.abs(along) @ np.asarray(part.half_extents))
    elif isinstance(part, Cylinder):
        reach = float(part.radius * np.hypot(along[0], along[1]) + part.length / 2 * abs(along[2]))
    else:
        reach = part.radius
    return way * part.position[0] + reach


def way(state: State, thing: Token, region: Token) -> tuple[FloatArray, FloatArray]:
    """Return the horizontal direction ``(..., 3)`` and the distance ``(...)`` [m] from an object to a region."""
    offset = (state[region, "position"] - state[thing, "position"]) * HORIZONTAL
    return _unit(offset), norm(offset)


def in_box(state: State, thing: Token, place: FloatArray) -> FloatArray:
    """Convert a position ``(..., 3)`` [m] from the world frame to the body frame of an object."""
    return to_body(state, thing, place - state[thing, "position"])


def push_pose(state: State, tool: Token, thing: Token, region: Token) -> tuple[FloatArray, FloatArray]:
    """Return the position ``(..., 3)`` [m] and the yaw ``(...)`` [rad] of a tool that is ready to push an object."""
    ahead, _ = way(state, thing, region)
    back = extent(state, thing, ahead) + STANDOFF + tool["pushing_point"][2]
    place = state[thing, "position"] - ahead * back[..., None]
    height = np.full((*back.shape, 1), foot(tool) + CLEARANCE)
    return np.concatenate([place[..., :2], height], axis=-1), np.arctan2(ahead[..., 1], ahead[..., 0])


def top(state: State, thing: Token) -> FloatArray:
    """Return the centre ``(..., 3)`` [m] of a box's top face."""
    high = height_below(state, thing)
    return np.asarray(state[thing, "position"] + high[..., None] * UP)


def strike_place(state: State, hand: Token, tool: Token, target: FloatArray) -> FloatArray:
    """Return the position ``(..., 3)`` [m] of the hand's centre when the level tool hits a target ``(..., 3)`` [m]."""
    arm = hand_in_tool(state, hand, tool) - np.asarray(tool["impact_point"])
    return np.asarray(target + arm[..., :1] * heading(state, tool) + arm[..., 2:] * UP)


def _unit(vector: FloatArray) -> FloatArray:
    length = norm(vector)[..., None]
    # The result must be finite for a zero vector, too. Predicates exclude states with a zero vector.
    if np.minimum.reduce(length, axis=None, initial=1.0) > 1e-9:
        return np.asarray(vector / length)
    return np.where(length > 1e-9, vector / np.maximum(length, 1e-9), np.array([1.0, 0.0, 0.0]))
