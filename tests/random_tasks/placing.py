"""Random tasks of the example domain for placing, for trials."""

from pathlib import Path

import numpy as np

from hybrid_tamp.geometry.shapes import Box, BoxPart, Compound, CylinderPart
from hybrid_tamp.geometry.surfaces import hulls_of
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.poses import quaternion_from_rpy, rotate
from hybrid_tamp.physics.scene import compute_inertia
from hybrid_tamp.skills import Gripper, Surface, attitude, standing_height
from hybrid_tamp.taskfile.domains import find_domain

DOMAIN = find_domain(str(Path(__file__).resolve().parents[2] / "examples" / "placing" / "domain.py"))
HAND = {
    "radius": 0.03,
    "length": 0.08,
    "mass": 1.0,
    "maximal_force": 100.0,
    "workspace_lower": (-3.0, -3.0, 0.0),
    "workspace_upper": (3.0, 3.0, 2.0),
    "maximal_torque": 10.0,
    "maximal_grip": 100.0,
    "wrist_inertia": 0.002,
    "contact_width": 0.04,
}
_ALONG_X = (0.0, np.pi / 2, 0.0)
"""Roll, pitch and yaw of a cylinder along the x axis [rad]."""
_INSET = 0.07
"""Smallest distance of a cup from an edge of its table [m]."""

_FOOT = 0.01
"""Thickness of a foot [m]."""

Places = list[tuple[float, float]]


def random_placing(seed: int) -> Task:
    """Return a task in which one hand carries one or two cups from one table to one or two others.

    The cups are mugs, bottles and pegs of U(0.1, 1.5) kg with any yaw. Half edges of the tables U(0.15, 0.3) m, heights
    U(0.02, 0.5) m, any yaw, gaps U(0.05, 0.4) m.
    """
    rng = np.random.default_rng(seed)
    tables = [_table(name, rng) for name in ("first table", "second table", "third table")]
    middles, yaws = _spread(tables, rng), rng.uniform(-np.pi, np.pi, 3)
    hand = Token.make("hand", [Gripper], HAND)
    cups = [_cup(f"cup {number + 1}", rng) for number in range(int(rng.integers(1, 3)))]
    tokens = (hand, *cups, *tables)
    high = _height(tables[0])
    aside = rng.uniform(-0.3, 0.3, 2)
    given = {
        ("hand", "position"): (*map(float, aside), high + float(rng.uniform(0.3, 0.6))),
        ("hand", "orientation"): quaternion_from_rpy(np.array([np.pi / 2, 0.0, rng.uniform(-np.pi, np.pi)])),
    }
    for table, middle, yaw in zip(tables, middles, yaws, strict=True):
        given[table.name, "position"] = (*middle, _height(table) / 2)
        given[table.name, "orientation"] = quaternion_from_rpy(np.array([0.0, 0.0, yaw]))
    for cup, place in zip(cups, _places(tables[0], yaws[0], len(cups), rng), strict=False):
        given[cup.name, "position"] = (*place, high + standing_height(cup))
        given[cup.name, "orientation"] = attitude(float(rng.uniform(-np.pi, np.pi)), 0.0)
    wanted = [Atom("stands_on", (cup.name, table.name)) for cup, table in zip(cups, tables[1:], strict=False)]
    return Task(
        f"place_{seed}", DOMAIN, tokens, State.of(tokens, given), (*wanted, Atom("empty", ("hand",))), seed=seed
    )


def _table(name: str, rng: np.random.Generator) -> Token:
    x, y, z = (float(each) for each in (*rng.uniform(0.15, 0.3, 2), rng.uniform(0.02, 0.5) / 2))
    return Token.make(
        name, [Surface], {"friction": float(rng.uniform(0.3, 0.9))}, Box(kind="box", half_extents=(x, y, z))
    )


def _height(table: Token) -> float:
    return 2.0 * float(_halves(table)[2])


def _halves(table: Token) -> np.ndarray:
    assert isinstance(table.shape, Box)
    return np.array(table.shape.half_extents)


def _spread(tables: list[Token], rng: np.random.Generator) -> Places:
    """Return the middles of three tables. The first is at the origin, and the others are in opposite half planes."""
    round_all = [float(np.hypot(*_halves(table)[:2])) for table in tables]
    turn, places = rng.uniform(-np.pi, np.pi), [(0.0, 0.0)]
    for around, towards in zip(round_all[1:], (0.0, np.pi), strict=True):
        away = round_all[0] + around + rng.uniform(0.05, 0.4)
        angle = turn + towards + rng.uniform(-0.6, 0.6)
        places.append((float(away * np.cos(angle)), float(away * np.sin(angle))))
    return places


def _places(table: Token, yaw: float, count: int, rng: np.random.Generator) -> Places:
    """Return places on a table at the origin, at a distance from its edges and from each other."""
    most = _halves(table)[:2] - _INSET
    found: list[np.ndarray] = []
    while len(found) < count:
        place = rng.uniform(-most, most)
        if count == 2:  # The cups are in opposite halves of the longer axis.
            axis = int(np.argmax(most))
            place[axis] = (1.0 if found else -1.0) * most[axis]
        found.append(place)
    turn = quaternion_from_rpy(np.array([0.0, 0.0, yaw]))
    return [tuple(map(float, rotate(turn, np.array([*place, 0.0]))[:2])) for place in found]


def _cup(name: str, rng: np.random.Generator) -> Token:
    """Return a mug, a bottle or a peg. The x axis points down, and the origin is the centre of volume."""
    make = (_mug, _bottle, _peg)[int(rng.integers(3))]
    parts, low, high, aside, width = make(rng)
    volumes, firsts = zip(
        *(hull.integrals[:2] for hull in hulls_of(Compound(kind="compound", parts=parts))), strict=True
    )
    centre = np.sum(firsts, axis=0) / sum(volumes)
    moved = tuple(part.model_copy(update={"position": _minus(part.position, centre)}) for part in parts)
    shape, mass = Compound(kind="compound", parts=moved), float(rng.uniform(0.1, 1.5))
    properties = {
        "mass": mass,
        "friction": float(rng.uniform(0.3, 0.9)),
        "inertia": compute_inertia(shape, mass),
        "handle_from": _minus((-high, 0.0, aside), centre),
        "handle_to": _minus((-low, 0.0, aside), centre),
        "handle_width": width,
    }
    return Token.make(name, [DOMAIN.class_by_name["CUP"]], properties, shape)


def _minus(place: tuple[float, float, float], centre: np.ndarray) -> tuple[float, float, float]:
    x, y, z = (float(each) for each in np.asarray(place) - centre)
    return x, y, z


Described = tuple[tuple[BoxPart | CylinderPart, ...], float, float, float, float]
"""Parts, height of both ends of the handle above the foot [m], offset of the handle along z [m], and its width [m]."""


def _mug(rng: np.random.Generator) -> Described:
    radius, height, bar = (float(rng.uniform(*ends)) for ends in ((0.03, 0.05), (0.1, 0.15), (0.006, 0.01)))
    aside, low, high = radius + 0.03, 0.2 * height, 0.8 * height
    arm = (aside - bar - radius) / 2 + 0.003
    grip = BoxPart(kind="box", half_extents=((high - low) / 2, bar, bar), position=(-height / 2, 0.0, aside))
    arms = [
        BoxPart(kind="box", half_extents=(0.005, bar, arm), position=(-at, 0.0, aside - bar - arm))
        for at in (low + 0.005, high - 0.005)
    ]
    return (_foot(radius), _round(radius, _FOOT, height), grip, *arms), low, high, aside, 2 * bar


def _bottle(rng: np.random.Generator) -> Described:
    radius, height = float(rng.uniform(0.03, 0.05)), float(rng.uniform(0.1, 0.18))
    thin, neck = float(rng.uniform(0.012, 0.02)), float(rng.uniform(0.06, 0.1))
    whole = height + neck
    parts = (_foot(radius), _round(radius, _FOOT, height), _round(thin, height, whole))
    return parts, height, whole, 0.0, 2 * thin


def _peg(rng: np.random.Generator) -> Described:
    x, y, z = (float(rng.uniform(*ends)) for ends in ((0.07, 0.15), (0.02, 0.04), (0.015, 0.025)))
    return (BoxPart(kind="box", half_extents=(x, y, z), position=(-x, 0.0, 0.0)),), x, 2 * x, 0.0, 2 * z


def _foot(radius: float) -> BoxPart:
    """Return a square foot. A body that stands on the flat end of a cylinder would rock in PyBullet."""
    return BoxPart(kind="box", half_extents=(_FOOT / 2, radius, radius), position=(-_FOOT / 2, 0.0, 0.0))


def _round(radius: float, low: float, high: float) -> CylinderPart:
    place = (-(low + high) / 2, 0.0, 0.0)
    return CylinderPart(kind="cylinder", radius=radius, length=high - low, position=place, rpy=_ALONG_X)
