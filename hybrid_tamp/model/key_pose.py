"""Poses through which every execution of a block moves a token.

The pose of a hand at its place and the poses of a box that is lifted are key poses. Hyperparameters and paths do not
change a key pose. So a body that stays where it is and overlaps a token in a key pose makes the instance impossible.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray

SERVO_ERROR = 5e-3
"""Largest distance of a body from its reference, unless a block declares another one [m]."""


@dataclass(frozen=True, eq=False)
class KeyPose:
    """A pose through which every execution of an instance moves a token.

    If the token that the instance moves starts elsewhere on the same level, the key pose moves by the same offset.

    Attributes:
        slot: slot of the token.
        position: position ``(3,)`` [m].
        orientation: orientation ``(4,)`` as a unit quaternion.
        within: largest distance of any point of the body from its position in this pose [m].
    """

    slot: str
    position: FloatArray
    orientation: FloatArray
    within: float = SERVO_ERROR


KeyPoses = Callable[[Binding, State], Sequence[KeyPose]]
"""Function ``key_poses(binding, start)`` that returns the key poses of an instance, for a state without batches."""
