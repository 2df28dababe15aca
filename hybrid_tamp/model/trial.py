"""A domain's recipes for testing whether a token is a member of a class (paper, Sec. II-B).

`hybrid_tamp.questions.probe` ranks classes, warps shapes and counts successes for all domains. A recipe estimates the
properties of a new token from a labelled member, and makes the task of a trial.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np

from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray

TaskType = TypeVar("TaskType")
"""The class of tasks; a type variable, because `Task` imports the domain and its recipes."""

Carry = Callable[[FloatArray], FloatArray]
"""Warps points ``(n, 3)`` [m] on a labelled token to the new token, both in body frames."""


@dataclass(frozen=True, eq=False)
class Estimate:
    """The estimate for a new token from a labelled one.

    Attributes:
        properties: the new token's properties as a member of the class.
        contacts: maps each name to the point ``(3,)`` [m] where a hand should touch, in the body frame.
    """

    properties: Mapping[str, Any]
    contacts: Mapping[str, tuple[float, float, float]]


@dataclass(frozen=True, eq=False)
class TrialRecipe(Generic[TaskType]):
    """A recipe for trials of membership of one class.

    Attributes:
        object_class: the class.
        align: ``align(task, token, labelled)``, the initial rotation ``(3, 3)`` of the warp from the body frame of the
            labelled token to that of the new one.
        estimate: ``estimate(task, token, labelled, carry)`` returns the estimate; both tokens must have a shape.
        task: ``task(task, member, rng)`` makes a task that tests the token as a member. `rng` draws the start;
            without it the start is exact. One plan must serve all starts.
        bounds: maps each metric of the domain (its name without the instance) to its bounds.
    """

    object_class: type[ObjectClass]
    align: Callable[[TaskType, Token, Token], FloatArray]
    estimate: Callable[[TaskType, Token, Token, Carry], Estimate]
    task: Callable[[TaskType, Token, np.random.Generator | None], TaskType]
    bounds: Mapping[str, tuple[float, float]]
