"""The order of candidates: violation first, then value; failed rollouts last."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hybrid_tamp.midlevel.scores import Scores

NAN, INF = np.nan, np.inf
figures = st.sampled_from([0.0, 1e-300, 0.5, 1.0, 2.0, NAN, INF])
candidates = st.lists(st.tuples(figures, figures | st.sampled_from([-1.0, -INF])), min_size=1, max_size=12)


def key(violation: float, value: float) -> tuple[float, float]:
    failed = not (np.isfinite(violation) and np.isfinite(value))
    return (INF, INF) if failed else (violation, -value)


def test_ranks() -> None:
    scores = Scores(np.array([0.0, 0.0, 1e-300, NAN, 0.0, 0.5, 0.0]), np.array([1.0, 2.0, 1e9, 7.0, NAN, INF, 2.0]))
    np.testing.assert_array_equal(scores.ranks(), [1, 0, 2, 3, 3, 3, 0])
    np.testing.assert_array_equal(scores.finite, [True, True, True, False, False, False, True])


@given(candidates)
def test_ranks_keep_the_lexicographic_order(pairs: list[tuple[float, float]]) -> None:
    ranks = Scores(*np.array(pairs).T).ranks()
    keys = [key(*pair) for pair in pairs]
    places = sorted(set(keys))
    np.testing.assert_array_equal(ranks, [places.index(each) for each in keys])


@given(candidates)
def test_the_best_are_those_of_rank_zero(pairs: list[tuple[float, float]]) -> None:
    scores = Scores(*np.array(pairs).T)
    np.testing.assert_array_equal(scores.best(), scores.ranks() == 0)


def test_the_best_are_equal_but_for_rounding() -> None:
    value = np.array([5.0, 5.0 + 1e-14, 5.0 - 1e-9, 6.0])
    np.testing.assert_array_equal(Scores(np.array([0.0, 0.0, 0.0, 1e-300]), value).best(), [True, True, False, False])
    # If violations differ only by rounding, the value decides.
    np.testing.assert_array_equal(Scores(np.full(4, 0.3) + 1e-16, value).best(), [False, False, False, True])


@pytest.mark.parametrize(
    ("violation", "value", "words"),
    [
        ([0.0], [1.0, 2.0], "got \\(1,\\) and \\(2,\\)"),
        ([[0.0]], [[0.0]], "shape"),
        ([-0.1, NAN], [0.0, 0.0], "got -0.1"),
    ],
)
def test_what_is_no_score_is_refused(violation: list[float], value: list[float], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        Scores(np.array(violation), np.array(value))
