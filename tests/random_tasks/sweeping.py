"""Random tasks of the example domain for sweeping, for trials."""

from pathlib import Path

import numpy as np

from hybrid_tamp.geometry.shapes import Box
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.poses import quaternion_from_rpy
from hybrid_tamp.skills import Container, Surface
from hybrid_tamp.taskfile.domains import find_domain
from random_tasks.bodies import compound_of, small_hand

DOMAIN = find_domain(str(Path(__file__).resolve().parents[2] / "examples" / "sweeping" / "domain.py"))
_WALL = 0.01
"""Half of the thickness of a tray's bottom and walls [m]."""


def random_sweeping(seed: int) -> Task:
    """Return a task in which one hand sweeps one to three boxes off a table into a tray at a random edge.

    Half edges of the table U(0.25, 0.5) m, its height U(0.15, 0.5) m, any yaw. Edges of the crumbs U(3, 8) cm, mass
    U(0.05, 1) kg, friction U(0.3, 0.9). The rim of the tray is U(5, 10) cm high, and lower than the table. Three
    in ten hands are upright, and the others lie across the movement.
    """
    rng = np.random.default_rng(seed)
    half, height = rng.uniform(0.25, 0.5, 2), float(rng.uniform(0.15, 0.5))
    friction, yaw = float(rng.uniform(0.3, 0.9)), float(rng.uniform(-np.pi, np.pi))
    axis, sign = int(rng.integers(2)), float(rng.choice([-1.0, 1.0]))
    turn = quaternion_from_rpy(np.array([0.0, 0.0, yaw]))
    width, rim = float(half[1 - axis]), float(rng.uniform(0.05, 0.1))
    reach = float(rng.uniform(0.12, 0.25))
    normal = sign * np.eye(2)[axis]
    centre = normal * (half[axis] + reach + 0.005)
    tray_halves = np.where(np.arange(2) == axis, reach, width)
    crumbs, poses = _crumbs(rng, half, height, axis)
    upright = bool(rng.random() < 0.3)
    hand_yaw = yaw + (np.pi / 2 if axis == 1 else 0.0)
    tokens = (small_hand(0.03, 0.16), _table(half, height, friction), _tray(tray_halves, rim, friction), *crumbs)
    given = {
        ("hand", "position"): (*_turned(-normal * (half[axis] + 0.15), yaw), height + 0.3),
        ("hand", "orientation"): quaternion_from_rpy(np.array([0.0 if upright else np.pi / 2, 0.0, hand_yaw])),
        ("table", "position"): (0.0, 0.0, height / 2),
        ("table", "orientation"): turn,
        ("tray", "position"): (*_turned(centre, yaw), _WALL),
        ("tray", "orientation"): turn,
    }
    for crumb, (x, y, z) in zip(crumbs, poses, strict=True):
        given[crumb.name, "position"] = (*_turned(np.array([x, y]), yaw), z)
        given[crumb.name, "orientation"] = turn
    goal = tuple(Atom("cleared", (crumb.name, "tray")) for crumb in crumbs)
    return Task(f"sweep_{seed}", DOMAIN, tokens, State.of(tokens, given), goal, seed=seed)


def _turned(point: np.ndarray, yaw: float) -> tuple[float, float]:
    x, y = point
    return float(x * np.cos(yaw) - y * np.sin(yaw)), float(x * np.sin(yaw) + y * np.cos(yaw))


def _table(half: np.ndarray, height: float, friction: float) -> Token:
    shape = Box(kind="box", half_extents=(float(half[0]), float(half[1]), height / 2))
    return Token.make("table", [Surface], {"friction": friction}, shape)


def _tray(half: np.ndarray, rim: float, friction: float) -> Token:
    x, y = map(float, half)
    walls = [((x, y, _WALL), (0.0, 0.0, 0.0))]
    for sign in (-1.0, 1.0):
        walls.append(((_WALL, y, rim / 2), (sign * (x - _WALL), 0.0, _WALL + rim / 2)))
        walls.append(((x - 2 * _WALL, _WALL, rim / 2), (0.0, sign * (y - _WALL), _WALL + rim / 2)))
    return Token.make("tray", [Container], {"friction": friction}, compound_of(walls))


def _crumbs(
    rng: np.random.Generator, half: np.ndarray, height: float, axis: int
) -> tuple[list[Token], list[np.ndarray]]:
    """Return the crumbs and their positions on the table. Their paths along the axis are 15 cm apart."""
    crumbs: list[Token] = []
    poses: list[np.ndarray] = []
    for number in range(1, int(rng.integers(1, 4)) + 1):
        edges = rng.uniform(0.015, 0.04, 3)
        place = rng.uniform(-(half - 0.08), half - 0.08)
        if any(abs(place - other[:2])[1 - axis] < 0.15 for other in poses):
            continue  # The hand would also push the other crumb.
        properties = {"mass": float(rng.uniform(0.05, 1.0)), "friction": float(rng.uniform(0.3, 0.9))}
        shape = Box(kind="box", half_extents=(float(edges[0]), float(edges[1]), float(edges[2])))
        crumbs.append(Token.make(f"crumb {number}", [_class("CRUMB")], properties, shape))
        poses.append(np.array([*place, height + edges[2]]))
    return crumbs, poses


def _class(name: str) -> type:
    return DOMAIN.class_by_name[name]
