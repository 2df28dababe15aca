"""The space in which the centre of a body is if a predicate holds."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Disc:
    """A level disc with a thickness, in the world frame.

    Attributes:
        centre: x and y of the centre [m].
        radius: radius [m].
        lowest: lower bound of the height of the body's centre [m].
        highest: upper bound of the height of the body's centre [m].
    """

    centre: tuple[float, float]
    radius: float
    lowest: float
    highest: float
