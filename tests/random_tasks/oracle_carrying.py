"""The oracle of carries: upright hands lift a box, carry it to a region and set it down, without turning it."""

import numpy as np

from hybrid_tamp.geometry.shapes import Cylinder
from random_tasks.flood import flood
from random_tasks.oracle import STEP, Scene, upright_box
from random_tasks.upright import UP, Floats, Part, turned

_SPOTS = {2: ((-1.0, 0.0), (1.0, 0.0)), 4: ((-1.0, -0.5), (-1.0, 0.5), (1.0, -0.5), (1.0, 0.5))}
"""Places of the hands, as shares of the half extents along x and y of the box."""
_STANDBY = 0.012
"""Gap between a waiting hand and the box [m]."""
_ABOVE = 0.01
"""Height of the lower end of a hand above the centre of the box [m]."""
_LEAST_LIFT, _USUAL_LIFT = 0.11, 0.15
"""Smallest and usual height of a lift [m]."""


def check_carry(scene: Scene) -> str:
    """Return what prevents a carry."""
    task = scene.task
    box = upright_box(task.token_by_name["box"], task)
    start, region = box.centre, task.state["goal", "position"]
    end = np.array([*region[:2], start[2]])
    corners = end + [turned(box.yaw, (x * box.halves[0], y * box.halves[1], 0.0)) for x in (-1, 1) for y in (-1, 1)]
    if not scene.lands(end, corners):
        return "the region is too close to the edge of the table"
    own = Part(np.zeros(3), box.halves, box.yaw)
    spots = _hands(scene, box, 0.0 if scene.generous else _STANDBY)
    rise = (_LEAST_LIFT if scene.generous else _USUAL_LIFT) * UP
    for where, name in ((start, "at the start"), (end, "at the region")):
        column = np.linspace(where, where + rise, int(rise[2] / STEP) + 1)
        if not scene.is_free(scene.room, spots, column):
            return f"a hand at the box hits something {name}"
        if not scene.is_free(scene.obstacles, (own,), column + 0.01 * UP):
            return f"the box hits something {name}"
    if not _is_carried(scene, (own, *_hands(scene, box, 0.0)), start + rise, end + rise):
        return "no way for the box"
    goals = [start + part.centre for part in _hands(scene, box, _STANDBY)]
    return "" if scene.any_crew_reaches([goals], box) else "no way for the hands"


def _hands(scene: Scene, box: Part, gap: float) -> tuple[Part, ...]:
    """Return the hands, relative to the centre of the box, at a gap [m] to their faces."""
    shape = scene.ends[0].shape
    assert isinstance(shape, Cylinder)
    half_x, half_y, _ = box.halves
    aside, up = half_x + shape.radius + gap, _ABOVE + shape.length / 2.0
    return tuple(
        Part(turned(box.yaw, (x * aside, y * half_y, up)), (0.0, 0.0, shape.length / 2.0), radius=shape.radius)
        for x, y in _SPOTS[len(scene.ends)]
    )


def _is_carried(scene: Scene, carried: tuple[Part, ...], start: Floats, end: Floats) -> bool:
    """Return whether the box and its hands, which keep their orientation, can move between two places."""
    hand = scene.ends[0]
    offsets = np.array([part.centre for part in carried[1:]])
    lower = np.array(hand["workspace_lower"]) - offsets.min(axis=0)
    upper = np.array(hand["workspace_upper"]) - offsets.max(axis=0)
    return flood(scene.room, carried, start, [end], (lower, upper), scene.generous)[0]
