"""Compares a movement with the block's own policy on the block's forward model, from the same start.

If the movement has more pauses, several blocks made it. If its path is much longer, this block did not make it.
"""

from itertools import pairwise

import numpy as np

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.control import CONTROL_PERIOD
from hybrid_tamp.model.forward_model import roll_out
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.questions.imitate.observation import Observation, Truth

_SLOW = 0.03
"""Speed below which a token pauses [m/s]."""
_SHORTEST = 0.12
"""Least duration of a pause [s]."""
_SPAN = 0.05
"""Time between the samples that measure the length of a path [s]."""
_LONGER = (1.5, 0.1)
"""A path is too long if it exceeds the expected length times the first by the second [m]."""
_CHECK_EVERY = 12
"""Number of control periods between measurements of a block's exit conditions."""
_PATIENCE = 2.0
"""Factor by which a block may exceed its expected duration in its own forward model."""


def count_pauses(speeds: FloatArray, period: float, slow: float = _SLOW) -> int:
    """Count the pauses between movements.

    Args:
        speeds: speed of the fastest token at a constant rate, shape ``(t,)`` [m/s].
        period: time between two rows [s].
        slow: speed below which it pauses [m/s].
    """
    still: Truth = speeds < slow
    ends = [0, *(np.flatnonzero(np.diff(still.astype(int))) + 1).tolist(), len(still)]
    inner = [(a, b) for a, b in pairwise(ends) if still[a] and a > 0 and b < len(still)]
    return sum((b - a) * period >= _SHORTEST for a, b in inner)


def measure_length(positions: FloatArray, period: float) -> float:
    """Return the length of the longest path of a token [m].

    Args:
        positions: positions of the tokens at a constant rate, shape ``(t, tokens, 3)`` [m].
        period: time between two rows [s].
    """
    stride = max(1, round(_SPAN / period))
    corners = np.concatenate([positions[::stride], positions[-1:]])
    return float(np.linalg.norm(np.diff(corners, axis=0), axis=-1).sum(axis=0).max())


def count_unexpected_pauses(block: Block, binding: Binding, seen: Observation, start: int, reached: int) -> int | None:
    """Return the number of pauses that the block itself does not make, or None if the path is too long for it."""
    moved = [str(getattr(binding[slot], "name", "")) for slot, written in block.writes.items() if "position" in written]
    if not moved or block.policy is None:
        return 0
    positions = np.stack([seen.trajectory[token, "position"][start : reached + 1] for token in moved], axis=1)
    period = float(seen.times[1] - seen.times[0])
    velocities = np.stack([seen.trajectory[token, "velocity"][start : reached + 1] for token in moved], axis=1)
    noise = max(float(np.linalg.norm(seen.deviation[token, "velocity"])) for token in moved)
    found, way = count_pauses(_fastest(velocities), period, _SLOW + noise), measure_length(positions, period)
    straight = float(np.linalg.norm(positions[-1] - positions[0], axis=-1).max())
    if not found and way <= _too_long(straight):
        return 0
    begin = seen.state(start)
    expected = block.duration.expected(binding, begin, block.initial_values(binding, begin))
    longest = min(block.duration.maximum, _PATIENCE * expected)
    states = roll_out(block, binding, begin, longest, every=_CHECK_EVERY)
    own, speeds = (np.stack([[state[t, name] for t in moved] for state in states]) for name in ("position", "velocity"))
    if way > _too_long(measure_length(own, CONTROL_PERIOD)):
        return None
    return max(0, found - count_pauses(_fastest(speeds), CONTROL_PERIOD))


def _fastest(velocities: FloatArray) -> FloatArray:
    """Return the speed of the fastest of some tokens ``(t,)`` from their velocities ``(t, tokens, 3)``."""
    return np.asarray(np.linalg.norm(velocities, axis=-1).max(axis=-1))


def _too_long(way: float) -> float:
    return _LONGER[0] * way + _LONGER[1]
