"""The physical properties of each token, for any simulator: body, mass, inertia, friction."""

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
from hybrid_tamp.motion.poses import quaternion_from_rpy, rotate

FORCE = "force"
"""The basic action that moves a body: a force on its centre in the world frame [N]."""
TORQUE = "torque"
"""The basic action that turns a body: a torque in the world frame [N m]."""

MASS = 1.0
"""Mass of a token without that property [kg]."""
FRICTION = 0.5
"""Friction coefficient of a token without that property; Bullet multiplies those of two bodies in contact."""
ROLLING_FRICTION = 0.005
"""Rolling friction of a round thing without that property [m]; with zero it would never stop."""
FLOOR_FRICTION = 1.0

_ACTIONS = {FORCE: 3, TORQUE: 3, GRIP: 1}
# What an action needs to be simulated: fixed properties and varying ones.
_NEEDS = {FORCE: ((), ()), TORQUE: (("wrist_inertia",), ()), GRIP: (("maximal_aperture",), (APERTURE,))}


@dataclass(frozen=True)
class Body:
    """One simulated token.

    Attributes:
        token: its name.
        shape: its geometry.
        mass: [kg].
        inertia: principal moments about the body axes [kg m^2]; zero stands for infinite.
        friction: Coulomb friction coefficient.
        rolling_friction: torque per normal force [m].
        driven: whether the robot commands a force on it; its weight is then compensated.
    """

    token: str
    shape: Shape
    mass: float
    inertia: tuple[float, float, float]
    friction: float
    rolling_friction: float
    driven: bool


def bodies(task: Task) -> tuple[Body, ...]:
    """Return a body for every token that is not a place.

    Raises:
        InputError: a token has no shape or no body state, or is moved by something that physics does not know.
    """
    issues = [issue for token in task.assigned for issue in _faults(token)]
    if issues:
        raise InputError(issues)
    return tuple(_body(token) for token in task.assigned)


def _faults(token: Token) -> list[Issue]:
    where = f"token {token.name}"
    found = []
    if token.shape is None:
        found.append(Issue(where, "a shape, to be simulated", remedy="give it a shape, e.g. a cylinder"))
    missing = [varying.name for varying in BODY_STATE if varying not in token.varying]
    if missing:
        found.append(Issue(where, f"the varying properties {', '.join(missing)}, to be simulated"))
    return found + _action_faults(token, where)


def _action_faults(token: Token, where: str) -> list[Issue]:
    known = tuple(f"{name} of size {size}" for name, size in _ACTIONS.items())
    varying = {varying.name for varying in token.varying}
    found = []
    for action in token.basic_actions:
        if _ACTIONS.get(action.name) != action.size:
            said = f"{action.name} of size {action.size}"
            found.append(Issue(where, "a basic action that physics knows", said, known))
            continue
        fixed, changing = _NEEDS[action.name]
        missing = [name for name in fixed if name not in token.properties]
        if missing:
            found.append(Issue(where, f"the property {', '.join(missing)}, to be moved by {action.name}"))
        if not varying.issuperset(changing):
            found.append(Issue(where, f"the varying property {', '.join(changing)}, to be moved by {action.name}"))
    if token.basic_actions and all(action.name != FORCE for action in token.basic_actions):
        found.append(Issue(where, f"the basic action {FORCE} of size 3, to be moved by the robot"))
    return found


def _body(token: Token) -> Body:
    assert token.shape is not None, "refused before"
    driven = bool(token.basic_actions)
    mass = _number(token, "mass", MASS)
    round_thing = not driven and isinstance(token.shape, Cylinder | Sphere)
    return Body(
        token=token.name,
        shape=token.shape,
        mass=mass,
        inertia=_inertia(token, mass),
        friction=_number(token, "friction", FRICTION),
        rolling_friction=_number(token, "rolling_friction", ROLLING_FRICTION if round_thing else 0.0),
        driven=driven,
    )


def _inertia(token: Token, mass: float) -> tuple[float, float, float]:
    if any(action.name == TORQUE for action in token.basic_actions):
        moment = _number(token, "wrist_inertia", 0.0)
        return (moment, moment, moment)
    if token.basic_actions:
        # The arm that a hand belongs to is not simulated, but it keeps the hand's orientation.
        return (0.0, 0.0, 0.0)
    assert token.shape is not None, "refused before"
    given: Any = token.properties.get("inertia")
    return inertia(token.shape, mass) if given is None else (float(given[0]), float(given[1]), float(given[2]))


def _number(token: Token, name: str, default: float) -> float:
    value: Any = token.properties.get(name, default)
    return float(value)


def inertia(shape: Shape, mass: float) -> tuple[float, float, float]:
    """Return the moments of a solid body about the axes of its frame [kg m^2].

    A compound's mass is spread evenly over the volume of its parts, and its frame's origin is taken for its centre of
    mass. Of its inertia only the moments are returned: its axes are taken for the principal ones.
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
        # A part's own tensor seen along the body's axes, and Steiner's parallel axes.
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
    """Return the volume [m^3]."""
    if isinstance(shape, Sphere):
        return float(4 / 3 * np.pi * shape.radius**3)
    if isinstance(shape, Cylinder):
        return float(np.pi * shape.radius**2 * shape.length)
    return float(8 * np.prod(shape.half_extents))
