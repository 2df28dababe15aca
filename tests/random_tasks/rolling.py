"""Random tasks of rolling, for trials."""

import numpy as np
from hybrid_tamp_domains.rolling_tumbling import DOMAIN
from hybrid_tamp_domains.rolling_tumbling.classes import Rollable

from hybrid_tamp.geometry.shapes import Cylinder
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.poses import quaternion_from_rpy
from hybrid_tamp.skills import Region, StaticEndEffector
from random_tasks.corners import Corner


def random_rolling(seed: int, rng: np.random.Generator | Corner | None = None) -> Task:
    """Return a task in which one hand rolls a random cylinder to a region.

    Radius U(0.06, 0.15) m, length U(0.2, 0.4) m, mass U(2, 12) kg, friction U(0.4, 0.9), distance U(0.3, 1.0) m, any
    heading. The hand starts anywhere around the cylinder, 0.3 to 0.6 m from its surface.
    """
    rng = rng or np.random.default_rng(seed)
    radius, length = rng.uniform(0.06, 0.15), rng.uniform(0.2, 0.4)
    mass, friction, distance = rng.uniform(2.0, 12.0), rng.uniform(0.4, 0.9), rng.uniform(0.3, 1.0)
    yaw, side, away = rng.uniform(-np.pi, np.pi), rng.uniform(-np.pi, np.pi), rng.uniform(0.3, 0.6)
    hand = Token.make(
        "hand",
        [StaticEndEffector],
        {
            "radius": 0.035,
            "length": 0.16,
            "mass": 1.5,
            "maximal_force": 300.0,
            "workspace_lower": (-2.0, -2.0, 0.0),
            "workspace_upper": (2.0, 2.0, 1.2),
        },
    )
    cylinder = Token.make(
        "cylinder",
        [Rollable],
        {
            "axis_of_rotation": (0.0, 0.0, 1.0),
            "radius_of_rotation": float(radius),
            "mass": float(mass),
            "friction": float(friction),
        },
        Cylinder(kind="cylinder", radius=float(radius), length=float(length)),
    )
    goal = Token.make("goal", [Region], {"radius": 0.02})
    tokens = (hand, cylinder, goal)
    start = (radius + length / 2 + away) * np.array([np.cos(side), np.sin(side)])
    state = State.of(
        tokens,
        {
            ("hand", "position"): (start[0], start[1], rng.uniform(0.15, 0.5)),
            ("cylinder", "position"): (0.0, 0.0, radius),
            ("cylinder", "orientation"): quaternion_from_rpy(np.array([np.pi / 2, 0.0, yaw])),
            ("goal", "position"): (distance * np.cos(yaw), distance * np.sin(yaw), 0.0),
        },
    )
    return Task(f"roll_{seed}", DOMAIN, tokens, state, (Atom("inside", ("cylinder", "goal")),), seed=seed)
