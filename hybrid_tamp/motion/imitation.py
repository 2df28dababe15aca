"""Fit the weights of a movement primitive to demonstrations by linear least squares on positions."""

from collections.abc import Iterable, Sequence

import numpy as np

from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.transformation_system import TransformationSystem

Demonstration = tuple[FloatArray, FloatArray]
"""Times [s], shape ``(t,)``, and positions [m], shape ``(t, d)``."""

SETTLE = 0.1
"""Settling time after a movement, as a part of its duration."""

_SMOOTHNESS = 3e-3
_END_EMPHASIS = np.array([[300.0], [30.0]])


def fitted_weights(system: TransformationSystem, demonstrations: Sequence[Demonstration]) -> FloatArray:
    """Return the weights whose movements are closest to all demonstrations together.

    A movement is linear in the weights, so that the positions themselves can be fitted. The usual fit to the
    forcing term (Ijspeert et al. 2013, Sec. 2.1.3) needs the demonstration's acceleration, whose second
    differences amplify the noise of a recording.

    Args:
        system: the spring and the basis.
        demonstrations: checked demonstrations of equal d.

    Returns:
        Weights [m], shape ``(k, d)``.
    """
    equations = [_equations(system, demonstration) for demonstration in demonstrations]
    design, target = (np.concatenate(rows) for rows in zip(*equations, strict=True))
    # A basis function acts through s, at its centre. In units of that, a weak penalty keeps the forcing term
    # smooth; it matters only if there are fewer samples than weights.
    centres = system.centres()
    roughness = _SMOOTHNESS * np.diff(np.eye(system.n_weights), 2, axis=0)
    design = np.concatenate([design / centres, roughness])
    target = np.concatenate([target, np.zeros((len(roughness), target.shape[1]))])
    solution = np.linalg.lstsq(design, target, rcond=None)[0]
    return np.asarray(solution / centres[:, None])


def _equations(system: TransformationSystem, demonstration: Demonstration) -> tuple[FloatArray, FloatArray]:
    """Return the design matrix ``(n, k)`` and the targets ``(n, d)`` of one demonstration."""
    time, positions = demonstration
    # The final position is held for the settling time, so that the fading there starts nearly at rest.
    n_held = max(2, round(SETTLE * len(time)))
    normalised = np.minimum((time - time[0]) / (time[-1] - time[0]), 1.0)
    normalised = np.append(normalised, 1.0 + SETTLE * np.arange(1, n_held + 1) / n_held)
    held = np.concatenate([positions, np.repeat(positions[-1:], n_held, axis=0)])
    span = positions[-1] - positions[0]
    responses = system.combined(system.responses_to_inputs(normalised))
    target = held - positions[0] - responses[:, 0, :1] * span
    # Large weights nearly fix position and velocity at the end, where the hand reaches its goal.
    at_end = responses[len(time) - 1, :2]
    end_target = (np.array([[1.0], [0.0]]) - at_end[:, :1]) * span
    design = np.concatenate([responses[:, 0, 1:], _END_EMPHASIS * at_end[:, 1:]])
    return design, np.concatenate([target, _END_EMPHASIS * end_target])


def checked_demonstrations(
    time: FloatArray | Sequence[FloatArray], positions: FloatArray | Sequence[FloatArray]
) -> list[Demonstration]:
    """Return one or more demonstrations as a list, checked.

    Args:
        time: times [s], shape ``(t,)``; or one such array per demonstration.
        positions: positions [m], shape ``(t, d)``; or one such array per demonstration.

    Returns:
        The demonstrations.

    Raises:
        ValueError: a demonstration has fewer than 5 samples, its time does not increase, a value is not
            finite or the shapes do not match.
    """
    single = len(time) == 0 or np.ndim(time[0]) == 0
    pairs: Iterable[tuple[object, object]] = [(time, positions)]
    if not single:
        if len(time) != len(positions):
            raise ValueError(f"got {len(time)} arrays of times, but {len(positions)} arrays of positions")
        pairs = zip(time, positions, strict=True)
    checked = [_checked(times, samples, number) for number, (times, samples) in enumerate(pairs, start=1)]
    sizes = {samples.shape[1] for _, samples in checked}
    if len(sizes) > 1:
        raise ValueError(f"the demonstrations differ in their number of dimensions: {sorted(sizes)}")
    return checked


def _checked(time: object, positions: object, number: int) -> Demonstration:
    """Return one demonstration as arrays, or raise a ``ValueError`` that says what is wrong."""
    times, samples = np.array(time, dtype=np.float64), np.array(positions, dtype=np.float64)
    where = f"demonstration {number}"
    if times.ndim != 1 or samples.ndim != 2 or len(times) != len(samples) or samples.shape[1] == 0:
        raise ValueError(
            f"{where}: time must have shape (t,) and positions (t, d), got {times.shape} and {samples.shape}"
        )
    if len(times) < 5:
        raise ValueError(f"{where}: need at least 5 samples, got {len(times)}")
    if not (np.all(np.isfinite(times)) and np.all(np.isfinite(samples))):
        raise ValueError(f"{where}: times and positions must be finite")
    if not np.all(np.diff(times) > 0.0):
        row = int(np.argmin(np.diff(times) > 0.0)) + 1
        raise ValueError(f"{where}: time must strictly increase, but sample {row} is at {times[row]} s")
    return times, samples
