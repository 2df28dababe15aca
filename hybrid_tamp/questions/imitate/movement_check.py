"""Comparison of an observed movement with a rollout of a block's policy on the block's forward model.

If the movement has more pauses than the rollout, several blocks probably produced the movement. If the observed path is
much longer than the path in the rollout, the block did not produce the movement.
"""

from itertools import pairwise

import numpy as np

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.control import CONTROL_PERIOD
from hybrid_tamp.model.expectation import declared_duration
from hybrid_tamp.model.forward_model import roll_out
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.questions.imitate.observation import Observation, Truth

_SLOW = 0.03
"""Speed below which a token is treated as pausing, in m/s."""
_SHORTEST = 0.12
"""Minimum duration of a pause, in seconds."""
_SPAN = 0.05
"""Sampling period for measuring the length of a path, in seconds."""
_LONGER = (1.5, 0.1)
"""Pair of (factor, offset in metres). The longest allowed path is the expected length times factor, plus offset."""
_CHECK_EVERY = 12
"""Number of control periods between two tests of a block's exit conditions in a rollout."""
_PATIENCE = 2.0
"""Longest duration of a rollout, as a multiple of the block's expected duration."""


def count_pauses(speeds: FloatArray, period: float, slow: float = _SLOW) -> int:
    """Count the pauses between movements.

    Args:
        speeds: speed of the fastest token in each row, in m/s. Shape ``(t,)``.
        period: time between two rows, in seconds.
        slow: speed below which a token is treated as pausing, in m/s.
    """
    still: Truth = speeds < slow
    ends = [0, *(np.flatnonzero(np.diff(still.astype(int))) + 1).tolist(), len(still)]
    inner = [(a, b) for a, b in pairwise(ends) if still[a] and a > 0 and b < len(still)]
    return sum((b - a) * period >= _SHORTEST for a, b in inner)


def measure_length(positions: FloatArray, period: float) -> float:
    """Return the length of the longest path among the tokens, in metres.

    ``positions`` is in metres and has shape ``(t, tokens, 3)``, with ``period`` seconds between two rows.
    """
    stride = max(1, round(_SPAN / period))
    corners = np.concatenate([positions[::stride], positions[-1:]])
    return float(np.linalg.norm(np.diff(corners, axis=0), axis=-1).sum(axis=0).max())


def count_unexpected_pauses(block: Block, binding: Binding, seen: Observation, start: int, reached: int) -> int | None:
    """Return the number of pauses beyond those in the block's rollout, or None if the observed path is too long."""
    moved = [str(getattr(binding[slot], "name", "")) for slot, written in block.writes.items() if "position" in written]
    if not moved or block.policy is None:
        return 0
    positions = np.stack([seen.trajectory[token, "position"][start : reached + 1] for token in moved], axis=1)
    period = float(seen.times[1] - seen.times[0])
    velocities = np.stack([seen.trajectory[token, "velocity"][start : reached + 1] for token in moved], axis=1)
    noise = max(float(np.linalg.norm(seen.deviation[token, "velocity"])) for token in moved)
    found, way = count_pauses(_fastest(velocities), period, _SLOW + noise), measure_length(positions, period)
    if not found and way <= _too_long(float(np.linalg.norm(positions[-1] - positions[0], axis=-1).max())):
        return 0
    begin = seen.state(start)
    initial = block.initial_values(binding, begin)
    expected = declared_duration(block, binding, begin, initial)
    longest = np.inf if expected is None else _PATIENCE * expected
    states = roll_out(block, binding, begin, min(block.duration.maximum, longest), every=_CHECK_EVERY)
    own, speeds = (np.stack([[state[t, name] for t in moved] for state in states]) for name in ("position", "velocity"))
    if way > _too_long(measure_length(own, CONTROL_PERIOD)):
        return None
    return max(0, found - count_pauses(_fastest(speeds), CONTROL_PERIOD))


def _fastest(velocities: FloatArray) -> FloatArray:
    """Return the speed of the fastest token, shape ``(t,)``, from velocities of shape ``(t, tokens, 3)``."""
    return np.asarray(np.linalg.norm(velocities, axis=-1).max(axis=-1))


def _too_long(way: float) -> float:
    return _LONGER[0] * way + _LONGER[1]
