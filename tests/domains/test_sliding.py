"""Closed forms of the forces that turn a box about its edge without letting the edge slide."""

import numpy as np
import pytest
from hybrid_tamp_domains.rolling_tumbling.classes import Tumblable
from hybrid_tamp_domains.rolling_tumbling.sliding import STEADY, friction_needed, press, squeeze_needed, squeeze_range
from scipy.optimize import linprog

from hybrid_tamp.model.token import Token

CASES = [(78.5, 0.22, 0.12, 0.4), (196.2, 0.352, 0.16, 0.4), (78.5, 0.38, 0.2, 0.5), (100.0, 0.3, 0.1, 0.6)]
"""Boxes whose edge slides at a squeeze of half the weight: weight [N], width [m], height of the hands [m] and
friction."""


def least_squeeze(weight: float, width: float, height: float, friction: float) -> float:
    """Return the smallest squeeze [N] for which forces in the friction cones balance, found by a linear program.

    The unknowns are the squeeze S, the difference D of the normal forces, and the load on the edge. The friction of
    both hands is at its limit, as for hands that slide upwards and downwards on their faces.
    """
    hand = friction / 2.0
    balance = [[hand * width, height + hand * width / 2.0, 0.0], [0.0, hand, 1.0]]
    right = [weight * width / 2.0, weight]
    cone = [[0.0, 1.0, -friction], [-1.0, 0.5, 0.0]]
    found = linprog([1.0, 0.0, 0.0], A_ub=cone, b_ub=[0.0, 0.0], A_eq=balance, b_eq=right, bounds=[(0, None)] * 3)
    return float(found.x[0])


@pytest.mark.parametrize("case", CASES)
def test_the_smallest_squeeze_is_that_of_a_linear_program(case: tuple[float, float, float, float]) -> None:
    assert squeeze_needed(*case) == pytest.approx(max(least_squeeze(*case), case[0] / 2.0), rel=1e-6)


def test_a_box_on_a_rough_floor_needs_no_more_than_half_its_weight() -> None:
    assert squeeze_needed(100.0, 0.2, 0.3, 0.9) == 50.0


def test_without_friction_no_squeeze_holds_the_edge() -> None:
    assert squeeze_needed(100.0, 0.2, 0.3, 0.0) == np.inf
    assert press(100.0, 0.2, 0.3, 0.0, np.inf) == np.inf


@pytest.mark.parametrize("force", [150.0, 250.0])
def test_the_friction_needed_is_that_at_which_the_hands_press_with_their_whole_force(force: float) -> None:
    needed = friction_needed(196.2, 0.352, 0.16, force)
    squeeze = STEADY * least_squeeze(196.2, 0.352, 0.16, needed)  # Weak hands squeeze with less than half the weight.
    assert press(196.2, 0.352, 0.16, needed, squeeze) == pytest.approx(force, rel=1e-6)
    assert friction_needed(196.2, 0.352, 0.16, 2.0 * force) < needed


@pytest.mark.parametrize(("friction", "force"), [(0.4, 250.0), (0.4, 400.0), (0.9, 300.0)])
def test_a_hand_presses_with_its_whole_force_at_the_largest_squeeze(friction: float, force: float) -> None:
    box = Token.make("box", [Tumblable], {"half_extents": (0.11, 0.1, 0.176), "mass": 20.0, "friction": friction})
    smallest, ideal, largest = squeeze_range(box, "bottom", "right", force)
    assert press(9.81 * 20.0, 0.352, 0.72 * 0.22, friction, largest) == pytest.approx(force)
    assert smallest <= ideal <= largest
    assert ideal == min(largest, squeeze_needed(9.81 * 20.0, 0.352, 0.72 * 0.22, friction))
