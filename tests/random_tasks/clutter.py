"""Scenes with fixed obstacles, for trials: random tasks with tables, walls and blocks, and with hands anywhere."""

from collections.abc import Iterator
from itertools import chain, product

import numpy as np
from hybrid_tamp_domains.tool_use.classes import DexterousHand

from hybrid_tamp.geometry.convex import Body, lowest_height, placed
from hybrid_tamp.geometry.gaps import distance_between
from hybrid_tamp.geometry.shapes import Box, BoxPart, Compound, Shape
from hybrid_tamp.model.support import with_grounds
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.poses import quaternion_from_rpy
from hybrid_tamp.skills import TurningEndEffector
from random_tasks.arranging import Arrangement
from random_tasks.clutter_families import FAMILIES

MOST = 6
"""Largest number of obstacles."""
TABLE = "table"
"""Name of the table on which things and regions are."""
_TIDY = 0.05
"""Distance of the positions in tidy scenes [m]."""
_FARTHEST = 1.2
"""Largest coordinate of a position [m]."""
_REACH = 0.8
"""Largest initial distance [m] of a hand from the thing along each axis."""
_APART = 0.2
"""Smallest initial distance [m] between the centres of two hands."""
_CLEAR = 0.005
"""Smallest initial gap [m] between a hand and everything else."""
_TRIES = 50
_SLAB = 0.02
"""Half thickness of the top of a table on a leg [m]."""
_LEG = 0.05
"""Half edge of the leg of a table [m]."""
_BEYOND = 0.2
"""Least distance from a box that will be tumbled to the edges of its table [m]."""
_TABLES, _SLABS = 0.4, 0.25
"""Share of the scenes with a table below things and regions, and share of the obstacles that are tables."""


def random_clutter(family: str, seed: int) -> Task:
    """Return a task of a family with 0 to 6 obstacles and with hands that start anywhere and touch nothing.

    The scene has any yaw. In two of five scenes, things and regions are on a table. PUSHING needs the floor, so this
    table is missing in tasks with a hammer. Hands start within 0.8 m of the thing, beside or above tables. Hands of
    tumbling can turn, and start in any orientation. Obstacles overlap no body, but may cover regions, and may stand on
    the table. Walls and blocks have half edges U(0.03, 0.25) m and half heights U(0.05, 0.5) m. A quarter of the
    obstacles are tables: tops of 4 cm at U(0.2, 0.8) m, on a leg.

    Every third scene is tidy: positions, edges of obstacles and heights of tables are multiples of 5 cm, and yaws are
    multiples of 90 degrees.
    """
    rng, tidy = np.random.default_rng([seed, 17]), seed % 3 == 0
    task = FAMILIES[family](seed)
    things = [token for token in task.tokens if not token.basic_actions]
    ends = [token for token in task.tokens if token.basic_actions]
    scene = Arrangement.of(task, things)
    thing = task.goal[0].arguments[0]
    _turn(scene, thing, rng, tidy)
    if family != "hammer" and rng.uniform() < _TABLES:
        _add_table(scene, _BEYOND if "tumble" in family else 0.0, rng, tidy)
    for end in ends:
        _add_hand(scene, end, task.state[end, "orientation"], scene.poses[thing][0], rng)
    for number in range(int(rng.integers(0, MOST + 1))):
        _add_obstacle(scene, f"wall-{number + 1}", rng, tidy)
    made = scene.task(task, f"clutter_{task.name}")
    return made.replaced(tokens=with_grounds(made.tokens, made.state))


def _turn(scene: Arrangement, thing: str, rng: np.random.Generator, tidy: bool) -> None:
    """Turn the whole scene about the origin. Move the tokens of a tidy scene to multiples of 5 cm and 90 degrees."""
    yaw = float(rng.uniform(-np.pi, np.pi))
    if tidy:
        yaw = _square(yaw) - scene.heading(thing)
    for token in scene.tokens:
        scene.turn(token.name, yaw)
        if tidy:
            place, _ = scene.poses[token.name]
            scene.shift(token.name, (_snap(place) - place) * [1.0, 1.0, 0.0])
            scene.spin(token.name, _square(scene.heading(token.name)) - scene.heading(token.name))


def _add_table(scene: Arrangement, beyond: float, rng: np.random.Generator, tidy: bool) -> None:
    """Put all things and regions on a table: a block, or a top on a leg.

    The table extends beyond them by `beyond` [m] and up to 0.4 m more.
    """
    yaw, height = _yaw(rng, tidy), float(rng.uniform(0.1, 0.6))
    outline = np.array(list(_outline(scene))) @ _axes(yaw).T
    lower = outline.min(axis=0) - beyond - rng.uniform(0.0, 0.4, 2)
    upper = outline.max(axis=0) + beyond + rng.uniform(0.0, 0.4, 2)
    if tidy:
        height = max(_TIDY, float(_snap(height)))
        lower, upper = np.floor(lower / _TIDY) * _TIDY, np.ceil(upper / _TIDY) * _TIDY
    middle, halves = (lower + upper) / 2.0 @ _axes(yaw), (upper - lower) / 2.0
    for token in scene.tokens:
        scene.shift(token.name, [0.0, 0.0, height])
    shape = _table(float(halves[0]), float(halves[1]), height, bool(rng.uniform() < 0.5))
    scene.add(Token.make(TABLE, [], {}, shape, immovable=True), np.array([*middle, 0.0]), _upright(yaw))


def _table(x: float, y: float, height: float, on_leg: bool) -> Compound:
    """Return a table with half edges `x` and `y` [m]: a block, or a top on a leg. The position is on the floor."""
    thick = _SLAB if on_leg and height > 3.0 * _SLAB else height / 2.0
    top = BoxPart(kind="box", half_extents=(x, y, thick), position=(0.0, 0.0, height - thick))
    leg = height / 2.0 - thick
    below = [(min(_LEG, x), min(_LEG, y), leg)] if leg > 0.0 else []
    parts = (BoxPart(kind="box", half_extents=each, position=(0.0, 0.0, leg)) for each in below)
    return Compound(kind="compound", parts=(top, *parts))


def _outline(scene: Arrangement) -> Iterator[np.ndarray]:
    """Yield points ``(2,)`` [m] around all things and regions."""
    for token in scene.tokens:
        middle = scene.poses[token.name][0][:2]
        reach = token.reach if token.shape is not None else 0.1
        yield from (middle + reach * way for way in (*np.eye(2), *-np.eye(2)))


def _add_hand(
    scene: Arrangement, hand: Token, orientation: np.ndarray, around: np.ndarray, rng: np.random.Generator
) -> None:
    """Add a hand that touches nothing. A hand that can turn has any orientation."""
    others = [scene.poses[token.name][0] for token in scene.tokens if token.basic_actions]
    while True:
        place = around + rng.uniform(-_REACH, _REACH, 3)
        turn = rng.normal(size=4) if hand.is_member(TurningEndEffector) else orientation
        turn = turn / np.linalg.norm(turn)
        if hand.is_member(DexterousHand):
            turn = quaternion_from_rpy(np.array([np.pi / 2, 0.0, rng.uniform(-np.pi, np.pi)]))
        body = placed(hand.solid, place, turn)
        inside = np.all(place > hand["workspace_lower"]) and np.all(place < hand["workspace_upper"])
        apart = all(np.linalg.norm(place - other) >= _APART for other in others)
        if inside and apart and lowest_height(body) >= _CLEAR and _gap(scene, body) >= _CLEAR:
            scene.add(hand, place, turn)
            return


def _gap(scene: Arrangement, body: Body) -> float:
    """Return the distance [m] of a body from all bodies of the scene."""
    others = chain(*(scene.body(token) for token in scene.tokens if token.shape is not None))
    return min(distance_between(mine, other) for mine, other in product(body, others))


def _heights(scene: Arrangement, place: np.ndarray) -> Iterator[float]:
    """Yield the heights [m] at which an obstacle can stand at a place: that of a table below, and zero."""
    for table in (token for token in scene.tokens if token.name == TABLE):
        assert isinstance(table.shape, Compound)
        top, (middle, _) = table.shape.parts[0], scene.poses[TABLE]
        assert isinstance(top, BoxPart)
        if np.all(np.abs(_axes(scene.heading(TABLE)) @ (place - middle[:2])) < top.half_extents[:2]):
            yield top.position[2] + top.half_extents[2]
    yield 0.0


def _add_obstacle(scene: Arrangement, name: str, rng: np.random.Generator, tidy: bool) -> None:
    """Add a wall, a block or a table that overlaps nothing. Nothing is added if 50 tries find no place."""
    for _ in range(_TRIES):
        shape, low = _draw(rng, tidy)
        place = rng.uniform(-_FARTHEST, _FARTHEST, 2)
        place = _snap(place) if tidy else place
        turn = _upright(_yaw(rng, tidy))
        for height in _heights(scene, place):
            centre = np.array([*place, low + height])
            if scene.is_free(placed(shape, centre, turn)):
                scene.add(Token.make(name, [], {}, shape, immovable=True), centre, turn)
                return


def _draw(rng: np.random.Generator, tidy: bool) -> tuple[Shape, float]:
    """Return the shape of an obstacle, and the height of its position [m] above what it stands on."""
    if rng.uniform() < _SLABS:
        x, y, height = *rng.uniform(0.1, 0.35, 2), rng.uniform(0.2, 0.8)
        if tidy:
            x, y, height = _snap(np.array([x, y, height]))
        return _table(float(x), float(y), float(height), on_leg=True), 0.0
    halves = np.array([*rng.uniform(0.03, 0.25, 2), rng.uniform(0.05, 0.5)])
    if tidy:
        halves = np.maximum(_TIDY, _snap(halves))
    x, y, z = (float(half) for half in halves)
    return Box(kind="box", half_extents=(x, y, z)), z


def _yaw(rng: np.random.Generator, tidy: bool) -> float:
    yaw = float(rng.uniform(-np.pi, np.pi))
    return _square(yaw) if tidy else yaw


def _square(angle: float) -> float:
    """Return the nearest multiple of 90 degrees [rad]."""
    return float(round(angle / (np.pi / 2)) * np.pi / 2)


def _snap(values: np.ndarray | float) -> np.ndarray:
    return np.asarray(np.round(np.asarray(values) / _TIDY) * _TIDY)


def _axes(yaw: float) -> np.ndarray:
    """Return the horizontal axes of a body, one per row, shape ``(2, 2)``."""
    return np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])


def _upright(yaw: float) -> np.ndarray:
    return quaternion_from_rpy(np.array([0.0, 0.0, yaw]))
