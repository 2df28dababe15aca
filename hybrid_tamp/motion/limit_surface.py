"""Return mapping of a wrench onto a limit surface, for a contact that sticks or slides.

A wrench ``(fx, fy, fz, tx, ty, tz)`` has four components that friction bears. The squeeze bears the other two.
Friction obeys the ellipsoid of Howe and Cutkosky 1996, "Practical force-motion models for sliding manipulation", which
approximates the limit surface of Goyal, Ruina and Papadopoulos 1991, "Planar sliding with dry friction, part 1"::

    (fx / lx)^2 + (fy / ly)^2 + (tx / mx)^2 + (tz / mz)^2 <= 1,     |fz| <= lz,     |ty| <= my
"""

import numpy as np

from hybrid_tamp.motion.arrays import FloatArray

RUBBED = [0, 1, 3, 5]
"""Components of a wrench that friction bears."""
SQUEEZED = [2, 4]
"""Components of a wrench that the squeeze of the fingers bears."""
_SWEEPS = 100
_NEWTON_STEPS = 30
_TOLERANCE = 1e-9


def load_ratio(wrench: FloatArray, limits: FloatArray) -> FloatArray:
    """Return the ratio ``(...)`` of a wrench ``(..., 6)`` to the limit surface: 1 on the surface, less within it.

    Args:
        wrench: forces [N] and torques [N m].
        limits: the semi-axes of the limit surface ``(..., 6)``.
    """
    shares = np.abs(wrench) / limits
    rubbed = np.sqrt(np.square(shares.take(RUBBED, -1)).sum(-1))
    return np.asarray(np.maximum(rubbed, shares.take(SQUEEZED, -1).max(-1)))


def map_back(trial: FloatArray, compliance: FloatArray, limits: FloatArray) -> FloatArray:
    """Return the wrench ``(6,)`` on or within the limit surface that is nearest to a trial wrench ``(6,)``.

    The nearest wrench minimises ``(w - trial) C (w - trial) / 2``. So the slip ``C (trial - w)`` is normal to the
    surface, as the principle of maximum dissipation requires.

    Args:
        trial: wrench that would prevent all slip, in [N] and [N m].
        compliance: symmetric positive definite matrix C ``(6, 6)``.
        limits: the semi-axes of the limit surface ``(6,)``, all positive.
    """
    along, across, closing, about, over, spun = (trial / limits).tolist()
    rubbed = along * along + across * across + about * about + spun * spun
    if rubbed <= 1.0 and -1.0 <= closing <= 1.0 and -1.0 <= over <= 1.0:
        return trial
    wrench = np.clip(trial, -limits, limits)
    for _ in range(_SWEEPS):
        before = wrench.copy()
        for index in SQUEEZED:
            pulled = compliance[index] @ (wrench - trial) / compliance[index, index]
            wrench[index] = np.clip(wrench[index] - pulled, -limits[index], limits[index])
        between = compliance[np.ix_(RUBBED, SQUEEZED)] @ (wrench[SQUEEZED] - trial[SQUEEZED])
        inner = compliance[np.ix_(RUBBED, RUBBED)]
        free = trial[RUBBED] - np.linalg.solve(inner, between)
        wrench[RUBBED] = _onto_ellipsoid(free, inner, limits[RUBBED])
        if np.all(np.abs(wrench - before) <= _TOLERANCE * limits):
            break
    return wrench


def _onto_ellipsoid(free: FloatArray, metric: FloatArray, axes: FloatArray) -> FloatArray:
    """Return the point on or within an ellipsoid that is nearest to a point in a metric. All sizes are ``(n,)``."""
    scaled = free / axes
    if scaled @ scaled <= 1.0:
        return free
    weights, modes = np.linalg.eigh(metric * np.outer(axes, axes))
    weights = weights / weights[-1]
    along, multiplier = modes.T @ scaled, 0.0
    for _ in range(_NEWTON_STEPS):
        # Newton's method for 1/|u| = 1, which is nearly linear in the multiplier (as in trust-region methods).
        point = weights * along / (weights + multiplier)
        size = np.sqrt(point @ point)
        slope = point @ (point / (weights + multiplier)) / size**3
        change = (1.0 - 1.0 / size) / slope
        multiplier += change
        if change <= _TOLERANCE * multiplier:
            break
    point = weights * along / (weights + multiplier)
    return np.asarray(axes * (modes @ (point / max(np.sqrt(point @ point), 1.0))))
