"""What physics needs to know of each token: body, mass, inertia, friction. No simulator in here."""

from dataclasses import dataclass
from typing import Any

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.affordance import BODY_STATE
from hybrid_tamp.model.shape import Box, Cylinder, Sphere
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token

FORCE = "force"
"""The basic action that moves a body: a force on its centre in the world frame [N]."""

MASS = 1.0
"""Mass of a token without that property [kg]."""
FRICTION = 0.5
"""Friction coefficient of a token without that property; Bullet multiplies those of two bodies in contact."""
ROLLING_FRICTION = 0.005
"""Rolling friction of a round thing without that property [m]; without any it would never stop."""
FLOOR_FRICTION = 1.0


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
    shape: Cylinder | Box | Sphere
    mass: float
    inertia: tuple[float, float, float]
    friction: float
    rolling_friction: float
    driven: bool


def bodies(task: Task) -> tuple[Body, ...]:
    """Return a body for every token that is not a place.

    Raises:
        InputError: a token has no shape or no body state, or is moved by something else than a force.
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
    for action in token.basic_actions:
        if (action.name, action.size) != (FORCE, 3):
            said = f"{action.name} of size {action.size}"
            found.append(Issue(where, "a basic action that physics knows", said, (f"{FORCE} of size 3",)))
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
        # The arm that a hand belongs to is not simulated, but it keeps the hand's orientation.
        inertia=(0.0, 0.0, 0.0) if driven else inertia(token.shape, mass),
        friction=_number(token, "friction", FRICTION),
        rolling_friction=_number(token, "rolling_friction", ROLLING_FRICTION if round_thing else 0.0),
        driven=driven,
    )


def _number(token: Token, name: str, default: float) -> float:
    value: Any = token.properties.get(name, default)
    return float(value)


def inertia(shape: Cylinder | Box | Sphere, mass: float) -> tuple[float, float, float]:
    """Return the principal moments of a solid body about its axes [kg m^2]."""
    if isinstance(shape, Sphere):
        moment = 2 / 5 * mass * shape.radius**2
        return (moment, moment, moment)
    if isinstance(shape, Cylinder):
        across = mass * (3 * shape.radius**2 + shape.length**2) / 12
        return (across, across, mass * shape.radius**2 / 2)
    x, y, z = (mass * half**2 / 3 for half in shape.half_extents)
    return (y + z, x + z, x + y)
