"""Laws of a roll with friction and rolling resistance, in closed form, and the predicates that state them.

An object of mass m and radius R has the friction mu and the rolling friction rho. A hand pushes the object from behind
with the force N at the height of its axis. The near side of the object moves up, so the hand presses this side down
with the friction nu N. Rolling friction acts at both contacts: a backend multiplies rho by the friction of the other
body, f for the ground (1 for the floor) and h for the hand. The moments about the axis balance if
N R = nu N R + f rho (m g + nu N) + h rho N. Without slip, the friction of the ground is N <= f mu (m g + nu N). The
smallest friction is thus mu = rho (1 + h mu)/(R (1 - nu)), for every f. A hand that pushes elsewhere may need less
friction. Without any friction, all forces act towards the axis, so that nothing turns the object. An object that rolls
alone slows down by f rho g/(R + I/(m R)), where I is its moment of inertia.
"""

import numpy as np

from hybrid_tamp.authoring import DEFAULT_FRICTION, GRAVITY, Cylinder, FloatArray, MeshShape, Parameter, State, Token
from hybrid_tamp.skills import (
    Resistance,
    StaticEndEffector,
    competence,
    height_below,
    physical_bound,
    z_axis,
)

from .classes import Rollable
from .geometry import FLOOR_CLEARANCE

_HAND = Parameter("hand", StaticEndEffector)
_OBJECT = Parameter("object", Rollable)
SMALLEST_DECELERATION = 0.01
"""Smallest deceleration of a roll [m/s^2]."""
_USUAL_DECELERATION = 0.15
_RESERVE = 0.8
"""Ratio of the hand's deceleration to that of an object which rolls alone, so that the object stays at the hand."""
_STEEPEST = 0.65
"""Largest sine of the inclination of a push. A steeper push presses the object down."""
_FRICTIONLESS = 1e-6
"""Friction below which an object counts as without friction."""
_OFF_CENTRE = 0.002
"""Largest distance [m] from the middle of an object at which a hand pushes."""


_LEAST_TURNING = 0.05
"""Smallest part of a push that turns an object in the forward model. ROLLS_STEADILY refuses objects without any."""


def _ground(thing: Token) -> float:
    """Return the rolling friction [m] of the object on its ground."""
    return float(thing["rolling_friction"] * thing.ground.friction)


def _grip(hand: Token, thing: Token) -> tuple[float, float, float]:
    """Return the ratio rho/R, the friction mu and the friction nu of the hand."""
    ratio = thing["rolling_friction"] / thing["radius_of_rotation"]
    return float(ratio), float(thing["friction"]), DEFAULT_FRICTION * float(thing["friction"])


def _least_friction(thing: Token) -> float:
    """Return the friction, or without friction the negative of the friction that the rolling resistance needs."""
    ratio, friction = float(thing["rolling_friction"] / thing["radius_of_rotation"]), _friction(thing)
    return friction if friction >= _FRICTIONLESS else -max(ratio, _FRICTIONLESS)


def _friction(thing: Token) -> float:
    """Return the friction of the object on its ground."""
    return float(thing["friction"] * thing.ground.friction)


def _turning(hand: Token, thing: Token) -> float:
    """Return the part of a push at the height of the axis that turns the object, negative if the hand stops it."""
    ratio, _, at_hand = _grip(hand, thing)
    return 1.0 - at_hand * (1.0 + ratio * thing.ground.friction) - DEFAULT_FRICTION * ratio


def _steadiness(hand: Token, thing: Token) -> float:
    """Return the friction minus the smallest friction with which a push at the height of the axis rolls the object."""
    ratio, friction, at_hand = _grip(hand, thing)
    turning = _turning(hand, thing)
    if _friction(thing) < _FRICTIONLESS:  # ROLLS states this reason, which is a law of physics.
        return 0.0
    # With a large friction, the hand stops the rotation, however hard it pushes.
    return min(friction - ratio * (1.0 + at_hand) / (1.0 - at_hand), turning) if at_hand < 1.0 else turning


def push_needed(hand: Token, thing: Token) -> float:
    """Return the force [N] of a hand that rolls an object steadily, or infinity if the hand stops the rotation."""
    _, _, at_hand = _grip(hand, thing)
    turning = _turning(hand, thing)
    ratio, weight = _ground(thing) / float(thing["radius_of_rotation"]), GRAVITY * float(thing["mass"])
    return weight * ratio * float(np.hypot(1.0, at_hand)) / turning if turning > 0.0 else float("inf")


def _strength(hand: Token, thing: Token) -> float:
    needed = push_needed(hand, thing)
    # If the hand stops the rotation, ROLLS_STEADILY states this reason, and strength is not to blame.
    return float(hand["maximal_force"]) - needed if np.isfinite(needed) else 0.0


def rolling_resistance(hand: Token, thing: Token) -> Resistance:
    """Return the resistance of a solid cylinder that rolls without slip. A sphere slows down a little faster.

    Friction at the hand brakes the rotation, so only a part of the push turns the object (see `_turning`).
    """
    share = max(_turning(hand, thing), _LEAST_TURNING)
    force = float(GRAVITY * thing["mass"] * _ground(thing) / thing["radius_of_rotation"])
    # The inertia is m + I / R^2.
    return Resistance(force / share, slowing(thing), 1.5 * thing["mass"] / share, thing["radius_of_rotation"])


def slowing(thing: Token) -> float:
    """Return the deceleration [m/s^2] of a solid cylinder that rolls alone. A sphere slows down a little faster."""
    return float(_ground(thing) * GRAVITY / (1.5 * thing["radius_of_rotation"]))


def usual_deceleration(thing: Token) -> float:
    """Return the default deceleration [m/s^2] of a hand, with which an object does not run away from the hand."""
    return float(np.clip(_RESERVE * slowing(thing), SMALLEST_DECELERATION, _USUAL_DECELERATION))


def _stopping(thing: Token) -> float:
    """Return the rolling friction [m] minus the rolling friction with which the object follows the slowest hand."""
    needed = SMALLEST_DECELERATION / _RESERVE * 1.5 * thing["radius_of_rotation"] / GRAVITY
    return float(_ground(thing) - needed)


def _width(thing: Token) -> float:
    """Return the width [m] of an object along its axis, minus the width of the strip on which a hand pushes."""
    along = np.asarray(thing["axis_of_rotation"])
    if isinstance(thing.shape, Cylinder):
        width = thing.shape.length
    elif isinstance(thing.shape, MeshShape):
        width = float(np.ptp(thing.shape.corners @ along))
    else:
        return float(thing["radius_of_rotation"])
    return float(width - 2.0 * _OFF_CENTRE)


def _overlap(state: State, hand: Token, thing: Token) -> FloatArray:
    """Return the largest height of a push on an object, minus the height [m] at which the hand can touch the object.

    A hand that cannot go lower touches a small object above its axis, where the normal of the contact is inclined.
    """
    half = height_below(state, hand)
    standing = hand["length"] / 2 * np.abs(z_axis(state, hand)[..., 2])
    radius = float(thing["radius_of_rotation"])
    lower_end = np.maximum(radius, half + FLOOR_CLEARANCE) - standing
    # The lower end of an upright hand is an edge. A level hand touches with its round side.
    round_part = np.maximum(half - standing, 0.0)
    return np.asarray(radius + _STEEPEST * (radius + round_part) - lower_end)


ROLLS = physical_bound(
    "rolls",
    (_OBJECT,),
    _least_friction,
    unit="1",
    scale=0.1,
    description="{object} has friction, so that forces can turn it",
    denial="{object} slides instead of rolling: without friction, no force turns it",
)
ROLLS_STEADILY = competence(
    "rolls_steadily",
    (_HAND, _OBJECT),
    _steadiness,
    unit="1",
    scale=0.1,
    description="{object} rolls without sliding when {hand} pushes it at the height of its axis",
    denial="{object} slides instead of rolling when {hand} pushes it at the height of its axis",
)
ABLE_TO_ROLL = competence(
    "able_to_roll",
    (_HAND, _OBJECT),
    _strength,
    unit="N",
    scale=10.0,
    description="{hand} is strong enough to roll {object} against its rolling resistance",
    denial="{hand} is too weak to roll {object} against its rolling resistance",
)
STOPS = competence(
    "stops",
    (_OBJECT,),
    _stopping,
    description="the rolling friction of {object} is large enough to stop it while a hand slows down behind it",
    denial="the rolling friction of {object} is too small to stop it while a hand slows down behind it",
)
WIDE_ENOUGH = competence(
    "wide_enough",
    (_OBJECT,),
    _width,
    description="{object} is wide enough along its axis for the push of a hand",
    denial="{object} is too thin along its axis: a push of a hand off its middle would turn it over",
)
TOUCHES_AXIS = competence(
    "touches_axis",
    (_HAND, _OBJECT),
    _overlap,
    reads={"hand": ("orientation",)},
    description="{hand} touches {object} close enough to the height of its axis",
    denial="{object} is too small for {hand}, which touches it too far above its axis",
)
ROLLABLE_FACTS = (ROLLS_STEADILY, ABLE_TO_ROLL, TOUCHES_AXIS, ROLLS, STOPS, WIDE_ENOUGH)
"""Feasibility facts of a roll that depend on the sizes and the material of the object."""
