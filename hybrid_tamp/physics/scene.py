"""Physical properties of tokens for simulators: shape, mass, inertia and friction."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.geometry.meshes import MeshShape
from hybrid_tamp.geometry.shapes import Compound, Cylinder, Shape, Solid, Sphere
from hybrid_tamp.model.affordance import BODY_STATE
from hybrid_tamp.model.grasp import APERTURE, GRIP
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.constants import DEFAULT_FRICTION, DEFAULT_MASS
from hybrid_tamp.motion.poses import quaternion_from_rpy, rotate

FORCE = "force"
"""Name of the basic action that applies a force at a body's centre, in the world frame [N]."""
TORQUE = "torque"
"""Name of the basic action that applies a torque to a body, in the world frame [N m]."""

ROLLING_FRICTION = 0.005
"""Default rolling friction of a round body [m]. With zero rolling friction, the body would never stop."""

_ACTIONS = {FORCE: 3, TORQUE: 3, GRIP: 1}
# Maps each basic action to the fixed and the varying properties that its simulation requires.
_NEEDS = {FORCE: ((), ()), TORQUE: (("wrist_inertia",), ()), GRIP: (("maximal_aperture",), (APERTURE,))}


@dataclass(frozen=True)
class Body:
    """Physical properties of a simulated token.

    Attributes:
        token: name of the token.
        shape: geometry of the body.
        mass: mass of the body [kg]; zero means that the body is fixed in the world.
        inertia: principal moments of inertia about the body axes [kg m^2]; zero means infinite inertia.
        friction: Coulomb friction coefficient.
        rolling_friction: rolling friction, as torque per normal force [m].
        driven: whether the robot commands the force on the body. The weight of a driven body is compensated.
    """

    token: str
    shape: Shape
    mass: float
    inertia: tuple[float, float, float]
    friction: float
    rolling_friction: float
    driven: bool


def make_bodies(task: Task) -> tuple[Body, ...]:
    """Make a body for every token that is not a place, and for every place with a shape.

    Raises:
        InputError: a token lacks a shape or a property that its simulation requires, or has an unknown basic action.
    """
    simulated = [token for token in task.tokens if token.fixed_body or not token.place]
    issues = [issue for token in simulated for issue in _find_faults(token)]
    if issues:
        raise InputError(issues)
    return tuple(map(_make_body, simulated))


def _find_faults(token: Token) -> list[Issue]:
    where = f"token {token.name}"
    found = []
    if token.shape is None:
        found.append(Issue(where, "a simulated token must have a shape", remedy="add a shape, e.g. a cylinder"))
    missing = [varying.name for varying in BODY_STATE if varying not in token.varying]
    if missing:
        found.append(Issue(where, f"a simulated token must have the varying properties {', '.join(missing)}"))
    return found + _find_action_faults(token, where)


def _find_action_faults(token: Token, where: str) -> list[Issue]:
    known = tuple(f"{name} of size {size}" for name, size in _ACTIONS.items())
    varying = {varying.name for varying in token.varying}
    found = []
    for action in token.basic_actions:
        if _ACTIONS.get(action.name) != action.size:
            said = f"{action.name} of size {action.size}"
            found.append(Issue(where, "expected a basic action that can be simulated", said, known))
            continue
        fixed, changing = _NEEDS[action.name]
        missing = [name for name in fixed if name not in token.properties]
        if missing:
            found.append(Issue(where, f"the basic action {action.name} requires the property {', '.join(missing)}"))
        if not varying.issuperset(changing):
            wanted = f"the basic action {action.name} requires the varying property {', '.join(changing)}"
            found.append(Issue(where, wanted))
    names = {action.name for action in token.basic_actions}
    if GRIP in names and TORQUE not in names:
        # Without this action, the wrist would keep its orientation with an unlimited torque.
        found.append(
            Issue(where, f"a token with the basic action {GRIP} must have the basic action {TORQUE} of size 3")
        )
    for action in token.basic_actions:
        if GRIP in names and action.name in (GRIP, TORQUE) and action.limit is None:
            found.append(Issue(where, f"the basic action {action.name} of a hand that grips must have a limit"))
    if token.basic_actions and all(action.name != FORCE for action in token.basic_actions):
        found.append(Issue(where, f"a token with basic actions must have the basic action {FORCE} of size 3"))
    return found


def _make_body(token: Token) -> Body:
    driven = bool(token.basic_actions)
    mass = 0.0 if token.fixed_body else _number(token, "mass", DEFAULT_MASS)
    round_thing = not driven and isinstance(token.solid, Cylinder | Sphere)
    return Body(
        token=token.name,
        shape=token.solid,
        mass=mass,
        inertia=_find_inertia(token, mass),
        friction=_number(token, "friction", DEFAULT_FRICTION),
        rolling_friction=_number(token, "rolling_friction", ROLLING_FRICTION if round_thing else 0.0),
        driven=driven,
    )


def _find_inertia(token: Token, mass: float) -> tuple[float, float, float]:
    if any(action.name == TORQUE for action in token.basic_actions):
        moment = _number(token, "wrist_inertia", 0.0)
        return (moment, moment, moment)
    if token.fixed_body:
        return (0.0, 0.0, 0.0)
    if token.basic_actions:
        # The simulation has no arm, so the hand gets infinite inertia to keep its orientation.
        return (0.0, 0.0, 0.0)
    given: Any = token.properties.get("inertia")
    return compute_inertia(token.solid, mass) if given is None else (float(given[0]), float(given[1]), float(given[2]))


def _number(token: Token, name: str, default: float) -> float:
    value: Any = token.properties.get(name, default)
    return float(value)


def compute_inertia(shape: Shape, mass: float) -> tuple[float, float, float]:
    """Return the principal moments of inertia of a solid body [kg m^2].

    The mass of a compound is distributed evenly over the volume of its parts. The frame of a compound is assumed to be
    at its centre of mass and aligned with its principal axes.
    """
    if isinstance(shape, MeshShape):
        x, y, z = (mass * moment for moment in shape.moments)
        return (x, y, z)
    if not isinstance(shape, Compound):
        return _moments(shape, mass)
    volumes = np.array([_volume(part) for part in shape.parts])
    total = np.zeros(3)
    for part, share in zip(shape.parts, mass * volumes / volumes.sum(), strict=True):
        axes = rotate(quaternion_from_rpy(part.rpy), np.eye(3))
        offset = np.square(part.position)
        # The inertia of the part in the body's axes, plus the term of the parallel-axis theorem.
        total += np.square(axes).T @ _moments(part, share) + share * (offset.sum() - offset)
    return (float(total[0]), float(total[1]), float(total[2]))


def _moments(shape: Solid, mass: float) -> tuple[float, float, float]:
    if isinstance(shape, Sphere):
        moment = 2 / 5 * mass * shape.radius**2
        return (moment, moment, moment)
    if isinstance(shape, Cylinder):
        across = mass * (3 * shape.radius**2 + shape.length**2) / 12
        return (across, across, mass * shape.radius**2 / 2)
    x, y, z = (mass * half**2 / 3 for half in shape.half_extents)
    return (y + z, x + z, x + y)


def _volume(shape: Solid) -> float:
    """Return the volume of a solid [m^3]."""
    if isinstance(shape, Sphere):
        return float(4 / 3 * np.pi * shape.radius**3)
    if isinstance(shape, Cylinder):
        return float(np.pi * shape.radius**2 * shape.length)
    return float(8 * np.prod(shape.half_extents))
