"""The closest pair of bodies in each movement of a plan."""

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
    def figure(self) -> str:
        """The distance or the depth, e.g. ``20 mm`` or ``147 mm deep``."""
        return f"{1e3 * abs(self.distance):.0f} mm{' deep' if self.distance < 0 else ''}"

    @property
    def text(self) -> str:
        """The bodies and their distance, e.g. ``hand comes within 20 mm of wall``."""
        if self.distance < 0:
            return f"{self.moving} hits {self.other}, {self.figure}"
        return f"{self.moving} comes within {self.figure} of {self.other}"
