"""Tests of the screening of hyperparameters. Hyperparameters without effect are found, and all others are kept."""

from collections.abc import Callable

import numpy as np
import pytest

from hybrid_tamp.midlevel.optimiser import NothingFinite
from hybrid_tamp.midlevel.scores import Scores
from hybrid_tamp.midlevel.screening import screen_hyperparameters
from hybrid_tamp.midlevel.search_space import SearchSpace, Variable
from hybrid_tamp.motion.arrays import FloatArray

SEEDS = range(3000, 3020)
RELEVANT = tuple(f"x{i}" for i in range(1, 6))
DUMMIES = tuple(f"dummy{i}" for i in range(1, 6))
DEFAULT_5 = 0.7
SPACE = SearchSpace(
    (
        *(Variable(name, "m", -1.0, 1.0, DEFAULT_5 if name == "x5" else 0.1) for name in RELEVANT),
        *(Variable(name, "N", 0.0, 40.0, 10.0) for name in DUMMIES),
        Variable("constant", "s", 2.0, 2.0, 2.0),
    )
)


def value(points: FloatArray) -> FloatArray:
    """x4 has an effect only through an interaction, and not at the default. x5 has an effect only if x4 is not 0."""
    x1, x2, x3, x4, x5 = points[:, :5].T
    return np.asarray(3.0 * x1 - (x2 - 0.5) ** 2 + np.sin(2.0 * np.pi * x3) + x4 * (x5 - DEFAULT_5))


def always(points: FloatArray) -> Scores:
    return Scores(np.zeros(len(points)), value(points))


def sometimes(points: FloatArray) -> Scores:
    """All conditions hold in 20 % of the volume; elsewhere the value carries no information."""
    violation = np.maximum(0.0, np.abs(points[:, 0] - 0.1) - 0.2)
    return Scores(violation, np.where(violation > 0.0, 1e6 * violation * points[:, 1], value(points)))


def by_violation_alone(points: FloatArray) -> Scores:
    return Scores(np.maximum(0.0, 1.0 + value(points)), np.zeros(len(points)))


def failing(points: FloatArray) -> Scores:
    """Rollouts fail in a quarter of the volume."""
    return Scores(np.zeros(len(points)), np.where(points[:, 0] + points[:, 3] > 0.59, np.nan, value(points)))


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("evaluate", [always, sometimes, by_violation_alone, failing])
def test_all_dummies_and_no_others_are_free(evaluate: Callable[[FloatArray], Scores], seed: int) -> None:
    found = screen_hyperparameters(evaluate, SPACE, np.random.default_rng(seed))
    assert found.free == DUMMIES
    assert found.relevant == RELEVANT
    assert found.evaluations == 32 * (4 * 10 + 1)
    assert all(found.effects[name] == (0.0, 0.0) for name in DUMMIES)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("evaluate", [always, sometimes, by_violation_alone])
def test_noise_is_no_effect(evaluate: Callable[[FloatArray], Scores], seed: int) -> None:
    noise = np.random.default_rng(seed + 1000)

    def blur(figures: FloatArray, n: int | None = None) -> FloatArray:
        return 1e-4 * np.ptp(figures) * noise.normal(size=n or len(figures))

    def noisy(points: FloatArray) -> Scores:
        scores = evaluate(points)
        broken = scores.violation > 0.0
        # Conditions with a large margin also hold with noise.
        violation = np.where(broken, np.abs(scores.violation + blur(scores.violation)), 0.0)
        return Scores(violation, scores.value + blur(scores.value[~broken], len(points)))

    found = screen_hyperparameters(noisy, SPACE, np.random.default_rng(seed))
    assert found.free == DUMMIES


def test_an_effect_that_is_absent_at_the_default_is_found() -> None:
    at_default = np.tile(SPACE.default, (2, 1))
    at_default[:, 3] = [-1.0, 1.0]
    assert np.ptp(value(at_default)) == 0.0
    assert screen_hyperparameters(always, SPACE, np.random.default_rng(3000)).effects["x4"].value > 1.0


def test_a_variable_that_makes_rollouts_fail_is_relevant() -> None:
    def evaluate(points: FloatArray) -> Scores:
        return Scores(np.zeros(len(points)), np.where(points[:, 5] > 30.0, np.nan, value(points)))

    found = screen_hyperparameters(evaluate, SPACE, np.random.default_rng(3000))
    assert found.effects["dummy1"].violation == np.inf
    assert found.free == DUMMIES[1:]


def test_the_value_does_not_count_where_conditions_are_violated() -> None:
    def evaluate(points: FloatArray) -> Scores:
        scores = sometimes(points)
        return Scores(scores.violation, scores.value + np.where(scores.violation > 0.01, points[:, 5], 0.0))

    assert screen_hyperparameters(evaluate, SPACE, np.random.default_rng(3000)).free == DUMMIES


def test_where_no_point_meets_the_conditions_the_value_counts_everywhere() -> None:
    def evaluate(points: FloatArray) -> Scores:
        return Scores(np.full(len(points), 0.5), value(points))

    assert screen_hyperparameters(evaluate, SPACE, np.random.default_rng(3000)).free == DUMMIES


def test_a_flat_objective_leaves_everything_free() -> None:
    found = screen_hyperparameters(
        lambda p: Scores(np.zeros(len(p)), np.full(len(p), 3.0)), SPACE, np.random.default_rng(3000)
    )
    assert (found.free, found.relevant) == ((*RELEVANT, *DUMMIES), ())


def test_points_are_within_bounds_in_one_batch_and_the_same_for_a_seed() -> None:
    batches: list[FloatArray] = []

    def evaluate(points: FloatArray) -> Scores:
        batches.append(points)
        return always(points)

    found = [
        screen_hyperparameters(evaluate, SPACE, np.random.default_rng(seed), bases=8) for seed in (3000, 3000, 3001)
    ]
    assert [len(points) for points in batches] == [8 * 41] * 3
    assert np.all((batches[0] >= SPACE.lower) & (batches[0] <= SPACE.upper))
    np.testing.assert_allclose(batches[0][0], SPACE.default, rtol=1e-14)
    assert np.array_equal(batches[0], batches[1])
    assert not np.array_equal(batches[0], batches[2])
    assert found[0] == found[1]
    # In the latin hypercube, every eighth of an axis except one contains a base point.
    assert sorted(np.floor((batches[0][1:8, 0] + 1.0) / 2.0 * 7.0)) == list(range(7))


def test_a_space_of_constants_has_nothing_to_find() -> None:
    found = screen_hyperparameters(always, SPACE.only(["constant"]), np.random.default_rng(3000))
    assert (found.free, found.relevant, found.evaluations) == ((), (), 0)


def test_nothing_finite_is_an_error() -> None:
    with pytest.raises(NothingFinite):
        screen_hyperparameters(lambda p: Scores(np.full(len(p), np.nan), value(p)), SPACE, np.random.default_rng(3000))
