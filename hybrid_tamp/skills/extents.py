"""Extents of bodies along directions, and the tops and edges of surfaces. Vectors are in the world frame."""

from functools import lru_cache

import numpy as np

from hybrid_tamp.geometry.shapes import Shape
from hybrid_tamp.geometry.surfaces import hulls_of
from hybrid_tamp.model.extents import corners_of, extent
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import rotate
from hybrid_tamp.skills.vectors import UP, dot, in_body


def reach_along(token: Token, direction: FloatArray) -> float:
    """Return how far [m] a body extends from its origin in a direction ``(3,)`` of the body frame."""
    return float((corners_of(token.solid) @ direction).max())


def height_below(state: State, token: Token) -> FloatArray:
    """Return the height ``(...)`` [m] of a body's origin above the lowest point of the body."""
    return extent(state, token, -UP)


def top_of(state: State, token: Token) -> FloatArray:
    """Return the height ``(...)`` [m] of the highest point of a body above the floor."""
    return np.asarray(state[token, "position"][..., 2] + extent(state, token, UP))


def ground_below(state: State, position: FloatArray, surfaces: tuple[Token, ...]) -> FloatArray:
    """Return the height ``(...)`` [m] of what is below a position ``(..., 3)``: the tops of the surfaces, or the floor.

    The solids of a surface count as boxes in the frame of the surface, which must be level.
    """
    ground = np.zeros(position.shape[:-1])
    for surface in surfaces:
        local = in_body(state, surface, position)
        for lower, upper in _boxes(surface.solid):
            over = ((local >= lower) & (local <= upper))[..., :2].all(axis=-1)
            top = state[surface, "position"][..., 2] + upper[2]
            ground = np.where(over & (top <= position[..., 2]), np.maximum(ground, top), ground)
    return ground


@lru_cache(maxsize=256)
def _boxes(shape: Shape) -> tuple[tuple[FloatArray, FloatArray], ...]:
    """Return the lower and upper corners of the bounding box of each solid, in the body frame [m]."""
    return tuple((hull.vertices.min(axis=0), hull.vertices.max(axis=0)) for hull in hulls_of(shape))


def depth_over(state: State, thing: Token, surface: Token) -> FloatArray:
    """Return the horizontal depth ``(...)`` [m] of a body's origin within the outline of a level surface."""
    corners = corners_of(surface.solid)[:, :2]
    local = in_body(state, surface, state[thing, "position"])[..., :2]
    return np.asarray(np.minimum(corners.max(axis=0) - local, local - corners.min(axis=0)).min(axis=-1))


def depth_within(state: State, thing: Token, container: Token) -> FloatArray:
    """Return the depth ``(...)`` [m] of a body's origin within the outline and below the rim of a level container."""
    below = top_of(state, container) - state[thing, "position"][..., 2]
    return np.asarray(np.minimum(depth_over(state, thing, container), below))


def height_above(state: State, thing: Token, surface: Token) -> FloatArray:
    """Return the height ``(...)`` [m] of the lowest point of a body above the top of a level surface."""
    return np.asarray(state[thing, "position"][..., 2] - height_below(state, thing) - top_of(state, surface))


def edge_towards(state: State, surface: Token, place: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the edge of a level box that faces a place ``(..., 3)``.

    Returns:
        The outward horizontal normal of the edge ``(..., 3)``, and the distance ``(...)`` [m] from the centre of the
        surface to the edge.
    """
    offset = in_body(state, surface, place)[..., :2]
    halves = np.ptp(corners_of(surface.solid), axis=0)[:2] / 2.0
    beyond = np.abs(offset) - halves
    first = beyond[..., 0] >= beyond[..., 1]
    sign = np.where(offset < 0, -1.0, 1.0)
    x, y = np.where(first, sign[..., 0], 0.0), np.where(first, 0.0, sign[..., 1])
    normal = rotate(state[surface, "orientation"], np.stack([x, y, np.zeros_like(x)], axis=-1))
    return normal, np.where(first, halves[0], halves[1])


def distance_to_edge(state: State, thing: Token, surface: Token, normal: FloatArray, half: FloatArray) -> FloatArray:
    """Return the distance ``(...)`` [m] of a body's origin from an edge of a surface (see `edge_towards`)."""
    return half - dot(state[thing, "position"] - state[surface, "position"], normal)
