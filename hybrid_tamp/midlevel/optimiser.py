"""Common interface of the optimisers. An optimiser takes a scoring function, a space and a budget.

The best candidate has the smallest violation and, at equal violations, the largest value (`Scores`). The default point
is always the first candidate. Candidates are tied if the relative difference between their scores is below 1e-12. Of
tied candidates, the candidate nearest to the default point wins. The distance is Euclidean, with the range of each
variable scaled to [0, 1]. If distances are equal, the earliest candidate wins. So a hyperparameter changes only if the
change improves the score.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from hybrid_tamp.errors import HybridTampError, InputError, Issue
from hybrid_tamp.midlevel.scores import Scores
from hybrid_tamp.midlevel.search_space import SearchSpace
from hybrid_tamp.model.refined import Milestone
from hybrid_tamp.motion.arrays import FloatArray

Evaluate = Callable[[FloatArray], Scores]
"""Function that maps read-only points of shape ``(n, d)`` to the scores of n candidates. NaN marks a failed rollout."""

Progress = Callable[[Milestone], None]
"""Progress callback, which is called after each batch with the best score so far."""


@dataclass(frozen=True)
class Budget:
    """The limit of a search.

    Attributes:
        evaluations: maximum number of candidates, which is never exceeded.

    Raises:
        InputError: if the limit is not positive.
    """

    evaluations: int

    def __post_init__(self) -> None:
        """Check that the limit is positive."""
        if not self.evaluations >= 1:
            raise InputError([Issue("budget.evaluations", "must be at least 1 evaluation", str(self.evaluations))])


@dataclass(frozen=True, eq=False)
class Optimum:
    """The result of a search.

    Attributes:
        point: the best candidate, in real units. Shape ``(d,)``.
        violation: violation V of the best candidate. Positive if no candidate met all conditions.
        value: value J of the best candidate.
        evaluations: number of evaluated candidates.
        history: best score so far, after each batch.
        stopped: reason why the search ended: ``converged``, ``evaluations`` or ``all sampled``.
    """

    point: FloatArray
    violation: float
    value: float
    evaluations: int
    history: tuple[Milestone, ...]
    stopped: str


FLOOR = 1e-6
"""Smallest gain of the value J that counts. The models are less accurate."""


class NothingFinite(HybridTampError):
    """Raised if all rollouts of a search failed. Then there is no best candidate."""

    def __init__(self, evaluations: int) -> None:
        super().__init__(f"all {evaluations} candidates failed, because their violation or value was not finite")
        self.evaluations = evaluations


class Search:
    """A search in progress, in the unit cube of the k variables that are not constant.

    Attributes:
        k: number of searched variables.
        start: default point in the unit cube. Shape ``(k,)``.
        budget: the limit of the search.
        evaluations: number of candidates evaluated so far.
    """

    def __init__(self, evaluate: Evaluate, space: SearchSpace, budget: Budget, progress: Progress | None) -> None:
        self._evaluate = evaluate
        self._space = space
        self._varying = space.only(space.varying)
        self.budget = budget
        self._progress = progress
        self._points: list[FloatArray] = []
        self._scores: list[Scores] = []
        self._history: list[Milestone] = []
        self._default: list[Milestone] = []
        self.k = self._varying.d
        self.start = self._varying.to_unit(self._varying.default)
        self.evaluations = 0

    @property
    def spent(self) -> str:
        """``evaluations`` if the budget is used up, else an empty string."""
        return "evaluations" if self.evaluations >= self.budget.evaluations else ""

    def gain(self, batches: int) -> float:
        """Return the gain of the last batches as a fraction of the total gain over the default point.

        The gain is the decrease of the violation or, if the violation stays constant, the increase of the value. If
        the default violates more conditions, the value is compared with the first candidate that does not. The fraction
        is 1 if there were at most ``batches`` batches. If all conditions hold, a gain below `FLOOR` counts as 0.
        """
        if len(self._history) <= batches:
            return 1.0
        before, now, all_best = self._history[-1 - batches], self._history[-1], [*self._default, *self._history]
        if now.violation < before.violation:
            return 1.0 if now.violation == 0 else (before.violation - now.violation) / all_best[0].violation
        gain = now.value - before.value
        if now.violation == 0.0 and gain < FLOOR:
            return 0.0
        whole = now.value - next(each.value for each in all_best if each.violation == now.violation)
        return gain / whole if whole > 0.0 else 1.0

    @property
    def met(self) -> bool:
        """Whether any candidate met all conditions."""
        return bool(self._history) and self._history[-1].violation == 0.0

    def evaluate(self, cube: FloatArray) -> Scores:
        """Evaluate as many candidates as the budget allows. The first batch also evaluates the default point.

        Args:
            cube: candidates in the unit cube. Shape ``(n, k)``.

        Returns:
            The scores of the first m of these candidates, ``m <= n``.

        Raises:
            ValueError: if the number of scores differs from the number of points.
        """
        points = self._varying.embed(self._varying.from_unit(cube))
        extra = 0 if self.evaluations else 1
        points = np.vstack([*[self._space.default] * extra, points])[: self.budget.evaluations - self.evaluations]
        points.flags.writeable = False
        scores = self._evaluate(points)
        if len(scores) != len(points):
            raise ValueError(f"evaluate must return {len(points)} scores, got {len(scores)}")
        self._points.append(points)
        self._scores.append(scores)
        self.evaluations += len(points)
        if extra and scores.finite[0]:
            self._default = [Milestone(1, float(scores.violation[0]), float(scores.value[0]))]
        first = int(np.argmin(scores.ranks()))
        new = Milestone(self.evaluations, float(scores.violation[first]), float(scores.value[first]))
        best = min([*self._history[-1:], new], key=lambda milestone: (milestone.violation, -milestone.value))
        self._history.append(replace(best, evaluations=self.evaluations))
        if self._progress is not None:
            self._progress(self._history[-1])
        return scores[extra:]

    def find_best(self, stopped: str) -> Optimum:
        """Return the best candidate, with ties broken as described in the module docstring.

        Raises:
            NothingFinite: if every rollout failed.
        """
        points, scores = np.concatenate(self._points), Scores.join(self._scores)
        if not np.any(scores.finite):
            raise NothingFinite(self.evaluations)
        distances = np.linalg.norm(self._space.to_unit(points) - self._space.to_unit(self._space.default), axis=1)
        chosen = int(np.argmin(np.where(scores.best(), distances, np.inf)))
        violation, value = float(scores.violation[chosen]), float(scores.value[chosen])
        return Optimum(points[chosen].copy(), violation, value, self.evaluations, tuple(self._history), stopped)


class Optimiser(ABC):
    """Base class of the optimisers. Subclasses implement `sample`."""

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
            evaluate: function that returns the scores of a batch of points.
            space: the variables and their bounds. Constant variables keep their values.
            budget: the limit of the search.
            rng: only source of randomness. The same generator state gives a bit-identical optimum.
            progress: callback that is called after each batch.

        Raises:
            NothingFinite: if every rollout failed.
        """
        search = Search(evaluate, space, budget, progress)
        return search.find_best(self.sample(search, rng))

    @abstractmethod
    def sample(self, search: Search, rng: np.random.Generator) -> str:
        """Evaluate candidates until the search ends, and return the reason why it ended (see `Optimum.stopped`)."""
