"""Collisions that the independent check of a plan or of a recording finds."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Collision:
    """An overlap of two bodies that no running block allows to touch.

    Attributes:
        tokens: names of the two bodies.
        instances: names of the instances of both bodies. The name is empty for places.
        time: first instant at which the overlap was found [s].
    """

    tokens: tuple[str, str]
    instances: tuple[str, str]
    time: float

    @property
    def text(self) -> str:
        """The bodies and the instant, e.g. ``hand and wall collide at 3.20 s``."""
        return f"{self.tokens[0]} and {self.tokens[1]} collide at {self.time:.2f} s"
