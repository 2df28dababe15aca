"""Batched sums of products of components, such as products of quaternions, in few calls of numpy."""

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.motion.arrays import FloatArray

IntArray = NDArray[np.intp]


def sums(*rows: dict[tuple[int, int], float]) -> tuple[IntArray, IntArray, FloatArray]:
    """Return the table for `products`: the component of either factor in each product, and weights, a column per sum.

    Args:
        rows: for each sum, (component of one factor, component of the other) to the weight of their product.
    """
    pairs = sorted({pair for row in rows for pair in row})
    weights = np.array([[row.get(pair, 0.0) for row in rows] for pair in pairs])
    return np.array([one for one, _ in pairs]), np.array([other for _, other in pairs]), weights


HAMILTON = sums(
    {(3, 0): 1.0, (0, 3): 1.0, (1, 2): 1.0, (2, 1): -1.0},
    {(3, 1): 1.0, (1, 3): 1.0, (2, 0): 1.0, (0, 2): -1.0},
    {(3, 2): 1.0, (2, 3): 1.0, (0, 1): 1.0, (1, 0): -1.0},
    {(3, 3): 1.0, (0, 0): -1.0, (1, 1): -1.0, (2, 2): -1.0},
)
TURN = sums(
    {(1, 1): -2.0, (2, 2): -2.0},
    {(0, 1): 2.0, (2, 3): -2.0},
    {(0, 2): 2.0, (1, 3): 2.0},
    {(0, 1): 2.0, (2, 3): 2.0},
    {(0, 0): -2.0, (2, 2): -2.0},
    {(1, 2): 2.0, (0, 3): -2.0},
    {(0, 2): 2.0, (1, 3): -2.0},
    {(1, 2): 2.0, (0, 3): 2.0},
    {(0, 0): -2.0, (1, 1): -2.0},
)
"""The matrix of a rotation minus the identity, row by row, from products of the quaternion with itself."""
EACH_ROW, ROW_SUMS = np.tile(np.arange(3), 3), np.kron(np.eye(3), np.ones((3, 1)))
"""Multiplication of that matrix by a vector: the vector's component at each element, and the sum of each row."""


def products(a: FloatArray, b: FloatArray, table: tuple[IntArray, IntArray, FloatArray]) -> FloatArray:
    """Return sums of products of components, by one multiplication and one matrix product for a whole batch."""
    one, other, weights = table
    return np.asarray((a.take(one, -1) * b.take(other, -1)) @ weights)
