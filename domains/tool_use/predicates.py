"""Predicates for tool use that may change during a task. Module `feasibility` contains the static predicates."""

import numpy as np

from hybrid_tamp.authoring import CAPTURE, FloatArray, Kind, Parameter, Predicate, State, Token
from hybrid_tamp.skills import (
    POSE,
    Graspable,
    Region,
    beside_handle,
    inside,
    lean,
    length_predicate,
    norm,
    off_handle,
    side,
    standing_height,
    yaw,
)

from .classes import DexterousHand, Pushable, Pusher, Strikable, Striker
from .geometry import LEVEL, RAISED, push_pose, strike_place, top

HAND = Parameter("hand", DexterousHand)
TOOL = Parameter("tool", Graspable)
_PUSHED = Parameter("object", Pushable)
_STRUCK = Parameter("object", Strikable)
_REGION = Parameter("region", Region)
OPEN = 0.7
"""Smallest ratio of the gap between an empty hand's fingers to the largest gap."""
_FINGER_TOLERANCE = 1e-4
_BESIDE_TOLERANCE = 0.02
_FOOT_TOLERANCE = 0.005
_TILT_TOLERANCE = np.radians(5.0)
_STANCE_TOLERANCE = 0.02
_ANGLE_TOLERANCE = np.radians(6.0)
_CLEAR = 0.075
"""Smallest angle above the horizontal at which a tool is clear of the object that the tool has struck [rad]."""


def _closeness_to_handle(state: State, hand: Token, tool: Token) -> FloatArray:
    return np.asarray(_BESIDE_TOLERANCE - norm(state[hand, "position"] - beside_handle(state, hand, tool)))


def _openness(state: State, hand: Token) -> FloatArray:
    return np.asarray(state[hand, "aperture"][..., 0] - OPEN * hand["maximal_aperture"])


def _grip(state: State, tool: Token, hand: Token) -> FloatArray:
    """Return a margin [m] that is positive if the handle is between the fingers and the fingers touch the handle."""
    closed = _FINGER_TOLERANCE - np.abs(state[hand, "aperture"][..., 0] - tool["handle_width"])
    return np.asarray(np.minimum(closed, CAPTURE - off_handle(state, hand, tool)))


def _standing(state: State, tool: Token) -> FloatArray:
    """Return a margin [m] that is positive if the tool stands upright with its head on the floor."""
    upright = _TILT_TOLERANCE - np.abs(lean(state, tool))
    level = _TILT_TOLERANCE - np.abs(side(state, tool)[..., 2])
    height = _FOOT_TOLERANCE - np.abs(state[tool, "position"][..., 2] - standing_height(tool))
    return np.asarray(np.minimum(np.minimum(upright, level) * _FOOT_TOLERANCE / _TILT_TOLERANCE, height))


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
AT_HANDLE = length_predicate(
    "at_handle",
    (HAND, TOOL),
    _closeness_to_handle,
    reads={"hand": ("position",), "tool": POSE},
    kind=Kind.MAINTAINED,
    description="{hand} is beside the handle of {tool}",
    denial="{hand} is not beside the handle of {tool}",
)
EMPTY = length_predicate(
    "empty",
    (HAND,),
    _openness,
    reads={"hand": ("aperture",)},
    description="{hand} is open and empty",
    denial="{hand} is closed or not empty",
)
HELD = length_predicate(
    "held",
    (TOOL, HAND),
    _grip,
    reads={"tool": POSE, "hand": ("position", "aperture")},
    kind=Kind.FUNCTIONAL,
    value_of="hand",
    description="{tool} is held by {hand}",
    denial="{tool} is not held by {hand}",
)
STANDS = length_predicate(
    "stands",
    (TOOL,),
    _standing,
    reads={"tool": POSE},
    description="{tool} stands on its head",
    denial="{tool} does not stand on its head",
)
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
CHANGING = (INSIDE, AT_HANDLE, EMPTY, HELD, STANDS, IN_PUSH_STANCE, IN_STRIKE_STANCE, TILTED_UP, STRUCK)
