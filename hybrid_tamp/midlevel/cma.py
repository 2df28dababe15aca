"""CMA-ES (Hansen and Ostermeier 2001, Evolutionary Computation 9:159-195), by the package cmaes, with restarts.

It searches the unit cube of the variables, so that metres and seconds have the same weight, and starts at the default
point. cmaes uses only the order of scores within a generation. It gets ranks, because no single number orders (V, J)
over generations without loss. If all scores of a generation are equal up to rounding, all ranks are 0, so that cmaes
still recognises a flat objective.

In the first generations, which are about as wide as the cube, cmaes samples points outside the cube again. Later
points are folded back at the faces of the cube: further resampling would keep pushing the distribution away from a
face, and with several variables it would never reach an optimum in a corner (`scripts/optimisers` shows this).

A run ends when its generation has shrunk to a point, or when cmaes stops. The optimum of that run may be a local one,
so another run starts at a random point with twice the population (IPOP: Auger and Hansen, CEC 2005).
"""

from dataclasses import dataclass

import numpy as np

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.midlevel.optimiser import Optimiser, Search
from hybrid_tamp.midlevel.scores import Scores
from hybrid_tamp.motion.arrays import FloatArray

REDRAWN = 10
"""Number of generations in which points outside the cube are sampled again instead of folded back."""
PATIENCE = 7
"""Number of generations within which a quick run must improve."""
LEAST_GAIN = 0.03
"""Smallest improvement that counts, as a fraction of the total gain."""


@dataclass(frozen=True)
class CMAES(Optimiser):
    """The optimiser ``cma``.

    Attributes:
        population: candidates of a generation in the first run, at least 4; None for ``4 + 3 ln k`` with k variables.
            If a batch of rollouts costs little more than one rollout, a larger population explores more at no cost.
        sigma: initial standard deviation, as a fraction of each variable's range.
        tolerance: a run ends when its generation spreads less than this in each variable, as a fraction of its range.
        restarts: maximum number of further runs within the budget.
        quick: whether a run ends when its last generations gained almost nothing, and no other run starts once all
            conditions are met.
        noisy: whether to adapt the learning rates to noise (Nomura, Akimoto and Ono, GECCO 2023). Without noise
            this only costs evaluations.

    Raises:
        InputError: the population is below 4.
    """

    population: int | None = None
    sigma: float = 0.3
    tolerance: float = 1e-4
    restarts: int = 1
    quick: bool = False
    noisy: bool = False

    def __post_init__(self) -> None:
        """Check the population."""
        if self.population is not None and self.population < 4:
            raise InputError([Issue("population", "at least 4 candidates a generation", str(self.population))])

    def sample(self, search: Search, rng: np.random.Generator) -> str:
        """Run CMA-ES from the default point, then from random points."""
        if search.k == 0:
            search.evaluate(np.empty((0, 0)))
            return "all sampled"
        population = self.population or 4 + int(3.0 * np.log(search.k))
        start = search.start
        for run in range(1 + self.restarts):
            self._run(search, start, population * 2**run, rng)
            if search.spent or (self.quick and search.met):
                break
            start = rng.uniform(size=search.k)
        return search.spent or "converged"

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
            strategy.tell(list(zip(generation, _rank(scores), strict=True)))
            converged = bool(np.all(np.ptp(inside, axis=0) < self.tolerance)) or strategy.should_stop()
            if self.quick and strategy.generation > PATIENCE and search.gain(PATIENCE) < LEAST_GAIN:
                return


def fold(points: FloatArray) -> FloatArray:
    """Return points ``(..., k)`` mirrored at the faces of the unit cube until they are inside."""
    return np.asarray(1.0 - np.abs(1.0 - np.mod(points, 2.0)))


def _rank(scores: Scores) -> list[float]:
    """Return the costs that cmaes minimises: ranks, or zeros if the generation is flat."""
    return [0.0] * len(scores) if np.all(scores.best()) else scores.ranks().astype(np.float64).tolist()
