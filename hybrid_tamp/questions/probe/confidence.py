"""What so many successes of so many trials say."""

from math import sqrt

_Z = 1.959963984540054
"""Quantile of the normal distribution for an interval of 95 %."""


def wilson_interval(successes: int, trials: int) -> tuple[float, float]:
    """Return the 95 % confidence interval of a success rate (Wilson 1927).

    Args:
        successes: how many trials succeeded.
        trials: how many there were; of none the interval is all from 0 to 1.
    """
    if trials == 0:
        return 0.0, 1.0
    rate, spread = successes / trials, _Z**2 / trials
    middle = rate + spread / 2.0
    half = _Z * sqrt(rate * (1.0 - rate) / trials + spread / (4.0 * trials))
    low, high = (middle - half) / (1.0 + spread), (middle + half) / (1.0 + spread)
    return max(0.0, low) if successes else 0.0, min(1.0, high) if successes < trials else 1.0
