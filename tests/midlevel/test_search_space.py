"""Tests of variables and search spaces: bounds, the unit cube and subspaces."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hybrid_tamp.errors import InputError
from hybrid_tamp.midlevel.search_space import SearchSpace, Variable

SPACE = SearchSpace(
    (
        Variable("grasp", "m", 0.02, 0.25, 0.1),
        Variable("mass", "kg", 0.3, 0.3, 0.3),
        Variable("speed", "m/s", -1.0, 3.0, 0.0),
    )
)
numbers = st.floats(-1e6, 1e6, allow_subnormal=False)


@st.composite
def spaces(draw: st.DrawFn) -> SearchSpace:
    triples = draw(st.lists(st.tuples(numbers, numbers, numbers).map(sorted), min_size=1, max_size=5))
    return SearchSpace(tuple(Variable(f"x{i}", "m", a, c, b) for i, (a, b, c) in enumerate(triples)))


@pytest.mark.parametrize(
    ("lower", "upper", "default", "words"),
    [
        (1.0, 0.0, 0.5, "grasp: the bounds must be finite with lower <= upper; got [1.0, 0.0]"),
        (0.0, np.inf, 0.5, "grasp: the bounds must be finite with lower <= upper; got [0.0, inf]"),
        (np.nan, 1.0, 0.5, "grasp: the bounds must be finite with lower <= upper; got [nan, 1.0]"),
        (0.0, 1.0, 1.5, "grasp: the default must be within [0.0, 1.0]; got 1.5"),
        (0.0, 1.0, np.nan, "grasp: the default must be within [0.0, 1.0]; got nan"),
    ],
)
def test_bad_bounds_are_refused(lower: float, upper: float, default: float, words: str) -> None:
    with pytest.raises(InputError) as refused:
        Variable("grasp", "m", lower, upper, default)
    assert str(refused.value) == words


def test_names_are_unique() -> None:
    with pytest.raises(InputError, match="grasp: the names of variables must be unique"):
        SearchSpace((SPACE.variables[0], SPACE.variables[0]))


def test_arrays() -> None:
    assert SPACE.names == ("grasp", "mass", "speed")
    assert SPACE.d == 3
    assert SPACE.varying == ("grasp", "speed")
    np.testing.assert_array_equal(SPACE.lower, [0.02, 0.3, -1.0])
    np.testing.assert_array_equal(SPACE.upper, [0.25, 0.3, 3.0])
    np.testing.assert_array_equal(SPACE.default, [0.1, 0.3, 0.0])
    np.testing.assert_array_equal(
        SPACE.clip(np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]])), [[0.02, 0.3, 0], [0.25, 0.3, 1]]
    )


def test_constants_have_no_extent_in_the_cube() -> None:
    np.testing.assert_allclose(SPACE.to_unit(np.array([0.135, 0.3, 2.0])), [0.5, 0.0, 0.75])
    np.testing.assert_allclose(SPACE.from_unit(np.array([0.5, 0.7, 0.75])), [0.135, 0.3, 2.0])


@given(spaces(), st.integers(0, 1000))
def test_the_cube_maps_into_the_bounds_and_back(space: SearchSpace, seed: int) -> None:
    cube = np.random.default_rng(seed).integers(0, 4, size=(8, space.d)) / 3.0
    points = space.from_unit(cube)
    assert np.all((points >= space.lower) & (points <= space.upper))
    scale = np.maximum(np.abs(space.lower), np.abs(space.upper))
    assert np.all(np.abs(space.from_unit(space.to_unit(points)) - points) <= 1e-15 * (4.0 * scale))
    np.testing.assert_array_equal(space.from_unit(np.ones(space.d)) <= space.upper, True)


def test_a_part_leaves_the_others_at_their_defaults() -> None:
    part = SPACE.only(["speed", "grasp"])
    assert part.names == ("grasp", "speed")
    np.testing.assert_array_equal(part.embed(np.array([[0.2, 1.0], [0.25, 3.0]])), [[0.2, 0.3, 1.0], [0.25, 0.3, 3.0]])
    np.testing.assert_array_equal(part.only(["speed"]).embed(np.array([[2.0]])), [[0.1, 2.0]])
    np.testing.assert_array_equal(SPACE.only([]).embed(np.empty((2, 0))), [SPACE.default] * 2)
    np.testing.assert_array_equal(SPACE.embed(SPACE.default[None]), [SPACE.default])


def test_unknown_names_are_refused() -> None:
    with pytest.raises(InputError, match="unknown hyperparameter; got 'grsp'; did you mean 'grasp'"):
        SPACE.only(["grsp", "speed"])
