"""The oracle of tasks with a hammer: a hand takes the hammer, pushes a block straight to a region and strikes it there.

The hammer stands on its head. The hand holds the middle of the handle, and sets the hammer down where it has stood.
"""

import numpy as np

from hybrid_tamp.geometry.shapes import Cylinder
from random_tasks.flood import flood
from random_tasks.oracle import STEP, Scene, upright_box
from random_tasks.upright import UP, Floats, Part, turned

_MIDDLE = 0.075
"""Height of the middle of the handle above the centre of the hammer [m]."""
_GRASPS = (0.02, 0.05, _MIDDLE, 0.1, 0.125, 0.15)
"""Heights of grasps above the centre of the hammer [m]."""
_HANDLE, _HEAD = (0.012, 0.012, 0.1), (0.045, 0.02, 0.015)
"""Half extents of the handle, and of the head with its faces ahead, behind and beside, of a standing hammer [m]."""
_HEAD_BELOW = -0.025
"""Height of the middle of the head above the centre of the hammer [m]."""
_BESIDE = 0.09
"""Distance between the handle and a hand that waits beside it [m]."""
_STANDOFF, _FACE = 0.03, 0.045
"""Gap before a push, and distance of the pushing face from the handle [m]."""
_ABOVE_FLOOR = 0.012
"""Height of a pushing hammer above the floor [m]."""
_STANDING = 0.04
"""Height of the centre of a standing hammer [m]."""
_HEAD_AHEAD, _OVER = 0.025, 0.045
"""Distance of the head beyond the centre of the hammer, and height of the hand above the block, in a strike [m]."""
_SWING = 0.16
"""Radius around the hand within which the hammer moves in a strike [m]."""


def check_hammer(scene: Scene) -> str:
    """Return what prevents the push or the strike, generously for every grasp."""
    found = [_check_grasp(scene, grasp) for grasp in (_GRASPS if scene.generous else (_MIDDLE,))]
    return "" if "" in found else found[0]


def _check_grasp(scene: Scene, grasp: float) -> str:
    """Return what prevents the push or the strike if the hand is at a height [m] above the centre of the hammer."""
    task, (hand,) = scene.task, scene.ends
    assert isinstance(hand.shape, Cylinder)
    ball = (Part(np.zeros(3), radius=hand.shape.radius, ball=True),)
    block = upright_box(task.token_by_name["block"], task)
    way = (task.state["goal", "position"] - block.centre) * np.array([1.0, 1.0, 0.0])
    length = float(np.linalg.norm(way))
    ahead, yaw = way / length, float(np.arctan2(way[1], way[0]))
    pushed = length - (float(task.token_by_name["goal"]["radius"]) if scene.generous else 0.0)
    moves = np.linspace(block.centre, block.centre + ahead * pushed, int(length / STEP) + 2)
    # The lower centimetre is left out, because the block stands on the floor.
    if not scene.is_free(scene.room, (Part(0.01 * UP, block.halves, block.yaw),), moves):
        return "the block hits something"
    behind = block.centre - ahead * (block.halves[0] + _FACE)
    behind[2] = _STANDING + _ABOVE_FLOOR
    first = behind - ahead * (0.0 if scene.generous else _STANDOFF)
    pushing = (*_tool(yaw), *(part.moved(grasp * UP) for part in ball))
    if not scene.is_free(scene.room, pushing, np.linspace(first, behind + ahead * pushed, len(moves))):
        return "the hammer or the hand hits something during the push"
    rack, side = task.state["hammer", "position"], _yaw_of_standing(scene)
    waits = [rack + turned(side, (0.0, sign * _BESIDE, _MIDDLE)) for sign in (-1.0, 1.0)]
    if not any(scene.is_free(scene.room, ball, place) for place in waits):
        return "the hand beside the hammer hits something"
    # The hammer keeps its heading: after the push, that of the push. Before it, generously, that of its start, too.
    tops = [moves[-1], block.centre] if scene.generous else [moves[-1]]
    headings = [yaw, side] if scene.generous else [yaw]
    hands = [
        top + turned(each, (-_HEAD_AHEAD - grasp, 0.0, block.halves[2] + _OVER)) for top in tops for each in headings
    ]
    # Strictly, a ball in which the hammer moves must be free above the top of the block.
    moving = ball if scene.generous else (Part((_SWING - _OVER) * UP, radius=_SWING, ball=True),)
    strikes = [place for place in hands if scene.is_free(scene.room, moving, place)]
    if not strikes:
        return "the strike hits something"
    return _check_ways(scene, ball, waits, [[rack + grasp * UP], [first + grasp * UP], strikes])


def _check_ways(scene: Scene, ball: tuple[Part, ...], waits: list[Floats], places: list[list[Floats]]) -> str:
    """Return whether the ball in the hand cannot move to the hammer, and from there to the push and to the strike."""
    (hand,) = scene.ends
    limits = np.array(hand["workspace_lower"]), np.array(hand["workspace_upper"])
    start, ((rack,), *others) = scene.task.state[hand, "position"], places
    if not any(flood(scene.room, ball, start, waits, limits, scene.generous)):
        return "no way for the hand to the hammer"
    if not all(any(flood(scene.room, ball, rack, each, limits, scene.generous)) for each in others):
        return "no way for the hammer"
    return ""


def _tool(yaw: float) -> tuple[Part, ...]:
    """Return a standing hammer relative to its centre."""
    return Part(_MIDDLE * UP, _HANDLE, yaw), Part(_HEAD_BELOW * UP, _HEAD, yaw)


def _yaw_of_standing(scene: Scene) -> float:
    """Return the heading of the standing hammer [rad], whose x axis points down."""
    x, y, z, w = scene.task.state["hammer", "orientation"]
    side = np.array([2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z)])
    return float(np.arctan2(side[1], side[0]) - np.pi / 2)
