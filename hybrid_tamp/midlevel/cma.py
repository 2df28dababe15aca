"""CMA-ES with restarts (Hansen and Ostermeier 2001, Evolutionary Computation 9:159-195), based on the package cmaes.

The search starts at the default point. The search space is scaled to the unit cube, so that metres and seconds have the
same weight. cmaes expects one number as the cost of a candidate, but candidates are compared by two numbers, first by
violation and then by value. So the costs are the ranks of the candidates in their generation. If all scores of a
generation are equal up to rounding, all costs are 0, so that cmaes recognises a flat objective.

The first generations are about as wide as the cube. In these generations, cmaes replaces points outside the cube by new
samples. Later generations are narrower, and their points outside the cube are mirrored at its faces. New samples would
push a narrow generation away from a face, so that the search could not reach a corner (see `scripts/optimisers`).

A run ends when the candidates of a generation almost coincide, or when cmaes stops. The optimum of a run may be local.
So another run starts at a random point with twice the population (IPOP, Auger and Hansen, CEC 2005).
"""

from dataclasses import dataclass

import numpy as np

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.midlevel.optimiser import Optimiser, Search
from hybrid_tamp.midlevel.scores import Scores
from hybrid_tamp.motion.arrays import FloatArray

REDRAWN = 10
"""Number of first generations in which new samples replace points outside the cube. Later points are mirrored."""
PATIENCE = 7
"""Number of generations over which `CMAES.quick` measures the recent gain."""
LEAST_GAIN = 0.003
"""Smallest recent gain with which `CMAES.quick` continues a run, as a fraction of the total gain over the default."""


@dataclass(frozen=True)
class CMAES(Optimiser):
    """The optimiser ``cma``.

    Attributes:
        population: number of candidates per generation in the first run, at least 4. None means ``4 + 3 ln k`` for k
            variables. A larger population explores more and costs little if rollouts run in batches.
        sigma: initial standard deviation, as a fraction of each variable's range.
        tolerance: a run ends if the candidates of a generation differ by less than this fraction of each variable's
            range.
        restarts: maximum number of further runs within the budget.
        quick: whether to save evaluations. A quick run ends if its last generations gained almost nothing, and no
            further run starts if a candidate meets all conditions.
        noisy: whether to adapt the learning rates to noise (Nomura, Akimoto and Ono, GECCO 2023). Without noise,
            adaptation wastes evaluations.

    Raises:
        InputError: if the population is below 4.
    """

    population: int | None = None
    sigma: float = 0.3
    tolerance: float = 1e-4
    restarts: int = 1
    quick: bool = False
    noisy: bool = False

    def __post_init__(self) -> None:
        """Check the size of the population."""
        if self.population is not None and self.population < 4:
            raise InputError([Issue("population", "must be at least 4 candidates", str(self.population))])

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
        # Import late, because cmaes imports scipy.stats, which takes almost a second.
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
    """Mirror points of shape ``(..., k)`` at the faces of the unit cube until all points lie inside the cube."""
    return np.asarray(1.0 - np.abs(1.0 - np.mod(points, 2.0)))


def _rank(scores: Scores) -> list[float]:
    """Return the ranks of the scores as costs for cmaes. If all scores are equal, all costs are zero."""
    return [0.0] * len(scores) if np.all(scores.best()) else scores.ranks().astype(np.float64).tolist()
