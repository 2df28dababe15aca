"""Feasibility predicates of tool use. The planner evaluates these predicates before the search."""

import numpy as np

from hybrid_tamp.authoring import GRAVITY, FloatArray, Parameter, State, Token, grip_limits
from hybrid_tamp.skills import (
    HANDLE_ENDS,
    HORIZONTAL,
    POSE,
    STANDOFF,
    UP,
    Region,
    competence,
    depth_in_region,
    extent,
    largest_depth,
    physical_bound,
    standing_height,
    to_body,
    within_reach,
)

from .classes import Pushable, Pusher, Strikable, Striker
from .geometry import top, way
from .predicates import HAND, TOOL
from .swing import largest_impulse

_FLOOR_FRICTION = 1.0
_SQUARE_TOLERANCE = np.radians(5.0)


def resistance(thing: Token) -> float:
    """Return the friction force [N] of the floor on a sliding object."""
    return float(_FLOOR_FRICTION * thing["friction"] * GRAVITY * thing["mass"])


def _push(hand: Token, tool: Token, thing: Token) -> float:
    """Return an upper bound of the force [N] with which a hand can push over all grasps, minus the force of the push.

    The tool pushes along the direction in which the fingers close. The grip bears the force by one finger, and the
    moment of the force about the hand by a shift of the pads' pressure. The weight of the tool acts along the handle,
    and friction bears the weight. So the weight does not reduce the force of the push.
    """
    force = resistance(thing)
    limits = grip_limits(hand, tool, hand["maximal_grip"])
    most = min(hand["maximal_force"], limits[2])
    head = tool["pushing_point"][0]
    lever = max(head - tool["handle_to"][0], tool["handle_from"][0] - head, 0.0)
    if lever > 0:
        most = min(most, min(hand["maximal_torque"], limits[4]) / lever)
    return float(most - force)


def _strike(hand: Token, tool: Token, thing: Token) -> float:
    """Return an upper bound of the impulse [N s] of a strike, minus the impulse needed."""
    return largest_impulse(hand, tool) - float(thing["impulse_needed"])


def _firm_strike(hand: Token, tool: Token, thing: Token) -> float:
    """Return an upper bound of the impulse [N s] of a strike in which the grip holds, minus the impulse needed."""
    return largest_impulse(hand, tool, gripped=True) - float(thing["impulse_needed"])


def _hands_of_push(state: State, hand: Token, tool: Token, thing: Token, region: Token) -> list[FloatArray]:
    """Return the places ``(..., 3)`` [m] of a hand at either end of the handle, before and after a push."""
    ahead, _ = way(state, thing, region)
    back = (extent(state, thing, ahead) + tool["pushing_point"][2])[..., None]
    start = state[thing, "position"] - ahead * (back + STANDOFF)
    ends = (start * HORIZONTAL, (state[region, "position"] - ahead * back) * HORIZONTAL)
    return [place + UP * (standing_height(tool) - tool[end][0]) for place in ends for end in HANDLE_ENDS]


def _reach_of_strike(state: State, hand: Token, tool: Token, thing: Token) -> FloatArray:
    """Return an upper bound of the depth [m] of the hand at the impact, over all grasps and headings."""
    return _largest_reach_of_strike(state, 0.0, hand, tool, thing)


def _largest_reach_of_strike(state: State, radius: float, hand: Token, tool: Token, thing: Token) -> FloatArray:
    """Return `_reach_of_strike` for an object that is displaced by at most `radius` [m]."""
    tip_x, _, tip_z = tool["impact_point"]
    lever = max(abs(tool[end][0] - tip_x) for end in HANDLE_ENDS)
    above = top(state, thing) + UP * (tool["handle_to"][2] - tip_z)
    return largest_depth(hand, above, radius + lever)


def _squareness(state: State, thing: Token, region: Token) -> FloatArray:
    """Return a margin [rad] that is positive if the line to the region is nearly perpendicular to a side of the box."""
    ahead, _ = way(state, thing, region)
    local = to_body(state, thing, ahead)
    return np.asarray(_SQUARE_TOLERANCE - np.arccos(np.clip(np.abs(local).max(axis=-1), 0.0, 1.0)))


def _squareness_within(state: State, radius: float, thing: Token, region: Token) -> FloatArray:
    """Return an upper bound of `_squareness` for an object that is displaced by at most `radius` [m]."""
    _, distance = way(state, thing, region)
    turned = np.arcsin(np.clip(radius / np.maximum(distance, 1e-9), 0.0, 1.0))
    return np.asarray(np.minimum(_SQUARE_TOLERANCE, _squareness(state, thing, region) + turned))


def _largest_reach_of_push(
    state: State, radius: float, hand: Token, tool: Token, thing: Token, region: Token
) -> FloatArray:
    """Return an upper bound of the depth [m] in the workspace of `_hands_of_push`, for all directions of the push."""
    back = float(np.linalg.norm(thing["half_extents"])) + tool["pushing_point"][2]
    heights = [UP * (standing_height(tool) - tool[end][0]) for end in HANDLE_ENDS]
    ends = [largest_depth(hand, state[region, "position"] * HORIZONTAL + up, back) for up in heights]
    ends += [
        largest_depth(hand, state[thing, "position"] * HORIZONTAL + up, radius + back + STANDOFF) for up in heights
    ]
    return np.asarray(np.min(ends, axis=0))


ABLE_TO_PUSH = physical_bound(
    "able_to_push",
    (HAND, Parameter("tool", Pusher), Parameter("object", Pushable)),
    _push,
    unit="N",
    scale=10.0,
    description="{hand} is strong enough to push {object} with {tool}",
    denial="{hand} is too weak to push {object} with {tool}",
)
ABLE_TO_STRIKE = physical_bound(
    "able_to_strike",
    (HAND, Parameter("tool", Striker), Parameter("object", Strikable)),
    _strike,
    unit="N s",
    scale=0.1,
    description="{hand} can strike {object} hard enough with {tool}",
    denial="{hand} cannot strike {object} hard enough with {tool}",
)
FIRM_ENOUGH = competence(
    "firm_enough",
    (HAND, Parameter("tool", Striker), Parameter("object", Strikable)),
    _firm_strike,
    unit="N s",
    scale=0.1,
    description="{hand} grips {tool} firmly enough to strike {object} hard enough",
    denial="{tool} slips in the grip of {hand} before it can strike {object} hard enough",
)
STRIKE_WITHIN_REACH = competence(
    "strike_within_reach",
    (HAND, Parameter("tool", Striker), Parameter("object", Strikable)),
    _reach_of_strike,
    reads={"object": POSE},
    bound=_largest_reach_of_strike,
    description="{hand} can strike {object} with {tool} without leaving the workspace of the hand",
    denial="{hand} cannot strike {object} with {tool} without leaving the workspace of the hand",
)
SQUARE_TO = competence(
    "square_to",
    (Parameter("object", Pushable), Parameter("region", Region)),
    _squareness,
    unit="rad",
    scale=0.05,
    reads={"object": POSE, "region": ("position",)},
    bound=_squareness_within,
    description="{object} has a side perpendicular to the line to {region}",
    denial="{object} has no side perpendicular to the line to {region}, so a push would turn {object}",
)
PUSH_WITHIN_REACH = within_reach(
    "push_within_reach",
    (HAND, Parameter("tool", Pusher), Parameter("object", Pushable), Parameter("region", Region)),
    _hands_of_push,
    reads={"object": POSE, "region": ("position",)},
    bound=_largest_reach_of_push,
    description="{hand} can push {object} to {region} with {tool} without leaving the workspace of the hand",
    denial="{hand} cannot push {object} to {region} with {tool} without leaving the workspace of the hand",
)
HOME = physical_bound(
    "home",
    (TOOL, Parameter("region", Region)),
    depth_in_region,
    reads={"tool": ("position",), "region": ("position",)},
    at_start=True,
    description="{region} is the initial place of {tool}",
    denial="{region} is not the initial place of {tool}",
)
