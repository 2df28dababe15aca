"""Random tasks of tumbling and lifting in which the box has any yaw, and the hands start anywhere around the box."""

import numpy as np
from hybrid_tamp_domains.rolling_tumbling import DOMAIN
from hybrid_tamp_domains.rolling_tumbling.classes import Tumblable
from hybrid_tamp_domains.rolling_tumbling.faces import flat
from hybrid_tamp_domains.rolling_tumbling.tumbling_geometry import half_extent
from numpy.typing import ArrayLike

from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_conjugate, quaternion_from_rpy, rotate
from hybrid_tamp.skills import HORIZONTAL, NORMALS, StaticEndEffector, TurningEndEffector
from random_tasks.lifting import random_lifting
from random_tasks.tumbling import HAND, HANDS, random_box

YAWS = 72
"""Number of yaws. The yaws of two successive seeds differ by 5 degrees."""
_REACH = 0.8
"""Largest initial distance [m] of a hand from the middle of the box's lowest face."""
_APART = 0.2
"""Smallest initial distance [m] between the centres of two hands."""
_CLEAR = 0.005
"""Smallest initial gap [m] between a hand and the box or the floor."""
BOX = {"half_extents": (0.15, 0.14, 0.18), "mass": 14.0, "friction": 0.6}
"""Properties of the box of hands that cannot turn."""
_WRIST = {"maximal_torque": 5.0, "wrist_inertia": 0.02}


def yaw_of(seed: int) -> float:
    """Return the yaw of the box [rad], in steps of 5 degrees."""
    return float(np.radians(360.0 / YAWS * (seed % YAWS)))


def random_turned(seed: int) -> Task:
    """Return a task in which two hands that can turn tumble a box with the yaw of the seed onto its right face.

    The hands start anywhere within 0.8 m, in any orientation, clear of the box and of each other. For odd seeds, both
    hands start on the same side: the left one or the right one.
    """
    rng = np.random.default_rng(seed)
    thing = random_box(rng, "box 1")
    centre = np.array([*rng.uniform(-0.03, 0.03, 2), half_extent(thing, "bottom")])
    turn = quaternion_from_rpy(np.array([0.0, 0.0, yaw_of(seed)]))
    side = float(rng.choice([-1.0, 1.0])) if seed % 2 else 0.0
    hands = [Token.make(f"hand {number}", [TurningEndEffector], HAND | _WRIST) for number in (1, 2)]
    given: dict[tuple[str, str], ArrayLike] = {(thing.name, "position"): centre, (thing.name, "orientation"): turn}
    taken: list[FloatArray] = []
    for hand in hands:
        place, orientation = _draw_start(rng, thing, centre, turn, side, taken, upright=False)
        given[hand.name, "position"], given[hand.name, "orientation"] = place, orientation
        taken.append(place)
    return _make_task(f"turned_{seed}", seed, (*hands, thing), given, "right")


def random_lift_around(seed: int, hands: int = 2, upright: bool = True) -> Task:
    """Return a task of lifting in which the box has any yaw, and the hands start anywhere within 0.8 m.

    The hands start clear of the box and of each other, beside the box or above it. For odd seeds, all hands start on
    the same side.

    Args:
        seed: seed of the task.
        hands: number of hands, two or four.
        upright: whether the hands are upright and cannot turn. Otherwise, they start in any orientation and can turn.
    """
    task, rng = random_lifting(seed, hands), np.random.default_rng([seed, 5])
    thing = task.token_by_name["box"]
    centre, turn = task.state[thing, "position"], quaternion_from_rpy(np.array([0.0, 0.0, rng.uniform(-np.pi, np.pi)]))
    side = float(rng.choice([-1.0, 1.0])) if seed % 2 else 0.0
    changes: dict[tuple[str, str], ArrayLike] = {(thing.name, "orientation"): turn}
    taken: list[FloatArray] = []
    ends = [token for token in task.tokens if token is not thing]
    for end in ends:
        place, orientation = _draw_start(rng, thing, centre, turn, side, taken, upright)
        changes[end.name, "position"], changes[end.name, "orientation"] = place, orientation
        taken.append(place)
    name, state = f"lift_{'around' if upright else 'any'}_{seed}", task.state.replace(changes)
    if upright:
        return task.replaced(name=name, state=state)
    able = (Token.make(end.name, [TurningEndEffector], {**end.properties, **_WRIST}) for end in ends)
    tokens = (*able, thing)
    given = {(each.name, key): state[each.name, key] for each in tokens for key in ("position", "orientation")}
    return task.replaced(name=name, tokens=tokens, state=State.of(tokens, given))


def stiff_turned(seed: int) -> Task:
    """Return the task of a box with the yaw of the seed and of two hands that cannot turn.

    The hands lie along y and start on both sides of the box, in x. The box must end on the face that looks nearest to
    the x direction at the start.
    """
    thing = Token.make("box 1", [Tumblable], BOX)
    turn = quaternion_from_rpy(np.array([0.0, 0.0, yaw_of(seed)]))
    hands = [Token.make(f"hand {number}", [StaticEndEffector], HAND) for number in (1, 2)]
    given: dict[tuple[str, str], ArrayLike] = {
        (thing.name, "position"): (0.0, 0.0, half_extent(thing, "bottom")),
        (thing.name, "orientation"): turn,
    }
    for hand, place in zip(hands, HANDS, strict=False):
        given[hand.name, "position"] = place
        given[hand.name, "orientation"] = quaternion_from_rpy(np.array([np.pi / 2, 0.0, 0.0]))
    onto = max(NORMALS, key=lambda face: float(rotate(turn, NORMALS[face])[0]))
    return _make_task(f"stiff_{seed}", seed, (*hands, thing), given, onto)


def _make_task(
    name: str, seed: int, tokens: tuple[Token, ...], given: dict[tuple[str, str], ArrayLike], onto: str
) -> Task:
    goal = (Atom("posture", (tokens[-1].name, flat(onto))),)
    return Task(name, DOMAIN, tokens, State.of(tokens, given), goal, seed=seed)


def _draw_start(
    rng: np.random.Generator,
    thing: Token,
    centre: FloatArray,
    turn: FloatArray,
    side: float,
    taken: list[FloatArray],
    upright: bool,
) -> tuple[FloatArray, FloatArray]:
    """Return the position ``(3,)`` [m] and orientation ``(4,)`` of a hand that touches nothing.

    Args:
        rng: draws the start.
        thing: the box.
        centre: position of the box ``(3,)`` [m].
        turn: orientation of the box ``(4,)``.
        side: -1 for the left side of the box, 1 for its right side, 0 for both.
        taken: positions of other hands ``(3,)`` [m].
        upright: whether the hand is upright. Otherwise, it has any orientation.
    """
    while True:
        place = rng.uniform((-_REACH, -_REACH, 0.0), _REACH)
        orientation = np.array([0.0, 0.0, 0.0, 1.0]) if upright else rng.normal(size=4)
        orientation /= np.linalg.norm(orientation)
        offset = rotate(quaternion_conjugate(turn), place - centre * HORIZONTAL)
        apart = all(np.linalg.norm(place - other) >= _APART for other in taken)
        if np.linalg.norm(offset) <= _REACH and offset[0] * side >= 0.0 and apart:
            axis = rotate(orientation, np.array([0.0, 0.0, 1.0]))
            if _is_clear(thing, centre, turn, place, axis):
                return place, orientation


def _is_clear(thing: Token, centre: FloatArray, turn: FloatArray, place: FloatArray, axis: FloatArray) -> bool:
    """Return whether a hand with a given axis ``(3,)`` touches neither the box nor the floor."""
    radius, half = HAND["radius"], HAND["length"] / 2.0
    lowest = place[2] - half * abs(axis[2]) - radius * np.sqrt(1.0 - axis[2] ** 2)
    points = place + np.linspace(-half, half, 17)[:, None] * axis
    beyond = np.abs(rotate(quaternion_conjugate(turn), points - centre)) - np.asarray(thing["half_extents"])
    gap = float(np.linalg.norm(np.maximum(beyond, 0.0), axis=-1).min()) - radius
    return bool(lowest >= _CLEAR and gap >= _CLEAR)
