"""Discs that lie on the floor or on the level top of a fixed body."""

from collections.abc import Iterable

import numpy as np

from hybrid_tamp.geometry.common_volume import face_planes
from hybrid_tamp.geometry.convex import reach_of
from hybrid_tamp.geometry.shapes import Shape
from hybrid_tamp.geometry.surfaces import hulls_of
from hybrid_tamp.geometry.tops import find_tops
from hybrid_tamp.model.ground import ON_FLOOR, Ground
from hybrid_tamp.model.state import State
from hybrid_tamp.model.support import MOST_ABOVE, is_body
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_conjugate, rotate


def find_unlaid(disc: Token, radius: float, state: State, tokens: Iterable[Token]) -> str | None:
    """Return an error message if a level disc lies neither on the floor nor on a level top, otherwise None.

    Args:
        disc: the disc, whose centre is its position.
        radius: radius of the disc [m].
        state: initial state, without batch dimensions.
        tokens: all tokens of the task.
    """
    centre = state[disc, "position"]
    others = [token for token in tokens if is_body(token, state) and _may_be_over(token, state, centre)]
    for body in others:
        depth = _depth_inside(body.solid, state[body, "position"], state[body, "orientation"], centre + _OVER)
        if body.fixed_body and depth > 0.0:
            return f"the centre of the disc is {_metres(depth)} m inside {body.name}"
    below = _find_below(others, state, centre)
    above = float(centre[2]) - below.height
    if above < -MOST_ABOVE:
        return f"the disc must not be below the floor (z = 0), but it is at z = {_metres(centre[2])} m"
    wanted = "the disc must lie on the floor or on the level top of a fixed body"
    if above > MOST_ABOVE:
        return f"{wanted}, but it is {_metres(above)} m above {below.text}"
    if not below.fixed:
        return f"{wanted}, but {below.body} is not fixed"
    beyond = radius - float(below.depth(centre[:2]))
    return f"the disc reaches {_metres(beyond)} m beyond {below.edge}" if beyond > MOST_ABOVE else None


_OVER = np.array([0.0, 0.0, 2.0 * MOST_ABOVE])
"""Vector from the centre of a disc to a point that must be outside all fixed bodies [m]."""
_DOWNWARDS = 0.7
"""Smallest downward component of the normal of a face below a body."""


def _may_be_over(body: Token, state: State, point: FloatArray) -> bool:
    """Return whether a vertical line through a point meets the ball that contains a body."""
    return float(np.hypot(*(state[body, "position"] - point)[:2])) <= reach_of(body.solid)


def _find_below(bodies: Iterable[Token], state: State, centre: FloatArray) -> Ground:
    """Return the highest level top below a point ``(3,)`` [m], or the floor."""
    found = ON_FLOOR
    for body in bodies:
        for top in find_tops(body.solid, state[body, "position"], state[body, "orientation"]):
            counts = body.fixed_body or top.height > MOST_ABOVE
            if counts and found.height < top.height <= centre[2] + MOST_ABOVE and top.depth(centre[:2]) >= 0.0:
                found = Ground(body.name, top.height, top=top, fixed=body.fixed_body)
    return found


def _depth_inside(shape: Shape, position: FloatArray, orientation: FloatArray, point: FloatArray) -> float:
    """Return the distance [m] by which a point ``(3,)`` must move to leave a body, but not downwards.

    The distance is negative outside.
    """
    local, down = rotate(quaternion_conjugate(orientation), np.array([point - position, [0.0, 0.0, -1.0]]))
    depths = []
    for hull in hulls_of(shape):
        planes = face_planes(hull)
        heights = planes[:, :3] @ local + planes[:, 3]
        sideways = planes[:, :3] @ down < _DOWNWARDS
        depths.append(-float(heights.max() if heights.max() > 0.0 else heights[sideways].max()))
    return max(depths)


def _metres(length: float) -> str:
    return f"{round(float(length), 4):g}"
