"""Demonstrated movements, and the primitive that is learnt from them."""

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
    """One measured movement from rest to rest.

    Attributes:
        source: name of the movement in messages.
        time: times of the samples [s], shape ``(t,)``, increasing.
        positions: positions [m], shape ``(t, n)``.
        orientations: unit quaternions, shape ``(t, 4)``, or None if only positions were measured.
    """

    source: str
    time: FloatArray
    positions: FloatArray
    orientations: FloatArray | None = None

    def way(self, moves: str, dimensions: int) -> tuple[FloatArray, float]:
        """Return the samples for a primitive, and their scale.

        Args:
            moves: ``position`` or ``orientation``.
            dimensions: dimensions of the primitive: 1 for the travelled share of the path's length or of the angle;
                otherwise the samples are the positions.

        Returns:
            The samples ``(t, dimensions)`` and, for a share, the length [m] or angle [rad] of the movement, else 1.

        Raises:
            ValueError: the movement lacks the required data; the message says which.
        """
        if dimensions != _SHARE:
            if self.positions.shape[1] != dimensions:
                raise ValueError(f"{dimensions} columns of positions are needed, it has {self.positions.shape[1]}")
            return self.positions, 1.0
        travelled = self._turned() if moves == "orientation" else self._travelled()
        if travelled[-1] < _SMALLEST_WAY:
            unit = "rad" if moves == "orientation" else "m"
            raise ValueError(
                f"it must move by at least {_SMALLEST_WAY:g} {unit}, it moves by {travelled[-1]:.3g} {unit}"
            )
        return (travelled / travelled[-1])[:, None], float(travelled[-1])

    def _travelled(self) -> FloatArray:
        """Return the path's length up to each sample ``(t,)`` [m]."""
        steps = np.linalg.norm(np.diff(self.positions, axis=0), axis=-1)
        return np.concatenate([[0.0], np.cumsum(steps)])

    def _turned(self) -> FloatArray:
        """Return the angle between each orientation and the first ``(t,)`` [rad]."""
        if self.orientations is None:
            raise ValueError("orientations are needed (columns qx, qy, qz, qw), it has positions only")
        turns = quaternion_multiply(self.orientations, quaternion_conjugate(self.orientations[0]))
        return np.asarray(2.0 * np.arctan2(np.linalg.norm(turns[:, :3], axis=-1), np.abs(turns[:, 3])))


def learnt(movements: Sequence[ShownMovement], moves: str, dimensions: int, n_weights: int) -> tuple[DMP, float]:
    """Return the primitive that imitates all movements, and its distance from them.

    Args:
        movements: one or more.
        moves: as in `ShownMovement.way`.
        dimensions: as in `ShownMovement.way`.
        n_weights: number of basis functions.

    Returns:
        The primitive and the root mean square of its distance from the samples [m, or rad of an angle].

    Raises:
        ValueError: a movement cannot be imitated.
    """
    ways = [movement.way(moves, dimensions) for movement in movements]
    times = [movement.time for movement in movements]
    primitive = DMP.imitate(times, [way for way, _ in ways], n_weights)
    squares = []
    for time, (way, unit) in zip(times, ways, strict=True):
        imitated = primitive.trajectory(way[0], way[-1], time[-1] - time[0]).at(time - time[0])[0]
        squares.append(np.sum((unit * (imitated - way)) ** 2, axis=-1))
    return primitive, float(np.sqrt(np.mean(np.concatenate(squares))))
