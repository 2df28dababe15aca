"""The oracle of tumbling: pairs of hands tip a box over its edges until it lies on its right face.

The strict check examines the direct tumble onto the right face, with the hands on their faces. The generous check
examines all sequences of up to four tumbles.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from hybrid_tamp.geometry.shapes import Cylinder
from hybrid_tamp.model.token import Token
from random_tasks.oracle import SLACK, Scene, upright_box
from random_tasks.upright import UP, Floats, Part, axes_of, rod

_MOST_TUMBLES = 4
_STANDBY = 0.012
"""Gap between a waiting hand and the box [m]."""
_GRIP, _HIGHEST = 0.72, 0.9
"""Usual and largest height of a hand on its face, as a share of the height of the face."""
_PAST = np.radians(6.0)
"""Angle by which a tipped box leans past its point of balance [rad]."""
_ABOVE_GROUND = 0.01
"""Smallest gap between a hand and the ground [m]."""
_ANGLES = 46
_RIGHT = np.array([1.0, 0.0, 0.0])


@dataclass(frozen=True, eq=False)
class Lying:
    """A box that lies on the ground.

    Attributes:
        centre: position ``(3,)`` [m].
        axes: body axes in the world, one per row, shape ``(3, 3)``.
        halves: half extents along the body axes ``(3,)`` [m].
    """

    centre: Floats
    axes: Floats
    halves: Floats

    def extent(self, direction: Floats) -> float:
        """Return the half extent [m] along a body axis in the world."""
        return float(np.abs(self.axes @ direction) @ self.halves)

    def pivot(self, ahead: Floats) -> Floats:
        """Return the middle of the lower edge in a direction."""
        return self.centre + ahead * self.extent(ahead) - self.extent(UP) * UP

    def tipped(self, ahead: Floats, angle: float) -> "Lying":
        """Return the box after a turn about its lower edge in a direction."""
        turn, pivot = _rotation(ahead, angle), self.pivot(ahead)
        return Lying(pivot + turn @ (self.centre - pivot), self.axes @ turn.T, self.halves)

    @property
    def is_done(self) -> bool:
        """Whether the box lies on its right face."""
        return bool((_RIGHT @ self.axes)[2] < -0.9)

    @property
    def ways(self) -> Iterator[Floats]:
        """Yield the level directions of the four faces beside the box."""
        yield from (sign * axis for axis in self.axes if abs(axis[2]) < 0.5 for sign in (-1.0, 1.0))


def check_tumble(scene: Scene) -> str:
    """Return what prevents that the box ends on its right face."""
    box = upright_box(scene.task.token_by_name[scene.task.goal[0].arguments[0]], scene.task)
    axes = np.vstack([np.column_stack([axes_of(box.yaw), np.zeros(2)]), UP])
    lying = Lying(box.centre, axes, np.array(box.halves))
    if scene.generous:
        return _find_no_sequence(scene, lying)
    why = _find_fault(scene, lying, axes[0]) or _find_busy_hands(scene, lying, axes[0])
    if why:
        return why
    faces = [each.centre for each in _hand_places(scene.ends[0], lying, axes[0])]
    return "" if scene.any_crew_reaches([faces], box) else "no way for the hands"


def _find_no_sequence(scene: Scene, start: Lying) -> str:
    """Return why no sequence of tumbles ends on the right face, or empty if there may be a sequence."""
    first = [way for way in start.ways if not _find_fault(scene, start, way)]
    if not first:
        return "no tumble is free: " + ", ".join(sorted({_find_fault(scene, start, way) for way in start.ways}))
    found = {_key(start): start}
    latest = [start]
    for _ in range(_MOST_TUMBLES):
        after = [
            each.tipped(way, np.pi / 2) for each in latest for way in each.ways if not _find_fault(scene, each, way)
        ]
        latest = [box for box in {_key(box): box for box in after}.values() if _key(box) not in found]
        found |= {_key(box): box for box in latest}
        if any(box.is_done for box in latest):
            break
    if not any(box.is_done for box in found.values()):
        return "" if latest else "no sequence of tumbles is free"
    pairs = [[part.centre for part in _hand_places(scene.ends[0], start, way)] for way in first]
    return "" if scene.any_crew_reaches(pairs) else "no way for the hands"


def _key(box: Lying) -> tuple[float, ...]:
    return tuple(float(value) + 0.0 for value in (*box.centre.round(4), *box.axes.ravel().round(4)))


def _find_fault(scene: Scene, box: Lying, ahead: Floats) -> str:
    """Return what prevents a tumble: the box leaves the table or hits something, or a hand has no place at a face."""
    after = box.tipped(ahead, np.pi / 2)
    beside = np.cross(ahead, UP)
    corners = after.centre + [
        x * after.extent(ahead) * ahead + y * after.extent(beside) * beside for x in (-1, 1) for y in (-1, 1)
    ]
    if not scene.lands(after.centre, corners):
        return "the box leaves the table"
    least = -SLACK if scene.generous else SLACK
    # The box stays within two of its own radii around the edge about which it turns.
    room = 2.0 * float(np.linalg.norm(box.halves)) + SLACK
    pivot, walls = box.pivot(ahead), scene.obstacles.walls
    near = [wall for wall in walls if np.linalg.norm(wall.centre - pivot) <= room + np.linalg.norm(wall.halves)]
    for angle in np.linspace(0.0, np.pi / 2, _ANGLES if near else 0):
        if any(_separation(box.tipped(ahead, float(angle)), wall) <= least for wall in near):
            return "the box hits something"
    hand = scene.ends[0]
    places = _hand_places(hand, box, ahead, 0.0 if scene.generous else _STANDBY)
    free = all(scene.is_free(scene.room, _lying_hand(hand, ahead), each.centre) for each in places)
    return "" if free else "a hand beside the box hits something"


def _find_busy_hands(scene: Scene, box: Lying, ahead: Floats) -> str:
    """Return whether a hand on the box hits something during a direct tumble.

    Hands push and hold the box at the faces behind and ahead. Past the point of balance, the hand behind changes to the
    lower face, and before the box is lowered, the hand ahead changes to the upper face.
    """
    hand = scene.ends[0]
    assert isinstance(hand.shape, Cylinder)
    balance = float(np.arctan2(box.extent(ahead), box.extent(UP)))
    out = hand.shape.radius + _STANDBY
    behind, before = (part.centre - box.centre for part in _hand_places(hand, box, ahead))
    middle = ahead * (box.extent(ahead) - 2.0 * _GRIP * box.extent(ahead))
    lower, upper = (sign * UP * (box.extent(UP) + out) + middle for sign in (-1.0, 1.0))
    spans = ((behind, 0.0, balance + _PAST), (before, 0.0, balance + _PAST), (lower, balance - _PAST, np.pi / 2))
    for place, low, high in (*spans, (upper, balance - _PAST, np.pi / 2)):
        for angle in np.linspace(low, high, 30):
            turn, pivot = _rotation(ahead, float(angle)), box.pivot(ahead)
            centre = pivot + turn @ (box.centre + place - pivot)
            ground = box.centre[2] - box.extent(UP)
            centre[2] = max(centre[2], ground + hand.shape.radius + _ABOVE_GROUND)
            if not scene.is_free(scene.obstacles, _lying_hand(hand, ahead), centre):
                return "a hand on the box hits something"
    return ""


def _hand_places(hand: Token, box: Lying, ahead: Floats, gap: float = _STANDBY) -> list[Part]:
    """Return the places of the hands behind and ahead of a box before a tumble, at a gap [m] to their faces."""
    assert isinstance(hand.shape, Cylinder)
    radius, height, width = hand.shape.radius, 2.0 * box.extent(UP), 2.0 * box.extent(ahead)
    lean = np.arctan2(height, width) - _PAST - np.radians(3.0)
    clear = radius * (1.0 + np.cos(lean)) / np.sin(lean) + _ABOVE_GROUND
    above = max(min(max(_GRIP * height, clear), _HIGHEST * height), radius + _ABOVE_GROUND) - height / 2.0
    out = width / 2.0 + radius + gap
    return [Part(box.centre + sign * ahead * out + above * UP) for sign in (-1.0, 1.0)]


def _lying_hand(hand: Token, ahead: Floats) -> tuple[Part, ...]:
    """Return balls within a hand that lies across the direction of a tumble."""
    assert isinstance(hand.shape, Cylinder)
    return rod(np.cross(ahead, UP), hand.shape.radius, hand.shape.length)


def _rotation(ahead: Floats, angle: float) -> Floats:
    """Return the rotation matrix of a turn that tips a body in a level direction."""
    x, y, z = np.cross(UP, ahead)
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * skew + (1.0 - np.cos(angle)) * skew @ skew)


def _separation(box: Lying, wall: Part) -> float:
    """Return the largest gap [m] between a box and a wall along the axes that can separate two boxes."""
    theirs = np.vstack([np.column_stack([axes_of(wall.yaw), np.zeros(2)]), UP])
    crossed = np.cross(box.axes[:, None], theirs[None]).reshape(-1, 3)
    lengths = np.linalg.norm(crossed, axis=-1)
    candidates = np.vstack([box.axes, theirs, crossed[lengths > 1e-9] / lengths[lengths > 1e-9, None]])
    reach = np.abs(candidates @ box.axes.T) @ box.halves + np.abs(candidates @ theirs.T) @ np.array(wall.halves)
    return float((np.abs(candidates @ (wall.centre - box.centre)) - reach).max())
