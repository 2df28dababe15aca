"""Batched sums of products of components, e.g. products of quaternions, with few calls of numpy."""

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.motion.arrays import FloatArray

IntArray = NDArray[np.intp]


def sums(*rows: dict[tuple[int, int], float]) -> tuple[IntArray, IntArray, FloatArray]:
    """Return the table that `products` needs to compute the given sums of products.

    Args:
        rows: one mapping per sum. Maps each pair of (first component, second component) to the weight of the product.

    Returns:
        First components of all products, second components, and weights with one column per sum.
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
"""Table for the rotation matrix minus the identity, row by row. Both factors must be the same quaternion."""
EACH_ROW, ROW_SUMS = np.tile(np.arange(3), 3), np.kron(np.eye(3), np.ones((3, 1)))
"""Indices of the vector components that multiply the elements of the `TURN` result, and a matrix for row sums."""


def products(a: FloatArray, b: FloatArray, table: tuple[IntArray, IntArray, FloatArray]) -> FloatArray:
    """Return sums of products of components for a batch, with one multiplication and one matrix product."""
    one, other, weights = table
    return np.asarray((a.take(one, -1) * b.take(other, -1)) @ weights)
