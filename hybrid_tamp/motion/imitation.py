"""Linear least-squares fit of a movement primitive's weights to demonstrated positions."""

from collections.abc import Iterable, Sequence

import numpy as np

from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.transformation_system import TransformationSystem

Demonstration = tuple[FloatArray, FloatArray]
"""Pair of times [s], shape ``(t,)``, and positions [m], shape ``(t, d)``."""

SETTLE = 0.1
"""Settling time after a movement, as a fraction of its duration."""

_SMOOTHNESS = 3e-3
_END_EMPHASIS = np.array([[300.0], [30.0]])


def fitted_weights(system: TransformationSystem, demonstrations: Sequence[Demonstration]) -> FloatArray:
    """Return the weights for which the movements of the primitive are closest to all demonstrations.

    A movement is linear in the weights, so the weights are fitted directly to positions. The usual fit to the forcing
    term (Ijspeert et al. 2013, Sec. 2.1.3) requires accelerations, whose computation amplifies measurement noise.

    Args:
        system: spring and basis functions of the primitive.
        demonstrations: checked demonstrations with the same number of dimensions d.

    Returns:
        Weights of the basis functions [m], shape ``(k, d)``.
    """
    equations = [_equations(system, demonstration) for demonstration in demonstrations]
    design, target = (np.concatenate(rows) for rows in zip(*equations, strict=True))
    # Each weight is scaled by s at the centre of its basis function. A weak penalty on second differences of the
    # scaled weights keeps the forcing term smooth. The penalty matters only if there are fewer samples than weights.
    centres = system.centres()
    roughness = _SMOOTHNESS * np.diff(np.eye(system.n_weights), 2, axis=0)
    design = np.concatenate([design / centres, roughness])
    target = np.concatenate([target, np.zeros((len(roughness), target.shape[1]))])
    solution = np.linalg.lstsq(design, target, rcond=None)[0]
    return np.asarray(solution / centres[:, None])


def _equations(system: TransformationSystem, demonstration: Demonstration) -> tuple[FloatArray, FloatArray]:
    """Return the design matrix ``(n, k)`` and the targets ``(n, d)`` of one demonstration."""
    time, positions = demonstration
    # Samples at the final position are added for the settling time, so that the fade-out starts nearly at rest.
    n_held = max(2, round(SETTLE * len(time)))
    normalised = np.minimum((time - time[0]) / (time[-1] - time[0]), 1.0)
    normalised = np.append(normalised, 1.0 + SETTLE * np.arange(1, n_held + 1) / n_held)
    held = np.concatenate([positions, np.repeat(positions[-1:], n_held, axis=0)])
    span = positions[-1] - positions[0]
    responses = system.combined(system.responses_to_inputs(normalised))
    target = held - positions[0] - responses[:, 0, :1] * span
    # The final position and velocity get large weights, because the hand must reach its goal accurately.
    at_end = responses[len(time) - 1, :2]
    end_target = (np.array([[1.0], [0.0]]) - at_end[:, :1]) * span
    design = np.concatenate([responses[:, 0, 1:], _END_EMPHASIS * at_end[:, 1:]])
    return design, np.concatenate([target, _END_EMPHASIS * end_target])


def checked_demonstrations(
    time: FloatArray | Sequence[FloatArray], positions: FloatArray | Sequence[FloatArray]
) -> list[Demonstration]:
    """Check one or more demonstrations and return them as a list.

    Args:
        time: times of the samples [s], shape ``(t,)``, or a sequence with one array for each demonstration.
        positions: positions [m], shape ``(t, d)``, or a sequence with one array for each demonstration.

    Returns:
        Checked demonstrations.

    Raises:
        ValueError: if a demonstration has fewer than 5 samples, if its times do not increase, if a value is not finite,
            or if the shapes do not match.
    """
    single = len(time) == 0 or np.ndim(time[0]) == 0
    pairs: Iterable[tuple[object, object]] = [(time, positions)]
    if not single:
        if len(time) != len(positions):
            raise ValueError(
                f"times and positions must have equal numbers of arrays, got {len(time)} and {len(positions)}"
            )
        pairs = zip(time, positions, strict=True)
    checked = [_checked(times, samples, number) for number, (times, samples) in enumerate(pairs, start=1)]
    sizes = {samples.shape[1] for _, samples in checked}
    if len(sizes) > 1:
        raise ValueError(f"all demonstrations must have the same number of dimensions, got {sorted(sizes)}")
    return checked


def _checked(time: object, positions: object, number: int) -> Demonstration:
    """Return one demonstration as arrays. Raise a ``ValueError`` if the demonstration is invalid."""
    times, samples = np.array(time, dtype=np.float64), np.array(positions, dtype=np.float64)
    where = f"demonstration {number}"
    if times.ndim != 1 or samples.ndim != 2 or len(times) != len(samples) or samples.shape[1] == 0:
        raise ValueError(
            f"{where}: shapes of time and positions must be (t,) and (t, d), got {times.shape} and {samples.shape}"
        )
    if len(times) < 5:
        raise ValueError(f"{where}: must have at least 5 samples, got {len(times)}")
    if not (np.all(np.isfinite(times)) and np.all(np.isfinite(samples))):
        raise ValueError(f"{where}: times and positions must be finite")
    if not np.all(np.diff(times) > 0.0):
        row = int(np.argmin(np.diff(times) > 0.0)) + 1
        raise ValueError(f"{where}: times must strictly increase, but sample {row} is at {times[row]} s")
    return times, samples
