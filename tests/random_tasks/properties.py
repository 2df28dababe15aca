"""Random tasks whose properties are drawn over wide ranges, most of them far outside what hands can manipulate.

Sizes are log-uniform from 2 mm to 1 m, masses from 0.1 g to 100 kg, and the maximal force of a hand from 10 to 1000 N.
Friction is uniform from 0 to 1, and the rolling friction is log-uniform from 0.01 to 50 mm. All else scales with the
sizes: hands start beside the object and clear of it, and workspaces are large. So the drawn properties alone decide
whether a task can be carried out.
"""

from collections.abc import Callable, Mapping

import numpy as np
from hybrid_tamp_domains.joint_lifting import DOMAIN as LIFTING
from hybrid_tamp_domains.joint_lifting.classes import Liftable
from hybrid_tamp_domains.rolling_tumbling import DOMAIN as ROLLING
from hybrid_tamp_domains.rolling_tumbling.classes import Rollable, Tumblable
from numpy.typing import ArrayLike

from hybrid_tamp.geometry.shapes import Cylinder, Sphere
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.facts import margins
from hybrid_tamp.model.predicate import Atom, Kind
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Limits, MidLevel, Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.poses import quaternion_from_rpy
from hybrid_tamp.skills import Region, StaticEndEffector

SIZES = (0.002, 1.0)
"""Range of all radii and edge lengths [m]."""
MASSES = (1e-4, 100.0)
FORCES = (10.0, 1000.0)
"""Range of the maximal force of a hand [N]."""
ROLLING_FRICTIONS = (1e-5, 0.05)
"""Range of the rolling friction [m]."""
_HAND = 0.035
_QUICK = MidLevel(evaluations=60)
_LIMITS = Limits(time=60.0, refinements=2)

Given = dict[tuple[str, str], ArrayLike]


def random_properties(seed: int) -> Task:
    """Return a task of the kinds in turn: roll a drum, roll a sphere, tumble or lift a box with two hands."""
    name = kind_of(seed)
    return KINDS[name](f"properties_{seed}_{name}", seed, np.random.default_rng(seed))


def kind_of(seed: int) -> str:
    """Return the kind of the task of a seed."""
    return list(KINDS)[seed % len(KINDS)]


def find_failing_facts(task: Task) -> tuple[str, ...]:
    """Return the names of the feasibility predicates that hold for no binding in the initial state."""
    static = [each for each in task.domain.predicates if each.kind is Kind.STATIC and each.rows is None]
    found = {each.name: [margin for _, margin in margins(task, task.state, each)] for each in static}
    return tuple(name for name, values in found.items() if values and max(values) < 0)


def draw_body(rng: np.random.Generator) -> dict[str, float]:
    """Return the mass and the friction of a body."""
    return {"mass": _wide(rng, MASSES), "friction": float(rng.uniform(0.0, 1.0))}


def _wide(rng: np.random.Generator, bounds: tuple[float, float]) -> float:
    """Draw a log-uniform number."""
    return float(np.exp(rng.uniform(*np.log(bounds))))


def _hand(name: str, force: float) -> Token:
    properties = {
        "radius": _HAND,
        "length": 0.16,
        "mass": 1.5,
        "maximal_force": force,
        "workspace_lower": (-6.0, -6.0, 0.0),
        "workspace_upper": (6.0, 6.0, 4.0),
    }
    return Token.make(name, [StaticEndEffector], properties)


def _roll(shape: str, name: str, seed: int, rng: np.random.Generator) -> Task:
    radius, length = _wide(rng, SIZES), _wide(rng, SIZES)
    own = draw_body(rng) | {
        "axis_of_rotation": (0.0, 0.0, 1.0),
        "radius_of_rotation": radius,
        "rolling_friction": _wide(rng, ROLLING_FRICTIONS),
    }
    drum = Cylinder(kind="cylinder", radius=radius, length=length)
    ball = Sphere(kind="sphere", radius=radius)
    thing = Token.make("thing", [Rollable], own, drum if shape == "drum" else ball)
    hand = _hand("hand", _wide(rng, FORCES))
    goal = Token.make("goal", [Region], {"radius": 0.02})
    yaw, side = rng.uniform(-np.pi, np.pi), rng.uniform(-1.0, 1.0)
    # A hand starts behind the object, because a reach that passes over a large object would hit it.
    back = (2.0 * radius + rng.uniform(0.3, 0.6)) * np.array([-np.cos(yaw + side), -np.sin(yaw + side)])
    distance = rng.uniform(0.3, 1.0)
    given: Given = {
        ("hand", "position"): (*back, rng.uniform(0.15, 0.5)),
        ("thing", "position"): (0.0, 0.0, radius),
        ("thing", "orientation"): quaternion_from_rpy(np.array([np.pi / 2, 0.0, yaw])),
        ("goal", "position"): (distance * np.cos(yaw), distance * np.sin(yaw), 0.0),
    }
    return _task(name, seed, ROLLING, (hand, thing, goal), given, Atom("inside", ("thing", "goal")))


def _tumble(name: str, seed: int, rng: np.random.Generator) -> Task:
    # A box that is too slender is refused, whatever its size. Half of the boxes have moderate ratios.
    edges = _edges(rng, 0.65, 1.55)
    box = Token.make("box", [Tumblable], draw_body(rng) | {"half_extents": tuple(edge / 2.0 for edge in edges)})
    force, level = _wide(rng, FORCES), quaternion_from_rpy(np.array([np.pi / 2, 0.0, 0.0]))
    hands = [_hand(f"hand {number}", force) for number in (1, 2)]
    given: Given = {("box", "position"): (0.0, 0.0, edges[2] / 2.0)}
    for hand, side in zip(hands, (-1.0, 1.0), strict=True):
        away = side * (edges[0] / 2.0 + edges[2] + rng.uniform(0.2, 0.4))
        given |= {(hand.name, "position"): (away, 0.0, edges[2] + 0.2), (hand.name, "orientation"): level}
    return _task(name, seed, ROLLING, (*hands, box), given, Atom("posture", ("box", "flat right")))


def _lift(name: str, seed: int, rng: np.random.Generator) -> Task:
    edges = _edges(rng, 0.3, 3.0)
    box = Token.make("box", [Liftable], draw_body(rng) | {"half_extents": tuple(edge / 2.0 for edge in edges)})
    force = _wide(rng, FORCES)
    hands = [_hand(f"hand {number}", force) for number in (1, 2)]
    given: Given = {("box", "position"): (0.0, 0.0, edges[2] / 2.0)}
    for hand, side in zip(hands, (-1.0, 1.0), strict=True):
        away = side * (edges[0] / 2.0 + rng.uniform(0.2, 0.4))
        given[hand.name, "position"] = (away, rng.uniform(-0.05, 0.05), edges[2] / 2.0 + 0.2)
    return _task(name, seed, LIFTING, (*hands, box), given, Atom("raised", ("box",)))


def _edges(rng: np.random.Generator, least: float, most: float) -> tuple[float, float, float]:
    """Return edges of a box [m]: each drawn by itself, or in two of three tasks with ratios in a range."""
    if rng.random() < 1 / 3:
        return _wide(rng, SIZES), _wide(rng, SIZES), _wide(rng, SIZES)
    edge = _wide(rng, SIZES)
    other, height = (float(np.clip(edge * _wide(rng, (least, most)), *SIZES)) for _ in range(2))
    return edge, other, height


def _task(name: str, seed: int, domain: Domain, tokens: tuple[Token, ...], given: Given, goal: Atom) -> Task:
    state = State.of(tokens, given)
    return Task(name, domain, tokens, state, (goal,), seed=seed, midlevel=_QUICK, limits=_LIMITS)


KINDS: Mapping[str, Callable[[str, int, np.random.Generator], Task]] = {
    "drum": lambda *given: _roll("drum", *given),
    "sphere": lambda *given: _roll("sphere", *given),
    "tumble": _tumble,
    "lift": _lift,
}
"""Maps each kind of task to the function that makes it."""
