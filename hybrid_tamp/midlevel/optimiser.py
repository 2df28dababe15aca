"""The interface of all optimisers: a function from points to scores, a space and a budget go in, an optimum comes out.

The best candidate is the one of the smallest violation and then of the largest value (`Scores`). The default point is
always the first candidate. Of candidates that are equal but for rounding (1e-12, relative) the one nearest to the
default wins, by the Euclidean distance in the unit cube, and of equally near ones the earlier: so a hyperparameter
is not moved for nothing, and a tie is broken in the same way by every optimiser.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from hybrid_tamp.errors import HybridTampError, InputError, Issue
from hybrid_tamp.midlevel.scores import Scores
from hybrid_tamp.midlevel.search_space import SearchSpace
from hybrid_tamp.model.refined import Milestone
from hybrid_tamp.motion.arrays import FloatArray

Evaluate = Callable[[FloatArray], Scores]
"""From points ``(n, d)`` in real units, read-only, to the scores of n candidates."""


@dataclass(frozen=True)
class Budget:
    """How much work is allowed; the first limit that is met ends it.

    Attributes:
        evaluations: candidates at most; never exceeded.
        seconds: time after which no further batch begins [s]. A search that it ends depends on the machine.

    Raises:
        InputError: one of them is not positive.
    """

    evaluations: int
    seconds: float = float("inf")

    def __post_init__(self) -> None:
        """Check that there is something to spend."""
        if not self.evaluations >= 1:
            raise InputError([Issue("budget.evaluations", "at least 1 evaluation", str(self.evaluations))])
        if not self.seconds > 0.0:
            raise InputError([Issue("budget.seconds", "more than 0 s", str(self.seconds))])


Progress = Callable[[Milestone], None]


@dataclass(frozen=True, eq=False)
class Optimum:
    """What a search found.

    Attributes:
        point: the best candidate [units], shape ``(d,)``.
        violation: its violation V; above 0 no candidate met all conditions.
        value: its value J.
        evaluations: candidates that were evaluated.
        history: a milestone after each batch.
        stopped: why it ended: ``converged``, ``evaluations``, ``seconds`` or ``all sampled``.
    """

    point: FloatArray
    violation: float
    value: float
    evaluations: int
    history: tuple[Milestone, ...]
    stopped: str


class NothingFinite(HybridTampError):
    """Every candidate's rollout failed: there is no best; `evaluations` says how many were tried."""

    def __init__(self, evaluations: int) -> None:
        super().__init__(f"violation or value was NaN or infinite for every one of {evaluations} candidates")
        self.evaluations = evaluations


class Optimiser(Protocol):
    """A way to search."""

    def __call__(
        self,
        evaluate: Evaluate,
        space: SearchSpace,
        budget: Budget,
        rng: np.random.Generator,
        progress: Progress | None = None,
    ) -> Optimum:
        """Return the best candidate found within the bounds and the budget.

        Args:
            evaluate: scores a batch of points; may return NaN where a rollout failed.
            space: the variables; constants stay as they are.
            budget: how much work is allowed.
            rng: source of everything random: the same state gives the same optimum, bit for bit.
            progress: told of each milestone.

        Raises:
            NothingFinite: every rollout failed.
        """
