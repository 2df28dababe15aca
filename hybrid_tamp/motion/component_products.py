"""Weighted sums of products of vector components, computed for a whole batch by few calls of numpy.

For example, each component of a quaternion product is a sum of this form.
"""

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.motion.arrays import FloatArray

IntArray = NDArray[np.intp]


def sums(*rows: dict[tuple[int, int], float]) -> tuple[IntArray, IntArray, FloatArray]:
    """Return the table that `products` needs to compute the given sums of products.

    Args:
        rows: one mapping for each sum. Maps each pair (component of a, component of b) to the weight of their product.

    Returns:
        Three arrays: the component of a in each product, the component of b, and the weights with one column per sum.
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
"""Table whose sums are the elements of the rotation matrix minus the identity. Both vectors are the same quaternion."""
EACH_ROW, ROW_SUMS = np.tile(np.arange(3), 3), np.kron(np.eye(3), np.ones((3, 1)))
"""Column of each of the nine elements of a 3 x 3 matrix, and the matrix that sums the elements of each row."""


def products(a: FloatArray, b: FloatArray, table: tuple[IntArray, IntArray, FloatArray]) -> FloatArray:
    """Return the sums that the table defines for the vectors a and b, shape ``(..., number of sums)``."""
    one, other, weights = table
    return np.asarray((a.take(one, -1) * b.take(other, -1)) @ weights)
