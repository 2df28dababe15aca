"""Closed-form objectives in a box, to compare the project's optimiser with the package cmaes alone."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from cmaes import CMA

from hybrid_tamp.midlevel.cma import CMAES
from hybrid_tamp.midlevel.optimiser import Budget
from hybrid_tamp.midlevel.scores import Scores
from hybrid_tamp.midlevel.search_space import SearchSpace, Variable
from hybrid_tamp.motion.arrays import FloatArray

Cost = Callable[[FloatArray], FloatArray]
"""Maps points ``(n, d)`` to costs ``(n,)``. The minimum is 0."""


@dataclass(frozen=True)
class Problem:
    """A cost in the box ``[-5, 5]^d``. The search starts at `default` and ends at `target` or `limit`."""

    name: str
    cost: Cost
    default: float
    target: float = 1e-6
    limit: int = 40_000


def sphere(points: FloatArray) -> FloatArray:
    return np.asarray(np.sum(points**2, axis=1))


def ellipsoid(points: FloatArray) -> FloatArray:
    """Return the cost of an ellipsoid with squared axes that differ by a factor of up to a million."""
    d = points.shape[1]
    return np.asarray(points**2 @ 10.0 ** (6.0 * np.arange(d) / max(1, d - 1)))


def rosenbrock(points: FloatArray) -> FloatArray:
    x, y = points[:, :-1], points[:, 1:]
    return np.asarray(np.sum(100.0 * (y - x**2) ** 2 + (1.0 - x) ** 2, axis=1))


def corner(points: FloatArray) -> FloatArray:
    """Return a linear cost whose optimum is on all upper bounds."""
    return np.asarray(np.sum(5.0 - points, axis=1))


CORNER = Problem("corner", corner, 0.0, 1e-3, 4000)
PROBLEMS = (
    Problem("sphere", sphere, 3.0),
    Problem("ellipsoid", ellipsoid, 3.0),
    Problem("Rosenbrock", rosenbrock, 0.0),
)
SIGMA = 0.3


def box(d: int, default: float = 0.0, half: float = 5.0) -> SearchSpace:
    return SearchSpace(tuple(Variable(f"x{i}", "m", -half, half, default) for i in range(d)))


class TargetReached(Exception):
    pass


class Counter:
    """Counter of evaluations, up to and including the first evaluation that reaches the target."""

    def __init__(self, cost: Cost, target: float) -> None:
        self.cost, self.target, self.evaluations = cost, target, 0

    def __call__(self, points: FloatArray) -> Scores:
        costs = self.cost(points)
        reached = np.flatnonzero(costs <= self.target)
        self.evaluations += int(reached[0]) + 1 if len(reached) else len(costs)
        if len(reached):
            raise TargetReached
        return Scores(np.zeros(len(costs)), -costs)


def ours(problem: Problem, d: int, seed: int) -> int:
    """Return the number of evaluations until the target through the project's interface, or the limit."""
    counter = Counter(problem.cost, problem.target)
    optimise = CMAES(sigma=SIGMA, tolerance=1e-9, restarts=0)
    try:
        optimise(counter, box(d, problem.default), Budget(problem.limit), np.random.default_rng(seed))
    except TargetReached:
        return counter.evaluations
    return problem.limit


def bare(problem: Problem, d: int, seed: int) -> int:
    """Return the number of evaluations until the target by the package cmaes alone, or the limit."""
    counter = Counter(problem.cost, problem.target)
    strategy = CMA(np.full(d, problem.default), 10.0 * SIGMA, np.tile([-5.0, 5.0], (d, 1)), seed=seed)
    while counter.evaluations < problem.limit and not strategy.should_stop():
        generation = [strategy.ask() for _ in range(strategy.population_size)]
        try:
            scores = counter(np.array(generation))
        except TargetReached:
            return counter.evaluations
        strategy.tell([(point, -float(value)) for point, value in zip(generation, scores.value, strict=True)])
    return problem.limit
