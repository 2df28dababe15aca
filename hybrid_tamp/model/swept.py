"""Swept paths: the movements of a plan in the forward models, for pictures."""

from dataclasses import dataclass

from hybrid_tamp.model.closest_pair import ClosestPair
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.refined import Shortfall
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class SweptBody:
    """The poses of a body along a movement.

    Attributes:
        token: name of the token.
        positions: positions [m], shape ``(k, 3)``.
        orientations: orientations as unit quaternions, shape ``(k, 4)``.
    """

    token: str
    positions: FloatArray
    orientations: FloatArray


@dataclass(frozen=True, eq=False)
class SweptPath:
    """The movement of one instance.

    Attributes:
        instance: the instance.
        bodies: bodies that the instance moves.
        times: times of the poses from the start of the instance [s], shape ``(k,)``.
        closest: closest pair of bodies, or None if no other body is near.
    """

    instance: BlockInstance
    bodies: tuple[SweptBody, ...]
    times: FloatArray
    closest: ClosestPair | None


@dataclass(frozen=True, eq=False)
class SweptPlan:
    """The movements of a plan.

    Attributes:
        task: task of the plan.
        paths: movements in the order of their starts.
        refused: the condition that fails, if the plan was refused. None if the plan is executable.
    """

    task: Task
    paths: tuple[SweptPath, ...]
    refused: Shortfall | None = None
