"""Sizes of tokens in pictures: bounding boxes, bounding spheres, and discs of tokens without a shape."""

import numpy as np

from hybrid_tamp.geometry.convex import reach_of
from hybrid_tamp.geometry.shapes import solids_of
from hybrid_tamp.geometry.triangles import placed_solid
from hybrid_tamp.model.state import State
from hybrid_tamp.model.support import MOST_ABOVE
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray

_DISC = 0.05


def bounding_box(token: Token) -> tuple[FloatArray, FloatArray]:
    """Return the centre and the half extents of a token's bounding box in its body frame, each ``(3,)`` [m]."""
    vertices = np.concatenate([placed_solid(each).vertices for each in solids_of(token.solid)])
    lower, upper = vertices.min(axis=0), vertices.max(axis=0)
    return (lower + upper) / 2, (upper - lower) / 2


def bounding_radius(token: Token) -> float:
    """Return the radius [m] of a sphere about a token's origin that contains the token, or its disc."""
    return disc_radius(token) if token.shape is None else reach_of(token.shape)


def is_raised(state: State, token: Token) -> bool:
    """Return whether a token without a shape is a disc above the floor, e.g. on a table."""
    return token.shape is None and float(state[token, "position"][2]) > MOST_ABOVE


def disc_radius(token: Token) -> float:
    """Return the radius [m] of the disc that is drawn for a token without a shape."""
    radius = token.properties.get("radius", _DISC)
    return float(radius)
