"""The interface of all optimisers: they take a scoring function, a space and a budget, and return an optimum.

The best candidate has the smallest violation and, among those, the largest value (`Scores`). The default point is
always the first candidate. If several candidates are equal up to rounding (relative difference 1e-12), the one nearest
to the default wins (Euclidean distance in the unit cube), and of equally near ones the earliest. So no hyperparameter
moves without a gain, and every optimiser breaks ties in the same way.
"""

import time
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
"""Maps points ``(n, d)`` in real units, read-only, to the scores of n candidates; NaN marks a failed rollout."""

Progress = Callable[[Milestone], None]
"""Called with each milestone of a search."""


@dataclass(frozen=True)
class Budget:
    """The limits of a search; it ends at the first limit that it meets.

    Attributes:
        evaluations: maximum number of candidates; never exceeded.
        seconds: time after which no further batch begins [s]. A search that it ends depends on the machine.

    Raises:
        InputError: a limit is not positive.
    """

    evaluations: int
    seconds: float = float("inf")

    def __post_init__(self) -> None:
        """Check that both limits are positive."""
        if not self.evaluations >= 1:
            raise InputError([Issue("budget.evaluations", "at least 1 evaluation", str(self.evaluations))])
        if not self.seconds > 0.0:
            raise InputError([Issue("budget.seconds", "more than 0 s", str(self.seconds))])


@dataclass(frozen=True, eq=False)
class Optimum:
    """The result of a search.

    Attributes:
        point: the best candidate [units], shape ``(d,)``.
        violation: its violation V; if it is above 0, no candidate met all conditions.
        value: its value J.
        evaluations: number of candidates that were evaluated.
        history: a milestone after each batch.
        stopped: why the search ended: ``converged``, ``evaluations``, ``seconds`` or ``all sampled``.
    """

    point: FloatArray
    violation: float
    value: float
    evaluations: int
    history: tuple[Milestone, ...]
    stopped: str


class NothingFinite(HybridTampError):
    """Every rollout failed, so there is no best candidate; `evaluations` is their number."""

    def __init__(self, evaluations: int) -> None:
        super().__init__(f"violation or value was NaN or infinite for every one of {evaluations} candidates")
        self.evaluations = evaluations


class Search:
    """A search under way, in the unit cube of the k variables that are not constant.

    Attributes:
        k: number of variables that are searched.
        start: the default point in the unit cube, shape ``(k,)``.
        budget: the limits of the search.
        evaluations: number of candidates evaluated so far.
    """

    def __init__(self, evaluate: Evaluate, space: SearchSpace, budget: Budget, progress: Progress | None) -> None:
        self._evaluate = evaluate
        self._space = space
        self._varying = space.only(space.varying)
        self.budget = budget
        self._progress = progress
        self._begin = time.monotonic()
        self._points: list[FloatArray] = []
        self._scores: list[Scores] = []
        self._history: list[Milestone] = []
        self.k = self._varying.d
        self.start = self._varying.to_unit(self._varying.default)
        self.evaluations = 0

    @property
    def spent(self) -> str:
        """The limit that has been met, ``evaluations`` or ``seconds``; else empty."""
        if self.evaluations >= self.budget.evaluations:
            return "evaluations"
        return "seconds" if time.monotonic() - self._begin >= self.budget.seconds else ""

    def gain(self, batches: int) -> float:
        """Return the gain of the last batches as a fraction of the total gain.

        The gain is measured in violation until the violation stops falling, and in value after that. It is 1 if there
        were fewer batches or no gain so far.
        """
        if len(self._history) <= batches:
            return 1.0
        first, before, now = self._history[0], self._history[-1 - batches], self._history[-1]
        if now.violation < before.violation:
            return 1.0 if now.violation == 0 else (before.violation - now.violation) / first.violation
        whole = now.value - next(m.value for m in self._history if m.violation == now.violation)
        return (now.value - before.value) / whole if whole > 0.0 else 1.0

    @property
    def met(self) -> bool:
        """Whether a candidate met all conditions."""
        return bool(self._history) and self._history[-1].violation == 0.0

    def evaluate(self, cube: FloatArray) -> Scores:
        """Evaluate a batch of candidates, as many as the budget allows; the first batch begins with the default point.

        Args:
            cube: coordinates in the unit cube, shape ``(n, k)``.

        Returns:
            The scores of the first m candidates, ``m <= n``.

        Raises:
            ValueError: the number of scores differs from the number of points.
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
        first = int(np.argmin(scores.ranks()))
        new = Milestone(self.evaluations, float(scores.violation[first]), float(scores.value[first]))
        best = min([*self._history[-1:], new], key=lambda milestone: (milestone.violation, -milestone.value))
        self._history.append(replace(best, evaluations=self.evaluations))
        if self._progress is not None:
            self._progress(self._history[-1])
        return scores[extra:]

    def find_best(self, stopped: str) -> Optimum:
        """Return the best candidate, with ties broken as described at the top of this module.

        Raises:
            NothingFinite: every rollout failed.
        """
        points, scores = np.concatenate(self._points), Scores.join(self._scores)
        if not np.any(scores.finite):
            raise NothingFinite(self.evaluations)
        distances = np.linalg.norm(self._space.to_unit(points) - self._space.to_unit(self._space.default), axis=1)
        chosen = int(np.argmin(np.where(scores.best(), distances, np.inf)))
        violation, value = float(scores.violation[chosen]), float(scores.value[chosen])
        return Optimum(points[chosen].copy(), violation, value, self.evaluations, tuple(self._history), stopped)


class Optimiser(ABC):
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
            evaluate: scores a batch of points.
            space: the variables; constants keep their values.
            budget: the limits of the search.
            rng: source of all randomness: the same state gives the same optimum, bit for bit.
            progress: called with each milestone.

        Raises:
            NothingFinite: every rollout failed.
        """
        search = Search(evaluate, space, budget, progress)
        return search.find_best(self.sample(search, rng))

    @abstractmethod
    def sample(self, search: Search, rng: np.random.Generator) -> str:
        """Evaluate candidates until the search ends, and return why it ended."""
