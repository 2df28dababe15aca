"""Oracles of the scenes with obstacles: which of them can be solved, which of them cannot, and why.

The oracles share no code with the planner. They know the movements of each skill: where hands stand at a thing, and
which way the thing takes. Each oracle is a function that says what is in the way. It is called twice:

- *Strictly*. Bodies keep 5 mm from walls at key poses and during fixed movements. A hand moves from its start to its
  first key pose if a flooded grid connects them for the largest ball in the hand. If nothing is in the way, the scene
  counts as solvable. A hand that is longer than this ball may need more room, so this is slightly too optimistic.
- *Generously*. Bodies may overlap walls by 5 mm, a cell of the grid is open if the body may be free anywhere in the
  cell, and floods use the whole body if its orientation cannot change. If something is in the way, the scene certainly
  cannot be solved with these skills. This check confirms refusals of the planner.

If neither decides, the scene is grey.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import permutations
from typing import Literal

import numpy as np

from hybrid_tamp.geometry.shapes import Cylinder
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from random_tasks.clutter import TABLE
from random_tasks.flood import flood
from random_tasks.upright import UP, Floats, Part, Room, axes_of, parts_of, turned, yaw_of

SLACK = 0.005
"""Gap at key poses of solvable scenes [m]. In impossible scenes, bodies overlap by more than this at a key pose."""
STEP = 0.005
"""Distance of the positions at which a movement is examined [m]."""


@dataclass(frozen=True)
class Scene:
    """A task and how strictly its movements are examined.

    Attributes:
        task: the task.
        generous: whether the check is generous.
    """

    task: Task
    generous: bool

    @cached_property
    def room(self) -> Room:
        """All fixed bodies."""
        return self._room(lambda token: True)

    @cached_property
    def obstacles(self) -> Room:
        """All fixed bodies except the table on which things are."""
        return self._room(lambda token: token.name != TABLE)

    def _room(self, chosen: Callable[[Token], bool]) -> Room:
        fixed = (token for token in self.task.tokens if token.immovable and chosen(token))
        return Room(tuple(part for token in fixed for part in parts_of(token, self.task)))

    @property
    def ends(self) -> list[Token]:
        """The hands."""
        return [token for token in self.task.tokens if token.basic_actions]

    def is_free(self, room: Room, body: tuple[Part, ...], places: Floats) -> bool:
        """Return whether a body is free at all positions, shape ``(n, 3)``."""
        return room.least(body, places) > (-SLACK if self.generous else SLACK)

    def depth_on_table(self, place: Floats) -> float:
        """Return how deep [m] a point is within the outline of the table, infinite without a table."""
        table = self.task.token_by_name.get(TABLE)
        if table is None:
            return float("inf")
        top = parts_of(table, self.task)[0]
        return float((np.array(top.halves[:2]) - np.abs(axes_of(top.yaw) @ (place - top.centre)[:2])).min())

    def lands(self, middle: Floats, corners: Floats) -> bool:
        """Return whether a thing can rest at a place: all corners, shape ``(n, 3)``, or generously its middle."""
        points = middle[None] if self.generous else corners
        return all(self.depth_on_table(point) > (-SLACK if self.generous else 0.0) for point in points)

    def reach(self, hand: Token, goals: list[Floats], thing: Part | None = None) -> list[bool]:
        """Return for each place whether a hand can move there from its start."""
        shape = hand.shape
        assert isinstance(shape, Cylinder)
        body = (Part(np.zeros(3), radius=shape.radius, ball=True),)
        turn = self.task.state[hand, "orientation"]
        if self.generous and "maximal_torque" not in hand.properties and np.allclose(turn[:2], 0.0):
            body = (Part(np.zeros(3), (0.0, 0.0, shape.length / 2.0), radius=shape.radius),)
        room = self.room if thing is None or self.generous else self.room.with_bodies(thing)
        limits = np.array(hand["workspace_lower"]), np.array(hand["workspace_upper"])
        return flood(room, body, self.task.state[hand, "position"], goals, limits, self.generous)

    def any_crew_reaches(self, choices: list[list[Floats]], thing: Part | None = None) -> bool:
        """Return whether different hands can move to all places of one of the choices."""
        goals = [place for places in choices for place in places]
        table = np.array([self.reach(hand, goals, thing) for hand in self.ends])
        columns = np.split(table, np.cumsum([len(places) for places in choices])[:-1], axis=1)
        return any(
            all(part[hand, goal] for goal, hand in enumerate(crew))
            for part in columns
            for crew in permutations(range(len(table)), part.shape[1])
        )


@dataclass(frozen=True)
class Opinion:
    """What an oracle says about a scene.

    Attributes:
        verdict: whether the scene can be solved with these skills, or ``grey`` if that is open.
        why: what is in the way in the strict check, or empty.
        proof: what is in the way in the generous check, or empty. A solvable scene is not checked generously.
    """

    verdict: Literal["solvable", "impossible", "grey"]
    why: str = ""
    proof: str = ""


Check = Callable[[Scene], str]


def ask(check: Check, task: Task) -> Opinion:
    """Return the opinion of an oracle, given what it checks."""
    why = check(Scene(task, generous=False))
    if not why:
        return Opinion("solvable")
    proof = check(Scene(task, generous=True))
    return Opinion("impossible" if proof else "grey", why, proof)


def check_roll(scene: Scene) -> str:
    """Return what prevents a roll: a drum rolls straight to its region, with an upright hand behind it."""
    task, (hand,) = scene.task, scene.ends
    drum = task.token_by_name["cylinder"]
    assert isinstance(drum.shape, Cylinder)
    assert isinstance(hand.shape, Cylinder)
    start, end = task.state[drum, "position"], task.state["goal", "position"]
    way = (end - start) * np.array([1.0, 1.0, 0.0])
    length = float(np.linalg.norm(way))
    ahead, yaw = way / length, float(np.arctan2(way[1], way[0]))
    rolled = length - (float(task.token_by_name["goal"]["radius"]) if scene.generous else 0.0)
    if not scene.lands(start + ahead * rolled, (start + ahead * rolled)[None]):
        return "the drum leaves the table"
    if not _is_roll_free(scene, drum.shape, start, yaw, rolled):
        return "the drum hits something"
    above = max(0.0, hand.shape.length / 2.0 + 0.01 - drum.shape.radius)
    touching = start - ahead * (drum.shape.radius + hand.shape.radius) + above * UP
    behind = touching - ahead * 0.03
    body = (Part(np.zeros(3), (0.0, 0.0, hand.shape.length / 2.0), radius=hand.shape.radius),)
    begin = touching if scene.generous else behind
    pushed = np.linspace(begin, touching + ahead * rolled, int(length / STEP) + 2)
    if not scene.is_free(scene.room, body, pushed):
        return "the hand behind the drum hits something"
    outline = (drum.shape.radius, drum.shape.length / 2.0, drum.shape.radius)
    return "" if scene.any_crew_reaches([[behind]], Part(start, outline, yaw)) else "no way for the hand"


def _is_roll_free(scene: Scene, shape: Cylinder, start: Floats, yaw: float, length: float) -> bool:
    """Return whether a drum is free during a roll. At each height, the swept volume is a rectangle."""
    slack = -SLACK if scene.generous else SLACK
    for wall in scene.obstacles.walls:
        height = np.clip(start[2], wall.centre[2] - wall.halves[2], wall.centre[2] + wall.halves[2]) - start[2]
        if abs(height) >= shape.radius:
            continue
        half = float(np.sqrt(shape.radius**2 - height**2))
        swept = Part(turned(yaw, (length / 2.0, 0.0, height)), (length / 2.0 + half, shape.length / 2.0, 1e-3), yaw)
        if Room((wall,)).least((swept,), start) <= slack:
            return False
    return True


def upright_box(token: Token, task: Task) -> Part:
    """Return a box token that stands upright."""
    return Part(task.state[token, "position"], tuple(token["half_extents"]), yaw_of(task.state[token, "orientation"]))
