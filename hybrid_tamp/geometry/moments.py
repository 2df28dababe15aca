"""Moments of inertia that a rigid body within a shape can have.

A body of mass m has the second moments ``S = E[x x^T]`` over its mass distribution, with ``E[x] = 0`` at the centre of
mass. Its principal moments of inertia are ``I_x = m (S_yy + S_zz)`` and so on, so no moment exceeds the sum of the
other two. A sum of ``S_xx``, ``S_yy`` and ``S_zz`` with positive weights is convex in the positions of the mass. The
largest sums therefore belong to distributions of the mass over the vertices of the shape's convex hull.
"""

import numpy as np

from hybrid_tamp.geometry.convex import ConvexBody
from hybrid_tamp.geometry.gaps import distance_to_point
from hybrid_tamp.geometry.shapes import Shape
from hybrid_tamp.geometry.surfaces import points_of
from hybrid_tamp.motion.arrays import FloatArray

MOST_VERTICES = 2000
"""Number of points above which only the vertices of their convex hull are used."""


def second_moments(inertia: FloatArray, mass: float) -> FloatArray:
    """Return ``E[x^2]``, ``E[y^2]`` and ``E[z^2]`` ``(3,)`` [m^2] of a body with the principal moments [kg m^2]."""
    return np.asarray((inertia.sum() / 2.0 - inertia) / mass)


def largest_share(shape: Shape, inertia: FloatArray, mass: float) -> float:
    """Return the largest factor t for which a body within the shape can have t times the given moments of inertia.

    The mass can be distributed over the convex hull of the shape in any way whose centre of mass is the origin of the
    body frame. The result is the optimum of a linear program over the shares of the mass at the hull's vertices.

    Args:
        shape: shape of the body. The origin of the body frame must be within the convex hull.
        inertia: principal moments of inertia about the body's axes ``(3,)`` [kg m^2], without a moment that exceeds the
            sum of the other two.
        mass: mass [kg].
    """
    from scipy.optimize import linprog

    points = _vertices(shape)
    size = float(np.abs(points).max())
    scaled = points / size
    wanted = np.maximum(second_moments(inertia, mass), 0.0)
    unit = float(wanted.max())
    count = len(points)
    # The variables are the shares of the mass at the points, and the factor.
    equal = np.column_stack([np.vstack([np.ones(count), scaled.T]), np.zeros(4)])
    least = np.column_stack([-np.square(scaled).T, wanted / unit])
    goal = np.append(np.zeros(count), -1.0)
    found = linprog(goal, least, np.zeros(3), equal, [1.0, 0.0, 0.0, 0.0])
    assert found.status == 0, f"linear program of the moments of inertia: {found.message}"
    return float(-found.fun) * size**2 / unit


def _vertices(shape: Shape) -> FloatArray:
    from scipy.spatial import ConvexHull

    points = points_of(shape)
    return points if len(points) <= MOST_VERTICES else points[ConvexHull(points).vertices]


def distance_outside(shape: Shape) -> float:
    """Return the distance [m] of the origin of the body frame from the convex hull of a shape, which is 0 inside."""
    points = points_of(shape)
    hull = ConvexBody(np.zeros(3), 0.0, 0.0, np.zeros(3), np.eye(3), points)
    return distance_to_point(hull, np.zeros(3))
