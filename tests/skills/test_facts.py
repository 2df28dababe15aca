"""Makers of feasibility facts: workspaces, shared loads, and objects that are too light."""

from pathlib import Path

import numpy as np
import pytest

import hybrid_tamp
from hybrid_tamp.model.predicate import Parameter
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.constants import GRAVITY
from hybrid_tamp.skills import StaticEndEffector, bears_share, conditions, heavy_enough, within_reach

TASK = hybrid_tamp.load_task(Path(__file__).resolve().parents[2] / "problems" / "lift_two_hands.yaml")
BOX, HAND = TASK.token_by_name["box"], TASK.token_by_name["left-hand"]
PARAMETERS = (Parameter("hand", StaticEndEffector), Parameter("object", BOX.classes[0]))


def around(state: State, hand: Token, thing: Token) -> list[FloatArray]:
    """Return places 0.3 m before and behind a box."""
    return [state[thing, "position"] + np.array([0.0, away, 0.3]) for away in (-0.3, 0.3)]


def moved(x: float, y: float) -> State:
    return TASK.state.replace({(BOX.name, "position"): np.array([x, y, 0.12])})


@pytest.mark.parametrize("carried", [False, True])
def test_a_hand_reaches_all_its_places_within_its_workspace(carried: bool) -> None:
    fact = within_reach("reachable", PARAMETERS, around, carried, reads={"object": ("position",)})
    # The workspace is 4 m x 4 m x 1.5 m, so the floor is 0.42 m below the places.
    assert float(fact.evaluate(moved(0.0, 0.0), HAND, BOX)) == pytest.approx(0.42)
    assert float(fact.evaluate(moved(0.0, 1.8), HAND, BOX)) == pytest.approx(-0.1)
    assert fact.competence
    batch = State(TASK.state.layout, np.stack([moved(0.0, 0.0).values, moved(0.0, 1.8).values]))
    assert fact.evaluate(batch, HAND, BOX) == pytest.approx([0.42, -0.1])


def test_the_bound_covers_all_displacements_of_an_object_that_carries_its_places() -> None:
    fact = within_reach("reachable", PARAMETERS, around, True, reads={"object": ("position",)})
    assert fact.bound is not None
    rng = np.random.default_rng(3)
    for _ in range(50):
        (x, y), radius = rng.uniform(-2.5, 2.5, 2), rng.uniform(0.0, 1.0)
        way = rng.uniform(-1.0, 1.0, 2) * radius / np.sqrt(2.0)
        bound = float(fact.bound(moved(x, y), radius, HAND, BOX))
        assert float(fact.evaluate(moved(x + way[0], y + way[1]), HAND, BOX)) <= bound + 1e-12
    # Without displacement, the bound is the margin of a box near the middle of the workspace.
    assert float(fact.bound(moved(0.0, 0.0), 0.0, HAND, BOX)) == pytest.approx(0.42)


def test_a_hand_without_any_place_reaches_nothing() -> None:
    for carried in (False, True):
        fact = within_reach(
            "reachable", PARAMETERS, lambda state, *values: [], carried, reads={"object": ("position",)}
        )
        assert float(fact.evaluate(TASK.state, HAND, BOX)) < 0.0


def test_a_hand_bears_its_share_with_a_safety_factor() -> None:
    def share(state: State, hand: Token, thing: Token, factor: float) -> tuple[float, float]:
        return 10.0 * thing["mass"], hand["maximal_force"] / factor

    fact = bears_share("bearable", PARAMETERS, share, 1.5, "covers errors", description="{hand}", denial="{hand}")
    assert float(fact.evaluate(TASK.state, HAND, BOX)) == pytest.approx(300.0 / 1.5 - 80.0)
    assert fact.safety is not None
    assert fact.safety.factor == 1.5
    assert not fact.competence
    assert fact.unit == "N"


def test_an_object_must_be_heavy_enough_for_the_errors_of_the_hands() -> None:
    weight = GRAVITY * 8.0
    for least, holds in ((0.9 * weight, True), (1.1 * weight, False)):
        fact = heavy_enough(BOX.classes[0], least, "lift", "tilt it instead of lifting it")
        assert (float(fact.evaluate(TASK.state, BOX)) >= 0.0) == holds


def test_conditions_name_the_roles_of_their_parameters() -> None:
    heavy = heavy_enough(BOX.classes[0], 1.0, "lift", "tilt it")
    near = within_reach("reachable", PARAMETERS, around, reads={"object": ("position",)})
    found = conditions((near, heavy), hand="first")
    assert [(each.predicate, each.arguments, each.positive) for each in found] == [
        (near, ("first", "object"), True),
        (heavy, ("object",), True),
    ]
