"""Recipes of a domain for trials that test whether a token is a member of a class (paper, Sec. II-B).

For every domain, `hybrid_tamp.questions.probe` ranks classes, warps the shape of a known member (the labelled token) to
the shape of the new token, and counts successes. A recipe of the domain estimates the properties of the new token from
the labelled token, and creates the task of a trial.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np

from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray

TaskType = TypeVar("TaskType")
"""Type variable for `Task`, which cannot be imported here because `Task` imports the domain and its recipes."""

Carry = Callable[[FloatArray], FloatArray]
"""Function that maps points on a labelled token to points on the new token, in body frames [m], shape ``(n, 3)``."""


@dataclass(frozen=True, eq=False)
class Estimate:
    """The estimated properties and contact points of a new token.

    Attributes:
        properties: maps the name of each property of the class to the estimated value.
        contacts: maps the name of each contact point to its position in the body frame [m], shape ``(3,)``.
    """

    properties: Mapping[str, Any]
    contacts: Mapping[str, tuple[float, float, float]]


@dataclass(frozen=True, eq=False)
class TrialRecipe(Generic[TaskType]):
    """A recipe for trials of membership of one class.

    Attributes:
        object_class: class of the recipe.
        align: function ``align(task, token, labelled)`` that returns the rotation with which the warp starts, shape
            ``(3, 3)``. The rotation maps the body frame of the labelled token to the body frame of the new token.
        estimate: function ``estimate(task, token, labelled, carry)`` that returns an `Estimate`. Both tokens need
            shapes.
        task: function ``task(task, member, rng)`` that returns the task of a trial. `rng` randomises the initial state.
            If `rng` is None, the initial state is exact. The same plan must be valid for all initial states.
        bounds: maps each metric of the domain (name without the instance) to its lower and upper bound.
    """

    object_class: type[ObjectClass]
    align: Callable[[TaskType, Token, Token], FloatArray]
    estimate: Callable[[TaskType, Token, Token, Carry], Estimate]
    task: Callable[[TaskType, Token, np.random.Generator | None], TaskType]
    bounds: Mapping[str, tuple[float, float]]
