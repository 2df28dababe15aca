"""The pair of bodies whose planned and measured distances differ most."""

from dataclasses import replace

import pytest

from hybrid_tamp.model.closest_pair import ClosestPair, find_worst

PAIR = ClosestPair("REACHING-1", "hand", "wall", 0.02, 1.0, ((0.0, 0.0, 0.0), (0.0, 0.0, 0.02)))


def test_the_worst_pair_is_the_one_with_the_largest_difference_in_either_direction() -> None:
    pairs = [replace(PAIR, other=f"wall-{number}", measured=each) for number, each in enumerate((0.021, 0.013, None))]
    worst = find_worst(pairs)
    assert worst is pairs[1]
    assert worst.error == pytest.approx(0.007)


def test_pairs_that_no_run_has_measured_are_left_out() -> None:
    assert PAIR.error == 0.0
    assert find_worst([PAIR]) is None
    assert find_worst([]) is None
