"""Predicates for tool use that may change during a task. Module `feasibility` contains the static predicates."""

import numpy as np

from hybrid_tamp.authoring import FloatArray, Kind, Parameter, Predicate, State, Token
from hybrid_tamp.skills import POSE, Graspable, Grip, Region, inside, lean, length_predicate, norm, stands, yaw

from .classes import DexterousHand, Pushable, Pusher, Strikable, Striker
from .geometry import LEVEL, RAISED, push_pose, strike_place, top

HAND = Parameter("hand", DexterousHand)
TOOL = Parameter("tool", Graspable)
GRIP = Grip(DexterousHand, Graspable, "tool")
HELD = GRIP.held
_PUSHED = Parameter("object", Pushable)
_STRUCK = Parameter("object", Strikable)
_REGION = Parameter("region", Region)
_STANCE_TOLERANCE = 0.02
_ANGLE_TOLERANCE = np.radians(6.0)
_CLEAR = 0.075
"""Smallest angle above the horizontal at which a tool is clear of the object that the tool has struck [rad]."""


def _stance(distance: FloatArray, *angles: FloatArray) -> FloatArray:
    """Return the smallest margin [m] of a distance [m] and of angles [rad], whose margins are scaled to lengths."""
    margin = np.asarray(_STANCE_TOLERANCE - distance)
    for angle in angles:
        turned = np.abs((angle + np.pi) % (2 * np.pi) - np.pi)
        margin = np.minimum(margin, _STANCE_TOLERANCE * (1.0 - turned / _ANGLE_TOLERANCE))
    return margin


def _push_stance(state: State, tool: Token, thing: Token, region: Token) -> FloatArray:
    place, direction = push_pose(state, tool, thing, region)
    off = norm(state[tool, "position"] - place)
    return _stance(off, lean(state, tool), yaw(state, tool) - direction)


def _strike_stance(state: State, hand: Token, tool: Token, thing: Token) -> FloatArray:
    off = norm(state[hand, "position"] - strike_place(state, hand, tool, top(state, thing)))
    return _stance(off, lean(state, tool) - RAISED)


def _tilt(state: State, tool: Token) -> FloatArray:
    return LEVEL - _CLEAR - lean(state, tool)


def _impulse(state: State, thing: Token) -> FloatArray:
    return np.asarray(state[thing, "impulse"][..., 0] - thing["impulse_needed"])


INSIDE = inside(Pushable)
STANDS = stands(Graspable, "tool", description="{tool} stands on its head", denial="{tool} does not stand on its head")
IN_PUSH_STANCE = length_predicate(
    "in_push_stance",
    (Parameter("tool", Pusher), _PUSHED, _REGION),
    _push_stance,
    reads={"tool": POSE, "object": POSE, "region": ("position",)},
    kind=Kind.MAINTAINED,
    description="{tool} is upright behind {object} as seen from {region}",
    denial="{tool} is not upright behind {object} as seen from {region}",
)
IN_STRIKE_STANCE = length_predicate(
    "in_strike_stance",
    (HAND, Parameter("tool", Striker), _STRUCK),
    _strike_stance,
    reads={"hand": ("position",), "tool": POSE, "object": POSE},
    kind=Kind.MAINTAINED,
    description="{hand} has raised {tool} to strike {object}",
    denial="{hand} has not raised {tool} to strike {object}",
)
TILTED_UP = Predicate(
    "tilted_up",
    (Parameter("tool", Striker),),
    _tilt,
    unit="rad",
    scale=0.05,
    reads={"tool": ("orientation",)},
    kind=Kind.MAINTAINED,
    description="{tool} is tilted up, clear of what {tool} has struck",
    denial="{tool} is not tilted up",
)
STRUCK = Predicate(
    "struck",
    (_STRUCK,),
    _impulse,
    unit="N s",
    scale=0.1,
    reads={"object": ("impulse",)},
    description="{object} has been struck hard enough",
    denial="{object} has not been struck hard enough",
)
