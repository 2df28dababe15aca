"""Poses of a hand and its tool at the beginning of a push and of a strike, and points of tools and objects.

A tool swings in the vertical plane of its heading. The swing angle is the `lean` of `hybrid_tamp.skills`: 0 if the tool
stands on its head, -pi/2 if it is level with its striking face down, and -pi if the head is up.
"""

import numpy as np

from hybrid_tamp.authoring import FloatArray, State, Token
from hybrid_tamp.skills import (
    HORIZONTAL,
    STANDOFF,
    UP,
    extent,
    hand_in,
    heading,
    height_below,
    norm,
    reach_along,
    standing_height,
    unit,
)

LEVEL = -np.pi / 2
"""Swing angle at which a tool strikes [rad]."""
RAISED = -np.pi
"""Swing angle of a tool that is raised for a strike [rad]."""
CLEARANCE = 0.012
"""Gap between a pushing tool and the floor [m]."""


def butt(tool: Token) -> FloatArray:
    """Return the corner ``(3,)`` [m] of the handle, in the body frame, that may hit a struck object or the floor."""
    return np.array(
        [-reach_along(tool, np.array([-1.0, 0.0, 0.0])), 0.0, tool["handle_to"][2] - tool["handle_width"] / 2]
    )


def way(state: State, thing: Token, region: Token) -> tuple[FloatArray, FloatArray]:
    """Return the horizontal direction ``(..., 3)`` and the distance ``(...)`` [m] from an object to a region."""
    offset = (state[region, "position"] - state[thing, "position"]) * HORIZONTAL
    return unit(offset), norm(offset)


def push_pose(state: State, tool: Token, thing: Token, region: Token) -> tuple[FloatArray, FloatArray]:
    """Return the position ``(..., 3)`` [m] and the yaw ``(...)`` [rad] of a tool that is ready to push an object."""
    ahead, _ = way(state, thing, region)
    back = extent(state, thing, ahead) + STANDOFF + tool["pushing_point"][2]
    place = state[thing, "position"] - ahead * back[..., None]
    height = np.full((*back.shape, 1), standing_height(tool) + CLEARANCE)
    return np.concatenate([place[..., :2], height], axis=-1), np.arctan2(ahead[..., 1], ahead[..., 0])


def top(state: State, thing: Token) -> FloatArray:
    """Return the centre ``(..., 3)`` [m] of a box's top face."""
    high = height_below(state, thing)
    return np.asarray(state[thing, "position"] + high[..., None] * UP)


def strike_place(state: State, hand: Token, tool: Token, target: FloatArray) -> FloatArray:
    """Return the position ``(..., 3)`` [m] of the hand's centre when the level tool hits a target ``(..., 3)`` [m]."""
    arm = hand_in(state, hand, tool) - np.asarray(tool["impact_point"])
    return np.asarray(target + arm[..., :1] * heading(state, tool) + arm[..., 2:] * UP)
