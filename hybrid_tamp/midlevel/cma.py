"""CMA-ES (Hansen and Ostermeier 2001, Evolutionary Computation 9:159-195), by the package cmaes, with restarts.

It searches the unit cube of the variables, so that metres and seconds weigh the same, from the default point. Of the
scores cmaes only uses the order within a generation; it is told ranks, because no single number orders (V, J) without
loss over generations. Its criterion of a flat objective keeps its meaning: of a generation whose scores are equal but
for rounding, all ranks are 0.

What falls outside the cube is sampled again, as cmaes does it, in the first generations only, which are about as wide
as the cube. Then points are folded back at its faces: sampling again would go on pushing the distribution off a face,
and with several variables it does not arrive at an optimum in a corner (`scripts/optimisers` shows it).

A run ends when its generation has shrunk to a point, or when cmaes gives it up. Then another begins at a random place
with the population doubled (IPOP: Auger and Hansen, CEC 2005), as the optimum of the first may be a local one.
"""

from dataclasses import dataclass

import numpy as np

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.midlevel.optimiser import Budget, Evaluate, Optimum, Progress
from hybrid_tamp.midlevel.scores import Scores
from hybrid_tamp.midlevel.search import Search
from hybrid_tamp.midlevel.search_space import SearchSpace
from hybrid_tamp.motion.arrays import FloatArray

REDRAWN = 10
"""Generations in which points outside the cube are sampled again instead of folded back."""

PATIENCE = 7
"""Generations that must have gained something, where it is to be quick."""
LEAST_GAIN = 0.03
"""What counts as something, as a part of all that was gained."""


@dataclass(frozen=True)
class CMAES:
    """The optimiser ``cma``.

    Attributes:
        population: candidates of a generation in the first run, at least 4; None for ``4 + 3 ln k`` with k variables.
            Where a batch of rollouts costs little more than one, a larger population costs nothing and explores more.
        sigma: initial standard deviation, as a part of each variable's range.
        tolerance: a run ends when its generation spreads less than this in each variable, as a part of its range.
        restarts: further runs, as far as the budget lasts.
        quick: whether a run ends where its last generations gained next to nothing, and no other begins once all
            conditions are met.
        noisy: whether to adapt the learning rates to noise (Nomura, Akimoto and Ono, GECCO 2023). Without noise
            it only costs evaluations.

    Raises:
        InputError: the population is below 4.
    """

    population: int | None = None
    sigma: float = 0.3
    tolerance: float = 1e-4
    restarts: int = 1
    noisy: bool = False
    quick: bool = False

    def __post_init__(self) -> None:
        """Check the population."""
        if self.population is not None and self.population < 4:
            raise InputError([Issue("population", "at least 4 candidates a generation", str(self.population))])

    def __call__(
        self,
        evaluate: Evaluate,
        space: SearchSpace,
        budget: Budget,
        rng: np.random.Generator,
        progress: Progress | None = None,
    ) -> Optimum:
        """Return the best candidate, as `Optimiser` says."""
        search = Search(evaluate, space, budget, progress)
        if search.k == 0:
            search.evaluate(np.empty((0, 0)))
            return search.optimum("all sampled")
        population = self.population or 4 + int(3.0 * np.log(search.k))
        start = search.start
        for run in range(1 + self.restarts):
            self._run(search, start, population * 2**run, rng)
            if search.spent or (self.quick and search.met):
                break
            start = rng.uniform(size=search.k)
        return search.optimum(search.spent or "converged")

    def _run(self, search: Search, start: FloatArray, population: int, rng: np.random.Generator) -> None:
        # cmaes imports scipy.stats, which takes most of a second.
        from cmaes import CMA

        bounds = np.tile([0.0, 1.0], (search.k, 1))
        seed = int(rng.integers(2**32))
        strategy = CMA(start, self.sigma, bounds, seed=seed, population_size=population, lr_adapt=self.noisy)
        converged = False
        while not converged:
            if strategy.generation == REDRAWN:
                strategy.set_bounds(None)
            generation = np.array([strategy.ask() for _ in range(population)])
            inside = fold(generation)
            scores = search.evaluate(inside)
            if len(scores) < population or search.spent:
                return
            strategy.tell(list(zip(generation, _costs(scores), strict=True)))
            converged = bool(np.all(np.ptp(inside, axis=0) < self.tolerance)) or strategy.should_stop()
            if self.quick and strategy.generation > PATIENCE and search.gain(PATIENCE) < LEAST_GAIN:
                return


def fold(points: FloatArray) -> FloatArray:
    """Return points ``(..., k)`` mirrored at the faces of the unit cube until they are in it."""
    return np.asarray(1.0 - np.abs(1.0 - np.mod(points, 2.0)))


def _costs(scores: Scores) -> list[float]:
    """Return what cmaes minimises: ranks, or zeros where the generation is flat."""
    return [0.0] * len(scores) if np.all(scores.best()) else scores.ranks().astype(np.float64).tolist()
