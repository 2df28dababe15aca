"""Tests of both optimisers: bounds, order, ties, budgets, failed rollouts, seeds and accuracy."""

import subprocess
import sys
from collections.abc import Callable
from statistics import median

import numpy as np
import pytest
from clocks import hurried
from hypothesis import given, settings
from hypothesis import strategies as st
from optimisation_problems import PROBLEMS, Problem, bare, box, corner, ours, rosenbrock, sphere

from hybrid_tamp.errors import InputError
from hybrid_tamp.midlevel.cma import CMAES, fold
from hybrid_tamp.midlevel.grid import Grid, axis_counts
from hybrid_tamp.midlevel.optimiser import Budget, Evaluate, NothingFinite, Optimiser, Optimum
from hybrid_tamp.midlevel.registry import OPTIMISERS, find_optimiser
from hybrid_tamp.midlevel.scores import Scores
from hybrid_tamp.midlevel.search_space import SearchSpace, Variable
from hybrid_tamp.model.refined import Milestone
from hybrid_tamp.motion.arrays import FloatArray

BOTH = pytest.mark.parametrize("name", sorted(OPTIMISERS))


def valued(value: Callable[[FloatArray], FloatArray]) -> Evaluate:
    """An objective without conditions."""
    return lambda points: Scores(np.zeros(len(points)), value(points))


def search(optimise: Optimiser, evaluate: Evaluate, space: SearchSpace, limit: int = 2000, seed: int = 3000) -> Optimum:
    return optimise(evaluate, space, Budget(limit), np.random.default_rng(seed))


# ---- both ----------------------------------------------------------------------------------------------------------


@BOTH
@settings(max_examples=40, deadline=None)
@given(
    st.lists(st.tuples(*[st.integers(-3, 3)] * 3).map(sorted), min_size=1, max_size=4),
    st.integers(1, 120),
    st.integers(3000, 3100),
)
def test_bounds_and_budget_are_kept(name: str, triples: list[list[int]], limit: int, seed: int) -> None:
    # Bounds in thirds cause rounding in the map to the unit cube and back. The optimum is outside, beyond a corner.
    space = SearchSpace(tuple(Variable(f"x{i}", "m", a / 3, c / 3, b / 3) for i, (a, b, c) in enumerate(triples)))
    seen: list[FloatArray] = []

    def evaluate(points: FloatArray) -> Scores:
        seen.append(points)
        return Scores(np.zeros(len(points)), np.sum(points, axis=1))

    optimum = search(find_optimiser(name), evaluate, space, limit, seed)
    points = np.concatenate(seen)
    assert np.all((points >= space.lower) & (points <= space.upper))
    np.testing.assert_array_equal(points[0], space.default)
    assert optimum.evaluations == len(points) <= limit
    assert any(np.array_equal(optimum.point, point) for point in points)
    assert optimum.value == pytest.approx(np.max(np.sum(points, axis=1)), rel=1e-11)


@BOTH
def test_violation_comes_before_value(name: str) -> None:
    def evaluate(points: FloatArray) -> Scores:
        x, y = points.T
        return Scores(np.maximum(0.0, 1.0 - x) + np.maximum(0.0, x + y - 3.0), 100.0 * y)

    optimum = search(find_optimiser(name), evaluate, box(2))
    assert optimum.violation == 0.0
    np.testing.assert_allclose(optimum.point, [1.0, 2.0], atol=0.03 if name == "cma" else 0.3)


@BOTH
def test_what_cannot_be_met_is_violated_least(name: str) -> None:
    def evaluate(points: FloatArray) -> Scores:
        return Scores(1.0 + np.abs(points[:, 0] - 2.5), np.full(len(points), 7.0))

    optimum = search(find_optimiser(name), evaluate, box(1), 1001)
    assert optimum.point[0] == pytest.approx(2.5, abs=0.006)
    assert optimum.violation == pytest.approx(1.0, abs=0.006)


@BOTH
def test_failed_rollouts_are_survived(name: str) -> None:
    def evaluate(points: FloatArray) -> Scores:
        x = points[:, 0]
        value = np.where(np.abs(x) < 1.0, np.nan, np.where(x < -4.0, np.inf, -((x - 3.0) ** 2)))
        return Scores(np.where(x > 4.0, np.nan, 0.0), value)

    optimum = search(find_optimiser(name), evaluate, box(2))
    assert optimum.point[0] == pytest.approx(3.0, abs=0.15)
    assert optimum.history[0].value == -np.inf or np.isfinite(optimum.history[0].value)


@BOTH
def test_nothing_finite_is_an_error(name: str) -> None:
    with pytest.raises(NothingFinite, match="all 100 candidates failed") as failed:
        search(find_optimiser(name), valued(lambda points: np.full(len(points), np.nan)), box(1), 100)
    assert failed.value.evaluations == 100


@BOTH
def test_of_equal_candidates_the_one_nearest_to_the_default_wins(name: str) -> None:
    # The default is on a plateau, on which x1 has no effect and rounding disturbs the values.
    def evaluate(points: FloatArray) -> Scores:
        plateau = np.minimum(points[:, 0], 1.0)
        return Scores(np.zeros(len(points)), plateau + 1e-15 * points[:, 1])

    optimum = search(find_optimiser(name), evaluate, box(2, default=2.0))
    np.testing.assert_array_equal(optimum.point, [2.0, 2.0])


def test_ties_are_broken_in_the_unit_cube_and_then_by_order() -> None:
    space = SearchSpace((Variable("x", "m", 0.0, 4.0, 2.0), Variable("y", "m", 0.0, 400.0, 200.0)))

    def evaluate(points: FloatArray) -> Scores:
        x, y = points.T
        allowed = (
            (np.isclose(x, 1.0) & (y == 200.0)) | ((x == 2.0) & np.isclose(y, 240.0)) | ((x == 2.0) & (y == 160.0))
        )
        return Scores(np.where(allowed, 0.0, 1.0), np.zeros(len(points)))

    optimum = search(Grid(), evaluate, space, 442)
    np.testing.assert_array_equal(optimum.point, [2.0, 160.0])


@BOTH
def test_seeds_give_the_same_bits(name: str) -> None:
    def run(seed: int) -> tuple[bytes, tuple[Milestone, ...]]:
        optimum = search(find_optimiser(name), valued(lambda points: -rosenbrock(points)), box(3), 700, seed)
        return optimum.point.tobytes(), optimum.history

    assert run(3000) == run(3000)
    assert (run(3000) == run(3001)) is (name == "grid")


@BOTH
def test_history_is_the_convergence_curve(name: str) -> None:
    told: list[Milestone] = []
    optimum = find_optimiser(name, batch=16)(
        valued(lambda points: -sphere(points)), box(2, 3.0), Budget(200), np.random.default_rng(3000), told.append
    )
    assert tuple(told) == optimum.history
    evaluations = [milestone.evaluations for milestone in optimum.history]
    values = [milestone.value for milestone in optimum.history]
    assert evaluations == [17, *range(33, 200, 16), *([200] if name == "cma" else [197])]
    assert sorted(values) == values
    assert values[-1] == pytest.approx(optimum.value, rel=1e-11)
    assert optimum.evaluations == evaluations[-1]


@BOTH
def test_constants_alone_leave_nothing_to_search(name: str) -> None:
    space = SearchSpace((Variable("x", "m", 2.0, 2.0, 2.0),))
    optimum = search(find_optimiser(name), valued(lambda points: points[:, 0]), space)
    assert (optimum.point.tolist(), optimum.value, optimum.stopped) == ([2.0], 2.0, "all sampled")
    assert optimum.history[-1].value == 2.0


@BOTH
def test_constants_are_kept(name: str) -> None:
    space = SearchSpace((Variable("x", "m", 0.3, 0.3, 0.3), Variable("y", "m", -1.0, 1.0, 0.0)))
    optimum = search(find_optimiser(name), valued(lambda points: -((points[:, 1] - points[:, 0]) ** 2)), space)
    assert optimum.point[0] == 0.3
    assert optimum.point[1] == pytest.approx(0.3, abs=1e-3)


@BOTH
def test_one_evaluation_is_the_default_point(name: str) -> None:
    optimum = search(find_optimiser(name), valued(lambda points: -sphere(points)), box(3, 1.0), 1)
    np.testing.assert_array_equal(optimum.point, [1.0, 1.0, 1.0])
    assert optimum.evaluations == 1


@BOTH
def test_no_clock_ends_a_search(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def find() -> Optimum:
        return search(find_optimiser(name, batch=8), valued(lambda points: -sphere(points)), box(2), 500)

    idle = find()
    hurried(monkeypatch, jump=3600.0)
    busy = find()
    assert (idle.evaluations, idle.stopped, idle.history) == (busy.evaluations, busy.stopped, busy.history)
    np.testing.assert_array_equal(idle.point, busy.point)


def test_an_empty_budget_is_refused() -> None:
    with pytest.raises(InputError, match=r"budget\.evaluations: "):
        Budget(0)


def test_unknown_optimisers_are_refused() -> None:
    with pytest.raises(InputError, match="unknown optimiser; got 'cmaes'; did you mean 'cma'"):
        find_optimiser("cmaes")


def test_a_score_for_each_point_is_asked_for() -> None:
    with pytest.raises(ValueError, match="must return 5 scores, got 1"):
        search(CMAES(), lambda points: Scores(np.zeros(1), np.zeros(1)), box(1))


def test_cmaes_is_imported_only_to_be_used() -> None:
    program = (
        "import sys, hybrid_tamp.midlevel.cma, hybrid_tamp.midlevel.screening\n"
        "assert not {'cmaes', 'scipy'} & set(sys.modules)\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True)


# ---- CMA-ES --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("problem", PROBLEMS, ids=lambda problem: problem.name)
def test_closed_form_optima_in_ten_dimensions(problem: Problem) -> None:
    optimum = search(CMAES(restarts=0), valued(lambda points: -problem.cost(points)), box(10, problem.default), 20_000)
    np.testing.assert_allclose(optimum.point, float(problem.name == "Rosenbrock"), atol=3e-3)
    assert (optimum.stopped, optimum.violation) == ("converged", 0.0)


@pytest.mark.parametrize("problem", PROBLEMS, ids=lambda problem: problem.name)
def test_as_few_evaluations_as_cmaes_used_bare(problem: Problem) -> None:
    seeds = range(3000, 3005)
    mine, theirs = (median(count(problem, 10, seed) for seed in seeds) for count in (ours, bare))
    assert theirs < 10_000
    assert mine <= 1.1 * theirs


@pytest.mark.parametrize("best", [-5.0, -1.234, 0.0, 5.0])
def test_one_variable(best: float) -> None:
    optimum = search(find_optimiser("cma"), valued(lambda points: -np.abs(points[:, 0] - best)), box(1))
    assert optimum.point[0] == pytest.approx(best, abs=1e-3)
    assert (optimum.stopped, optimum.evaluations < 1000) == ("converged", True)


def test_optimum_in_a_corner() -> None:
    # cmaes does not reach this corner if points outside the bounds are resampled.
    seen: list[FloatArray] = []

    def evaluate(points: FloatArray) -> Scores:
        seen.append(points)
        return Scores(np.zeros(len(points)), -corner(points))

    optimum = search(CMAES(restarts=0), evaluate, box(6))
    np.testing.assert_allclose(optimum.point, 5.0, atol=1e-3)
    assert optimum.evaluations < 1500
    # Candidates are reflected at the bounds instead of clipped, so that no corner is evaluated twice.
    assert len(np.unique(np.concatenate(seen), axis=0)) == optimum.evaluations


def test_optimum_on_some_of_the_bounds() -> None:
    optimum = search(CMAES(restarts=0), valued(lambda points: -sphere(points - np.array([9.0, 1.0, -6.0]))), box(3))
    np.testing.assert_allclose(optimum.point, [5.0, 1.0, -5.0], atol=3e-3)


@given(st.lists(st.floats(-9.0, 9.0), min_size=1, max_size=5).map(np.array))
def test_folding_mirrors_into_the_cube(points: FloatArray) -> None:
    inside = fold(points)
    assert np.all((inside >= 0.0) & (inside <= 1.0))
    np.testing.assert_allclose(np.cos(np.pi * inside), np.cos(np.pi * points), atol=1e-12)


def test_start_in_a_corner() -> None:
    optimum = search(find_optimiser("cma"), valued(lambda points: -sphere(points)), box(6, default=5.0), 4000)
    np.testing.assert_allclose(optimum.point, 0.0, atol=1e-3)


def test_a_restart_leaves_a_local_optimum() -> None:
    # A broad hill at -3, near the start, and a narrow hill at 4, twice as high.
    def value(points: FloatArray) -> FloatArray:
        x = points[:, 0]
        return np.asarray(np.exp(-((x + 3.0) ** 2)) + 2.0 * np.exp(-((10.0 * (x - 4.0)) ** 2)))

    def found(restarts: int) -> int:
        optima = [
            search(CMAES(restarts=restarts, sigma=0.05), valued(value), box(1, -3.0), 10_000, s)
            for s in range(3000, 3004)
        ]
        return sum(optimum.value > 1.9 for optimum in optima)

    assert found(0) == 0
    assert found(6) == 4


def test_populations_double() -> None:
    sizes: list[int] = []

    def evaluate(points: FloatArray) -> Scores:
        sizes.append(len(points))
        return Scores(np.zeros(len(points)), -sphere(points))

    search(CMAES(population=8, restarts=2), evaluate, box(2), 10_000)
    assert sizes[0] == 9
    assert sorted(set(sizes[1:])) == [8, 16, 32]


def test_a_flat_objective_ends_early_at_the_default() -> None:
    def evaluate(points: FloatArray) -> Scores:
        return Scores(np.zeros(len(points)), 3.0 + 1e-15 * np.sin(1e3 * points[:, 0]))

    optimum = search(find_optimiser("cma"), evaluate, box(2, 1.0), 10**5)
    np.testing.assert_array_equal(optimum.point, [1.0, 1.0])
    assert optimum.stopped == "converged"
    assert optimum.evaluations < 700


@pytest.mark.parametrize("noisy", [False, True])
def test_noise_is_averaged_out(noisy: bool) -> None:
    def distance(seed: int) -> float:
        noise = np.random.default_rng(seed)
        evaluate = valued(lambda points: -sphere(points) + noise.normal(scale=0.5, size=len(points)))
        optimum = search(CMAES(noisy=noisy), evaluate, box(3, 3.0), 1000, seed)
        return float(np.linalg.norm(optimum.point))

    assert median(distance(seed) for seed in range(3000, 3005)) < 0.7


def test_too_small_a_population_is_refused() -> None:
    with pytest.raises(InputError, match="population: must be at least 4 candidates; got 3"):
        CMAES(population=3)


# ---- direct sampling -----------------------------------------------------------------------------------------------


def test_grid_takes_both_ends_and_the_default() -> None:
    seen: list[FloatArray] = []

    def evaluate(points: FloatArray) -> Scores:
        seen.append(points)
        return Scores(np.zeros(len(points)), points[:, 0])

    optimum = search(Grid(batch=4), evaluate, box(1, 0.1), 12)
    np.testing.assert_allclose(np.concatenate(seen)[:, 0], [0.1, *range(-5, 6)])
    assert [len(points) for points in seen] == [5, 4, 3]
    assert (optimum.evaluations, optimum.stopped) == (12, "all sampled")


@pytest.mark.parametrize(
    ("k", "evaluations", "counts"),
    [
        (1, 1000, (1000,)),
        (3, 1000, (10, 10, 10)),
        (3, 999, (10, 10, 9)),
        (10, 100, (2,) * 6 + (1,) * 4),
        (2, 0, (1, 1)),
    ],
)
def test_points_on_each_axis(k: int, evaluations: int, counts: tuple[int, ...]) -> None:
    assert axis_counts(k, evaluations) == counts


def test_grid_is_complete() -> None:
    seen: list[FloatArray] = []

    def evaluate(points: FloatArray) -> Scores:
        seen.append(points)
        return Scores(np.zeros(len(points)), -sphere(points))

    optimum = search(Grid(), evaluate, box(3), 5**3 + 1)
    assert {tuple(point) for point in np.concatenate(seen).tolist()} == {
        (x, y, z) for x in (-5, -2.5, 0, 2.5, 5) for y in (-5, -2.5, 0, 2.5, 5) for z in (-5, -2.5, 0, 2.5, 5)
    }
    np.testing.assert_array_equal(optimum.point, [0.0, 0.0, 0.0])


def test_an_axis_without_points_stays_at_its_default() -> None:
    optimum = search(Grid(), valued(lambda points: np.sum(points, axis=1)), box(3, 1.0), 5)
    np.testing.assert_array_equal(optimum.point, [5.0, 5.0, 1.0])
