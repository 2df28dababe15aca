"""A movement compared with the block's own policy on its own forward model, from the same start.

If the movement has more pauses, several blocks made it; if its path is much longer, no block of this kind made it.
"""

from itertools import pairwise

import numpy as np

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.control import CONTROL_PERIOD
from hybrid_tamp.model.forward_model import roll_out
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.questions.imitate.observation import Observation, Truth

_SLOW = 0.03
"""A token that is slower than this pauses [m/s]."""
_SHORTEST = 0.12
"""Least duration of a pause [s]."""
_SPAN = 0.05
"""Between samples this far apart the length of a path is measured [s]."""
_LONGER = (1.5, 0.1)
"""A path is too long if it exceeds this multiple of the expected length by this much [m]."""
_CHECK_EVERY = 12
"""After so many control periods the exit conditions of a block are measured."""
_PATIENCE = 2.0
"""By which factor a block may exceed its expected duration in its own forward model."""


def pauses(speeds: FloatArray, period: float, slow: float = _SLOW) -> int:
    """Return how often tokens pause between two movements.

    Args:
        speeds: of the fastest token at a constant rate, shape ``(t,)`` [m/s].
        period: between two rows [s].
        slow: slower than this it pauses [m/s].
    """
    still: Truth = speeds < slow
    ends = [0, *(np.flatnonzero(np.diff(still.astype(int))) + 1).tolist(), len(still)]
    inner = [(a, b) for a, b in pairwise(ends) if still[a] and a > 0 and b < len(still)]
    return sum((b - a) * period >= _SHORTEST for a, b in inner)


def length(positions: FloatArray, period: float) -> float:
    """Return the length of the longest path of a token [m].

    Args:
        positions: of the tokens at a constant rate, shape ``(t, tokens, 3)`` [m].
        period: between two rows [s].
    """
    stride = max(1, round(_SPAN / period))
    corners = np.concatenate([positions[::stride], positions[-1:]])
    return float(np.linalg.norm(np.diff(corners, axis=0), axis=-1).sum(axis=0).max())


def unexpected_pauses(block: Block, binding: Binding, seen: Observation, start: int, reached: int) -> int | None:
    """Return how many more pauses are seen than the block makes, or None if its path is not that long."""
    moved = [str(getattr(binding[slot], "name", "")) for slot, written in block.writes.items() if "position" in written]
    if not moved or block.policy is None:
        return 0
    positions = np.stack([seen.trajectory[token, "position"][start : reached + 1] for token in moved], axis=1)
    period = float(seen.times[1] - seen.times[0])
    velocities = np.stack([seen.trajectory[token, "velocity"][start : reached + 1] for token in moved], axis=1)
    noise = max(float(np.linalg.norm(seen.deviation[token, "velocity"])) for token in moved)
    found, way = pauses(_fastest(velocities), period, _SLOW + noise), length(positions, period)
    straight = float(np.linalg.norm(positions[-1] - positions[0], axis=-1).max())
    if not found and way <= _too_long(straight):
        return 0
    states = _roll_out(block, binding, seen.state(start))
    own, speeds = (np.stack([[state[t, name] for t in moved] for state in states]) for name in ("position", "velocity"))
    if way > _too_long(length(own, CONTROL_PERIOD)):
        return None
    return max(0, found - pauses(_fastest(speeds), CONTROL_PERIOD))


def _fastest(velocities: FloatArray) -> FloatArray:
    """Return the speed of the fastest of some tokens ``(t,)`` from their velocities ``(t, tokens, 3)``."""
    return np.asarray(np.linalg.norm(velocities, axis=-1).max(axis=-1))


def _too_long(way: float) -> float:
    return _LONGER[0] * way + _LONGER[1]


def _roll_out(block: Block, binding: Binding, start: State) -> list[State]:
    expected = block.duration.expected(binding, start, block.initial_values(binding, start))
    longest = min(block.duration.maximum, _PATIENCE * expected)
    return roll_out(block, binding, start, longest, every=_CHECK_EVERY)
