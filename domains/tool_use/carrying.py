"""The block CARRYING (paper, D10), in which a hand brings a tool to the place of its next use.

In mode ``push``, the tool ends upright behind the object that it will push. In mode ``strike``, the tool ends raised
above the object that it will strike. In mode ``down``, the tool ends standing at its initial place.
"""

from typing import Any

import numpy as np

from hybrid_tamp.authoring import Binding, Block, Literal, State, Target
from hybrid_tamp.skills import (
    AT_REST,
    Goal,
    Graspable,
    HeldPose,
    Region,
    bring_to,
    get_tokens,
    make_carrying,
    stand_at,
    yaw,
)

from .classes import Pushable, Pusher, Strikable, Striker
from .feasibility import (
    ABLE_TO_PUSH,
    ABLE_TO_STRIKE,
    FIRM_ENOUGH,
    HOME,
    PUSH_WITHIN_REACH,
    SQUARE_TO,
    STRIKE_WITHIN_REACH,
)
from .geometry import RAISED, push_pose, strike_place, top
from .predicates import GRIP, IN_PUSH_STANCE, IN_STRIKE_STANCE, STANDS


def _behind(binding: Binding, state: State) -> HeldPose:
    hand, tool, thing, region = get_tokens(binding, "hand", "tool", "object", "region")
    return bring_to(state, hand, tool, *push_pose(state, tool, thing, region))


def _above(binding: Binding, state: State) -> HeldPose:
    hand, tool, thing = get_tokens(binding, "hand", "tool", "object")
    place = strike_place(state, hand, tool, top(state, thing))
    direction = yaw(state, tool)
    return place, direction, np.full_like(direction, RAISED)


def _carry(mode: str, goal: Goal, tool: type[Graspable], arrived: Literal, *facts: Literal, **told: Any) -> Block:
    """Return a mode of CARRYING that ends the stand of the tool."""
    told |= {"feasible": facts, "entry": (AT_REST("object"),), "thing": tool}
    return make_carrying(f"CARRYING:{mode}", GRIP, goal, (arrived, ~STANDS("tool")), **told)


CARRYING = (
    _carry(
        "push",
        _behind,
        Pusher,
        IN_PUSH_STANCE("tool", "object", "region"),
        ABLE_TO_PUSH("hand", "tool", "object"),
        SQUARE_TO("object", "region"),
        PUSH_WITHIN_REACH("hand", "tool", "object", "region"),
        # Only the initial position of the object is used, so the object may move later.
        targets=(Target("object", Pushable, reads=()), Target("region", Region)),
        description="the hand brings the upright tool to a place behind the object that it will push",
    ),
    _carry(
        "strike",
        _above,
        Striker,
        IN_STRIKE_STANCE("hand", "tool", "object"),
        ABLE_TO_STRIKE("hand", "tool", "object"),
        FIRM_ENOUGH("hand", "tool", "object"),
        STRIKE_WITHIN_REACH("hand", "tool", "object"),
        targets=(Target("object", Strikable, reads=()),),
        description="the hand raises the tool above the object that it will strike",
    ),
    make_carrying(
        "CARRYING:down",
        GRIP,
        stand_at("region", "tool"),
        (STANDS("tool"),),
        feasible=(HOME("tool", "region"),),
        targets=(Target("region", Region),),
        ends=("region",),
        description="the hand sets the tool down at its initial place",
    ),
)
