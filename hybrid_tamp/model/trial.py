"""How a domain tries whether a token is a member of one of its classes, which blocks ground (paper, Sec. II-B).

Ranking, warping and counting are the same for all domains (`hybrid_tamp.questions.probe`). A domain says what a
labelled member teaches about a new token, and what a trial is.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np

from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray

TaskType = TypeVar("TaskType")
"""The class of tasks. A task knows its domain, whose recipes therefore do not know the class."""

Carry = Callable[[FloatArray], FloatArray]
"""Points on a labelled token ``(n, 3)`` [m] to where the warp has carried them on the new one, both in body frames."""


@dataclass(frozen=True, eq=False)
class Estimate:
    """What the labelled token taught.

    Attributes:
        properties: the new token's properties as a member of the class.
        contacts: name to the point ``(3,)`` [m] in its body frame that a hand is expected to touch.
    """

    properties: Mapping[str, Any]
    contacts: Mapping[str, tuple[float, float, float]]


@dataclass(frozen=True, eq=False)
class TrialRecipe(Generic[TaskType]):
    """How membership of one class is tried.

    Attributes:
        object_class: the class.
        align: ``align(task, token, labelled)`` is the rotation ``(3, 3)`` from the labelled token's body frame to the
            new one's with which the warp begins.
        estimate: ``estimate(task, token, labelled, carry)``; both tokens have a shape.
        task: ``task(task, member, rng)`` is a task in which the token, now taken for a member, is tried from a start
            that `rng` draws; without `rng` from the exact one. The plan of one start must do for all.
        bounds: the domain's metrics (after the instance's name) to the bounds within which they must be.
    """

    object_class: type[ObjectClass]
    align: Callable[[TaskType, Token, Token], FloatArray]
    estimate: Callable[[TaskType, Token, Token, Carry], Estimate]
    task: Callable[[TaskType, Token, np.random.Generator | None], TaskType]
    bounds: Mapping[str, tuple[float, float]]
