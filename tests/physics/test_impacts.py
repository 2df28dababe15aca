"""Comparison of the largest impulse on an object with closed forms."""

import numpy as np
import pytest
from workbench import FORWARD, UP, Thing, ball, block, run, scene

from hybrid_tamp.geometry.shapes import Sphere
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.constants import GRAVITY


@pytest.mark.parametrize("start", np.linspace(-0.2, -0.21, 5))
def test_an_inelastic_blow_gives_the_impulse_of_the_reduced_mass(start: float) -> None:
    thrown = Token.make("ball", [Thing], {"mass": 1.0, "friction": 0.0}, Sphere(kind="sphere", radius=0.05))
    given = {("ball", "velocity"): 2.0 * FORWARD, ("block", "position"): 0.05 * UP}
    given["ball", "position"] = np.array([start, 0.0, 0.05])
    end = run(scene(given, ball=thrown, block=block(friction=0.0)), 0.2, lambda *_: {})[-1]
    assert end["block", "impulse"] == pytest.approx(2.0 * 2 / 3, rel=0.01)
    assert end["ball", "impulse"] == end["block", "impulse"]


def test_a_blow_remains_and_a_push_and_the_floor_count_little() -> None:
    given = {("ball", "position"): (0, 0, 0.33), ("block", "position"): 0.05 * UP}
    states = run(scene(given, ball=ball("ball", Thing, mass=1.0), block=block(50.0)), 1.0, lambda *_: {})
    hardest = [state["block", "impulse"][0] for state in states]
    # The weight of the ball increases the impulse for one control period.
    assert hardest[-1] == pytest.approx(np.sqrt(2 * GRAVITY * 0.2), abs=1.5 * GRAVITY / 240)
    assert hardest == sorted(hardest)
    lying = {("ball", "position"): (0, 0, 0.13), ("block", "position"): 0.05 * UP}
    still = run(scene(lying, ball=ball("ball", Thing, mass=1.0), block=block(50.0)), 1.0, lambda *_: {})[-1]
    assert still["block", "impulse"][0] == pytest.approx(GRAVITY / 240, rel=0.5)
