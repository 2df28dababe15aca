"""Movements that motor primitives represent."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Movement:
    """The movement that the motor primitive of a block represents.

    Attributes:
        slot: slot of the token whose movement is demonstrated.
        moves: varying property that the movement changes: ``position`` or ``orientation``.
        dimensions: 3 for a primitive of the position [m], or 1 for a primitive of the travelled fraction of the way.
    """

    slot: str
    moves: str
    dimensions: int
