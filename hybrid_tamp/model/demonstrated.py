"""What the instances of a block show of its movement: the demonstrations in a run or in an observation."""

from collections.abc import Iterable, Iterator

import numpy as np

from hybrid_tamp.model.block import Movement
from hybrid_tamp.model.plan import TIME_TOLERANCE, BlockInstance
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.demonstration import ShownMovement


def demonstrated_movements(
    source: str, times: FloatArray, trajectory: State, instances: Iterable[BlockInstance], movement: Movement
) -> Iterator[ShownMovement]:
    """Yield what each instance shows, from its start until its exit conditions hold.

    Args:
        source: name of the run or the observation, for messages.
        times: instants [s], shape ``(t,)``.
        trajectory: states at the instants, batch shape ``(t,)``.
        instances: the instances.
        movement: which of their tokens moves.
    """
    for instance in instances:
        end = instance.active.end + TIME_TOLERANCE
        rows = np.flatnonzero((times >= instance.start - TIME_TOLERANCE) & (times <= end))
        token = instance.slots[movement.slot]
        turns = (token, "orientation") in trajectory.layout.slices
        yield ShownMovement(
            f"{source}/{instance.name}",
            times[rows],
            trajectory[token, "position"][rows],
            trajectory[token, "orientation"][rows] if turns else None,
        )
