"""Demonstrated movements, and learning of a movement primitive from demonstrations."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.dmp import DMP
from hybrid_tamp.motion.poses import quaternion_conjugate, quaternion_multiply

MINIMAL_SAMPLES = 5
_SMALLEST_WAY = 1e-3
_SHARE = 1


@dataclass(frozen=True, eq=False)
class ShownMovement:
    """A measured movement that starts and ends at rest.

    Attributes:
        source: name of the movement in messages.
        time: increasing times of the samples [s], shape ``(t,)``.
        positions: measured positions [m], shape ``(t, n)``.
        orientations: measured orientations as unit quaternions, shape ``(t, 4)``. None if only positions were measured.
    """

    source: str
    time: FloatArray
    positions: FloatArray
    orientations: FloatArray | None = None

    def way(self, moves: str, dimensions: int) -> tuple[FloatArray, float]:
        """Return the samples from which a primitive is learnt, and their scale.

        Args:
            moves: the quantity to learn, ``position`` or ``orientation``.
            dimensions: 1 to learn the travelled fraction of the movement. Otherwise the number of position components.

        Returns:
            The samples, shape ``(t, dimensions)``, and the scale. For fractions, the scale is the length [m] or the
            angle [rad] of the movement. For positions, the scale is 1.

        Raises:
            ValueError: if the movement lacks the required data or is too short.
        """
        if dimensions != _SHARE:
            if self.positions.shape[1] != dimensions:
                raise ValueError(f"positions must have {dimensions} columns, got {self.positions.shape[1]}")
            return self.positions, 1.0
        travelled = self._turned() if moves == "orientation" else self._travelled()
        if travelled[-1] < _SMALLEST_WAY:
            unit = "rad" if moves == "orientation" else "m"
            raise ValueError(
                f"the movement must cover at least {_SMALLEST_WAY:g} {unit}, got {travelled[-1]:.3g} {unit}"
            )
        return (travelled / travelled[-1])[:, None], float(travelled[-1])

    def _travelled(self) -> FloatArray:
        """Return the length of the path up to each sample [m], shape ``(t,)``."""
        steps = np.linalg.norm(np.diff(self.positions, axis=0), axis=-1)
        return np.concatenate([[0.0], np.cumsum(steps)])

    def _turned(self) -> FloatArray:
        """Return the angle between each orientation and the first orientation [rad], shape ``(t,)``."""
        if self.orientations is None:
            raise ValueError("orientations (columns qx, qy, qz, qw) are required, got only positions")
        turns = quaternion_multiply(self.orientations, quaternion_conjugate(self.orientations[0]))
        return np.asarray(2.0 * np.arctan2(np.linalg.norm(turns[:, :3], axis=-1), np.abs(turns[:, 3])))


def learnt(movements: Sequence[ShownMovement], moves: str, dimensions: int, n_weights: int) -> tuple[DMP, float]:
    """Return the primitive that best imitates all movements, and the error of the fit.

    Args:
        movements: demonstrated movements, at least one.
        moves: ``position`` or ``orientation``, see `ShownMovement.way`.
        dimensions: number of dimensions of the primitive, see `ShownMovement.way`.
        n_weights: number of basis functions.

    Returns:
        The primitive, and the root mean square of its errors at the samples [m, or rad for an orientation].

    Raises:
        ValueError: if a movement cannot be imitated.
    """
    ways = [movement.way(moves, dimensions) for movement in movements]
    times = [movement.time for movement in movements]
    primitive = DMP.imitate(times, [way for way, _ in ways], n_weights)
    squares = []
    for time, (way, unit) in zip(times, ways, strict=True):
        imitated = primitive.trajectory(way[0], way[-1], time[-1] - time[0]).at(time - time[0])[0]
        squares.append(np.sum((unit * (imitated - way)) ** 2, axis=-1))
    return primitive, float(np.sqrt(np.mean(np.concatenate(squares))))
