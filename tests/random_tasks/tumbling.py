"""Random tasks of tumbling, and a push with which one hand topples a box without control."""

from typing import Any

import numpy as np
from hybrid_tamp_domains.rolling_tumbling import DOMAIN
from hybrid_tamp_domains.rolling_tumbling.classes import Tumblable
from hybrid_tamp_domains.rolling_tumbling.faces import flat
from hybrid_tamp_domains.rolling_tumbling.metrics import tumble_measures
from hybrid_tamp_domains.rolling_tumbling.tumbling_geometry import (
    balance,
    edge_axis,
    edge_position,
    half_extent,
    normal,
    tilt,
)
from numpy.typing import ArrayLike

from hybrid_tamp.model.control import CONTROL_PERIOD, Commands
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_from_axis_angle, quaternion_from_rpy, rotate
from hybrid_tamp.physics.protocol import Backend
from hybrid_tamp.skills import STIFFNESS, StaticEndEffector, damping
from random_tasks.corners import Corner

Draws = np.random.Generator | Corner
HANDS = ((-0.5, 0.0, 0.55), (0.5, 0.0, 0.55), (-0.5, 0.0, 0.1), (0.6, 0.0, 0.8))
"""Initial positions of the hands [m]. Each hand starts on its side of the box, and outside the paths of other hands."""
HAND: dict[str, Any] = {
    "radius": 0.035,
    "length": 0.16,
    "mass": 1.5,
    "maximal_force": 300.0,
    "workspace_lower": (-3.0, -3.0, 0.0),
    "workspace_upper": (3.0, 3.0, 1.5),
}
"""Properties of each hand."""
_ROW = 1.0
_PUSH_HEIGHT = 0.9
"""Height of the forced push, as a share of the box's height."""
_PUSH_GAP = 0.005
_PUSH_RATE = 0.05
"""Rate at which the lead of the hand over the box grows [rad/s]."""
_PUSH_LEAD = 0.3
"""Largest lead of the hand over the box [rad]."""
_PUSH_BRAKE = 3.0
"""Factor by which the damping of the hand is larger than usual, so that the hand does not throw the box."""


def random_box(rng: Draws, name: str) -> Token:
    """Return a box: x U(0.22, 0.38) m, y U(0.2, 0.35) m, z U(0.75, 1.6) x, U(8, 20) kg, friction U(0.4, 0.9)."""
    length = rng.uniform(0.22, 0.38)
    edges = (length, rng.uniform(0.2, 0.35), length * rng.uniform(0.75, 1.6))
    properties = {
        "half_extents": tuple(float(edge / 2) for edge in edges),
        "mass": float(rng.uniform(8.0, 20.0)),
        "friction": float(rng.uniform(0.4, 0.9)),
    }
    return Token.make(name, [Tumblable], properties)


def random_tumbling(seed: int, hands: int = 2, boxes: int = 1, onto: str = "right", rng: Draws | None = None) -> Task:
    """Return a task in which hands tumble boxes onto a face. The boxes are 1 m apart, displaced by 3 cm and 3 degrees.

    Args:
        seed: seed of all random numbers.
        hands: number of hands. If there are several boxes, each box has two hands.
        boxes: number of boxes.
        onto: face on which each box must lie in the end.
        rng: draws the sizes and places; by default the generator of the seed.
    """
    rng = rng or np.random.default_rng(seed)
    things = [random_box(rng, f"box {number + 1}") for number in range(boxes)]
    given: dict[tuple[str, str], ArrayLike] = {}
    for row, thing in enumerate(things):
        x, y = rng.uniform(-0.03, 0.03, 2)
        yaw = np.radians(rng.uniform(-3.0, 3.0))
        given[thing.name, "position"] = (x, y + row * _ROW, half_extent(thing, "bottom"))
        given[thing.name, "orientation"] = quaternion_from_rpy(np.array([0.0, 0.0, yaw]))
    ends = [_hand(number) for number in range(hands)]
    for number, end in enumerate(ends):
        row, place = (number // 2, number % 2) if boxes > 1 else (0, number)
        x, y, z = HANDS[place]
        given[end.name, "position"] = (x, y + row * _ROW, z)
        given[end.name, "orientation"] = quaternion_from_rpy(np.array([np.pi / 2, 0.0, 0.0]))
    tokens = (*ends, *things)
    goal = tuple(Atom("posture", (thing.name, flat(onto))) for thing in things)
    objective = "makespan" if boxes > 1 else "length"  # for several boxes at once
    return Task(f"tumble_{seed}", DOMAIN, tokens, State.of(tokens, given), goal, seed=seed, objective=objective)


def _hand(number: int) -> Token:
    return Token.make(f"hand {number + 1}", [StaticEndEffector], HAND)


def forced_push(task: Task, backend: Backend, seconds: float = 12.0) -> dict[str, float]:
    """Push a box over with the first hand of the task, without a plan, and return measures of the box's fall.

    The hand starts high up at the left face, and pushes along the arc on which the box turns about its right edge. The
    friction of the hand then lifts the box. After the balance point, nothing holds the box, so the box drops onto its
    right face. A low box on a smooth floor slides instead.
    """
    hand, thing = task.tokens[0], next(token for token in task.tokens if token.is_member(Tumblable))
    normal_before = normal(task.state, thing, "left")
    side = half_extent(thing, "left") + hand["radius"] + _PUSH_GAP
    height = (2.0 * _PUSH_HEIGHT - 1.0) * half_extent(thing, "top")
    start = task.state[thing, "position"] + normal_before * side + np.array([0.0, 0.0, height])
    state = backend.reset(task, task.state.replace({(hand.name, "position"): start}))
    arm = start - edge_position(state, thing, "bottom", "right")
    rows = [state.values]
    for step in range(round(seconds / CONTROL_PERIOD)):
        state = backend.step(_push(hand, thing, state, arm, step * CONTROL_PERIOD))
        rows.append(state.values)
    run = State(task.state.layout, np.array(rows))
    return dict(tumble_measures(run, thing, "bottom", "right", CONTROL_PERIOD))


def _push(hand: Token, thing: Token, state: State, arm: FloatArray, elapsed: float) -> Commands:
    """Return the force that moves the hand along the arc ahead of the box, up to the balance point."""
    angle = tilt(state, thing, "bottom", "right")
    force = -damping(hand["mass"]) * state[hand, "velocity"]
    if float(angle) < balance(thing, "bottom", "right"):
        lead = min(_PUSH_LEAD, _PUSH_RATE * elapsed)
        turn = quaternion_from_axis_angle(edge_axis(state, thing, "bottom", "right"), angle + lead)
        place = edge_position(state, thing, "bottom", "right") + rotate(turn, arm)
        force = STIFFNESS * (place - state[hand, "position"]) + _PUSH_BRAKE * force
    norm = float(np.linalg.norm(force))
    return {(hand.name, "force"): force * min(1.0, hand["maximal_force"] / max(norm, 1e-9))}
