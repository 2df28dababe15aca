"""The closest pair of bodies in each movement of a plan."""

from collections.abc import Iterable
from dataclasses import dataclass

Point = tuple[float, float, float]
"""A point in the world frame [m]."""


@dataclass(frozen=True)
class ClosestPair:
    """The least distance of a movement from the bodies at rest that the movement must not hit.

    Attributes:
        instance: name of the instance.
        moving: name of the moving body.
        other: name of the body at rest.
        distance: distance in the forward models [m]. It is negative for bodies that overlap, and then its size is the
            depth.
        time: time from the start of the instance to this distance [s].
        points: nearest points of both bodies in the world frame [m].
        kept: distance that the movement must keep [m].
        measured: least distance of both bodies in the movement of a run [m], or None.
    """

    instance: str
    moving: str
    other: str
    distance: float
    time: float
    points: tuple[Point, Point]
    kept: float = 0.0
    measured: float | None = None

    @property
    def margin(self) -> float:
        """Margin of the condition that the movement keeps its distance [m]."""
        return self.distance - self.kept

    @property
    def error(self) -> float:
        """Difference between the planned and the measured distance [m], not negative. Zero if nothing was measured."""
        return 0.0 if self.measured is None else abs(self.measured - self.distance)

    @property
    def figure(self) -> str:
        """The distance or the depth, e.g. ``20 mm`` or ``147 mm deep``."""
        return f"{1e3 * abs(self.distance):.0f} mm{' deep' if self.distance < 0 else ''}"

    @property
    def text(self) -> str:
        """The bodies and their distance, e.g. ``hand comes within 20 mm of wall``."""
        if self.distance < 0:
            return f"{self.moving} hits {self.other}, {self.figure}"
        return f"{self.moving} comes within {self.figure} of {self.other}"


def find_worst(pairs: Iterable[ClosestPair]) -> ClosestPair | None:
    """Return the pair whose planned and measured distances differ most, or None if no distance was measured."""
    measured = (pair for pair in pairs if pair.measured is not None)
    return max(measured, key=lambda pair: pair.error, default=None)
