"""Random tasks of the example domain for drawers, for trials."""

from pathlib import Path

import numpy as np

from hybrid_tamp.geometry.shapes import Compound
from hybrid_tamp.geometry.surfaces import hulls_of
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.poses import quaternion_from_rpy
from hybrid_tamp.skills import Surface
from hybrid_tamp.taskfile.domains import find_domain
from random_tasks.bodies import compound_of, small_hand

DOMAIN = find_domain(str(Path(__file__).resolve().parents[2] / "examples" / "drawer" / "domain.py"))
_WALL = 0.01
"""Thickness of the walls [m]."""
_PLAY = 0.003
"""Gap between a drawer and each side of its cabinet [m]."""


def random_drawer(seed: int) -> Task:
    """Return a task in which one hand pulls a drawer open.

    Length U(0.3, 0.6) m, width U(0.2, 0.5) m, depth U(0.08, 0.15) m; mass U(0.5, 8) kg, friction of drawer and cabinet
    U(0.2, 0.6), opening U(0.1, 0.4) of the length; any yaw, height of the cabinet U(0, 0.4) m.
    """
    rng = np.random.default_rng(seed)
    length, width, depth = (float(rng.uniform(*ends)) for ends in ((0.3, 0.6), (0.2, 0.5), (0.08, 0.15)))
    yaw, below = float(rng.uniform(-np.pi, np.pi)), float(rng.uniform(0.0, 0.4))
    shape, low = open_box(length, width, depth)
    friction = float(rng.uniform(0.2, 0.6))
    properties = {
        "mass": float(rng.uniform(0.5, 8.0)),
        "friction": float(rng.uniform(0.2, 0.6)),
        "wall": _WALL,
        "opening": float(rng.uniform(0.1, 0.4)) * length,
    }
    tokens = (
        small_hand(0.02, 0.2),
        Token.make("drawer", [DOMAIN.class_by_name["DRAWER"]], properties, shape),
        Token.make("cabinet", [Surface], {"friction": friction}, _cabinet(length, width, depth, below)),
    )
    turn = quaternion_from_rpy(np.array([0.0, 0.0, yaw]))
    away = rng.uniform(0.3, 0.6) * np.array([np.cos(yaw), np.sin(yaw)])
    given = {
        ("hand", "position"): (float(away[0]), float(away[1]), below + 0.4),
        ("cabinet", "position"): (0.0, 0.0, 0.0),
        ("cabinet", "orientation"): turn,
        ("drawer", "position"): (0.0, 0.0, below + _WALL + low),
        ("drawer", "orientation"): turn,
    }
    goal = (Atom("open", ("drawer", "cabinet")),)
    return Task(f"drawer_{seed}", DOMAIN, tokens, State.of(tokens, given), goal, seed=seed)


def open_box(length: float, width: float, depth: float) -> tuple[Compound, float]:
    """Return a box without a lid, with its centre of mass at the origin, and the height of the origin [m]."""
    x, y, half = length / 2, width / 2, _WALL / 2
    inner = (depth - _WALL) / 2
    walls = [((x, y, half), (0.0, 0.0, half))]
    for sign in (-1.0, 1.0):
        walls.append(((half, y, inner), (sign * (x - half), 0.0, _WALL + inner)))
        walls.append(((x - _WALL, half, inner), (0.0, sign * (y - half), _WALL + inner)))
    volumes, firsts = zip(*(hull.integrals[:2] for hull in hulls_of(compound_of(walls))), strict=True)
    up = float(np.sum(firsts, axis=0)[2] / sum(volumes))
    return compound_of([(halves, (px, py, pz - up)) for halves, (px, py, pz) in walls]), up


def _cabinet(length: float, width: float, depth: float, below: float) -> Compound:
    """Return a cabinet without a top: a base whose top is `below` + wall, two sides and a back."""
    x, y = length / 2 + 0.02, width / 2 + _PLAY + _WALL
    base = below + _WALL
    side = (depth * 0.8) / 2
    walls = [((x, y, base / 2), (0.0, 0.0, base / 2)), ((_WALL / 2, y, side), (-x + _WALL / 2, 0.0, base + side))]
    walls += [((x, _WALL / 2, side), (0.0, sign * (y - _WALL / 2), base + side)) for sign in (-1.0, 1.0)]
    return compound_of(walls)
