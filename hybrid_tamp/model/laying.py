"""Discs that lie on the floor or on the level top of a fixed body."""

from collections.abc import Iterable

import numpy as np

from hybrid_tamp.geometry.common_volume import face_planes
from hybrid_tamp.geometry.shapes import Shape
from hybrid_tamp.geometry.surfaces import hulls_of
from hybrid_tamp.geometry.tops import find_tops
from hybrid_tamp.model.ground import ON_FLOOR, Ground
from hybrid_tamp.model.state import State
from hybrid_tamp.model.support import MOST_ABOVE
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
    centre, kind = state[disc, "position"], disc.classes[0].name
    fixed = [token for token in tokens if token.fixed_body and token is not disc]
    below = _find_below(fixed, state, centre)
    for body in fixed:
        depth = _depth_inside(body.solid, state[body, "position"], state[body, "orientation"], centre + _OVER)
        if depth > 0.0:
            return f"the centre of the disc is inside {body.name}, {_metres(depth)} m below its surface"
    above = float(centre[2]) - below.height
    if above < -MOST_ABOVE:
        return f"a {kind} must not be below the floor (z = 0), but it is at z = {_metres(centre[2])} m"
    if above > MOST_ABOVE:
        wanted = f"a {kind} must lie on the floor or on the level top of a fixed body"
        return f"{wanted}, but it is {_metres(above)} m above {below.text}"
    beyond = radius - float(below.depth(centre[:2]))
    if beyond > MOST_ABOVE:
        return f"the disc reaches {_metres(beyond)} m beyond the edge of {below.text}"
    return None


_OVER = np.array([0.0, 0.0, 2.0 * MOST_ABOVE])
"""Vector from the centre of a disc to a point that must be outside all fixed bodies [m]."""


def _find_below(fixed: Iterable[Token], state: State, centre: FloatArray) -> Ground:
    """Return the highest level top below a point ``(3,)`` [m], or the floor."""
    found = ON_FLOOR
    for body in fixed:
        for top in find_tops(body.solid, state[body, "position"], state[body, "orientation"]):
            if found.height < top.height <= centre[2] + MOST_ABOVE and top.depth(centre[:2]) >= 0.0:
                found = Ground(body.name, top.height, top=top)
    return found


def _depth_inside(shape: Shape, position: FloatArray, orientation: FloatArray, point: FloatArray) -> float:
    """Return how deep [m] a point ``(3,)`` is inside a body. The depth is negative outside."""
    local = rotate(quaternion_conjugate(orientation), point - position)
    planes = [face_planes(hull) for hull in hulls_of(shape)]
    return max(-float((each[:, :3] @ local + each[:, 3]).max()) for each in planes)


def _metres(length: float) -> str:
    return f"{round(float(length), 4):g}"
