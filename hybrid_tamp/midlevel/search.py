"""The book of one search: what was evaluated, the best of it, and what is left of the budget."""

import time
from dataclasses import replace

import numpy as np

from hybrid_tamp.midlevel.optimiser import Budget, Evaluate, NothingFinite, Optimum, Progress
from hybrid_tamp.midlevel.scores import Scores
from hybrid_tamp.midlevel.search_space import SearchSpace
from hybrid_tamp.model.refined import Milestone
from hybrid_tamp.motion.arrays import FloatArray


class Search:
    """One search under way, in the unit cube of the k variables that are no constants.

    Attributes:
        k: number of variables that are searched.
        start: the default point in the unit cube, shape ``(k,)``.
        evaluations: candidates evaluated so far.
    """

    def __init__(self, evaluate: Evaluate, space: SearchSpace, budget: Budget, progress: Progress | None) -> None:
        self._evaluate = evaluate
        self._space = space
        self._varying = space.only(space.varying)
        self._budget = budget
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
        if self.evaluations >= self._budget.evaluations:
            return "evaluations"
        return "seconds" if time.monotonic() - self._begin >= self._budget.seconds else ""

    def gain(self, batches: int) -> float:
        """Return what the last batches have gained, as a part of all that was gained; of violation, where there is one.

        Of fewer batches it is 1, and where nothing has been gained yet.
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
        """Evaluate candidates in one batch, as many as the budget allows.

        The default point is put in front of the first batch.

        Args:
            cube: coordinates in the unit cube, shape ``(n, k)``.

        Returns:
            The scores of the first m candidates, ``m <= n``.

        Raises:
            ValueError: there is not a score for each point.
        """
        points = self._varying.embed(self._varying.from_unit(cube))
        extra = 0 if self.evaluations else 1
        points = np.vstack([*[self._space.default] * extra, points])[: self._budget.evaluations - self.evaluations]
        points.flags.writeable = False
        scores = self._evaluate(points)
        if len(scores) != len(points):
            raise ValueError(f"evaluate must return {len(points)} scores, got {len(scores)}")
        self._record(points, scores)
        return scores[extra:]

    def _record(self, points: FloatArray, scores: Scores) -> None:
        self._points.append(points)
        self._scores.append(scores)
        self.evaluations += len(points)
        first = int(np.argmin(scores.ranks()))
        new = Milestone(self.evaluations, float(scores.violation[first]), float(scores.value[first]))
        best = min([*self._history[-1:], new], key=lambda milestone: (milestone.violation, -milestone.value))
        self._history.append(replace(best, evaluations=self.evaluations))
        if self._progress is not None:
            self._progress(self._history[-1])

    def optimum(self, stopped: str) -> Optimum:
        """Return the best candidate, ties broken as the module `optimiser` says.

        Raises:
            NothingFinite: every rollout failed.
        """
        points, scores = np.concatenate(self._points), Scores.join(self._scores)
        if not np.any(scores.finite):
            raise NothingFinite(self.evaluations)
        distances = np.linalg.norm(self._space.to_unit(points) - self._space.to_unit(self._space.default), axis=1)
        chosen = int(np.argmin(np.where(scores.best(), distances, np.inf)))
        return Optimum(
            point=points[chosen].copy(),
            violation=float(scores.violation[chosen]),
            value=float(scores.value[chosen]),
            evaluations=self.evaluations,
            history=tuple(self._history),
            stopped=stopped,
        )
