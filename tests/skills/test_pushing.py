"""The forward model of a push agrees with closed forms, and domains are assembled from their blocks."""

from pathlib import Path

import numpy as np
import pytest
from hybrid_tamp_domains.rolling_tumbling import DOMAIN as ROLLING_TUMBLING

import hybrid_tamp
from hybrid_tamp.model.control import Parameters
from hybrid_tamp.model.expectation import expect
from hybrid_tamp.model.forward_model import ForwardModel
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.constants import GRAVITY
from hybrid_tamp.skills import derive_edges, find_classes, find_predicates

TASK = hybrid_tamp.load_task(Path(__file__).resolve().parents[2] / "examples" / "sweeping" / "task.yaml")
SWEEPING = TASK.domain.block_by_name["SWEEPING"]
BINDING = TASK.bind({"hand": "hand", "object": "walnut", "table": "table", "tray": "tray"})
FRICTION = 0.6 * 0.8


def start(**position: tuple[float, float, float]) -> State:
    return TASK.state.replace({(name, "position"): np.array(place) for name, place in position.items()})


def rolled(state: State, seconds: float) -> list[State]:
    model = ForwardModel(SWEEPING, BINDING, state, Parameters(SWEEPING.initial_values(BINDING, state)))
    states = [state]
    for step in range(round(seconds * 240)):
        states.append(model.step(np.float64(step / 240), states[-1])[0])
    return states


def test_an_object_that_nothing_pushes_slides_by_the_distance_of_coulomb_friction() -> None:
    begin = start(hand=(-0.5, 0.1, 0.34)).replace({("walnut", "velocity"): np.array([0.8, 0.0, 0.0])})
    begin = begin.replace({("walnut", "position"): np.array([-0.2, 0.1, 0.32])})
    way = rolled(begin, 0.4)[-1]["walnut", "position"][0] + 0.2
    # The speed changes at the beginning of each step, so the way is shorter by half a step.
    assert way == pytest.approx(0.8**2 / (2.0 * FRICTION * GRAVITY) - 0.8 / 480, rel=0.005)


def test_an_object_beyond_the_edge_falls_like_a_stone_and_lands_in_the_tray() -> None:
    begin = start(hand=(0.0, 0.1, 0.34), walnut=(0.46, 0.1, 0.32))
    falling = rolled(begin, 0.3)
    height = 0.32 - 0.04
    steps = next(i for i, state in enumerate(falling) if state["walnut", "position"][2] <= 0.04 + 1e-9)
    assert steps / 240 == pytest.approx(np.sqrt(2.0 * height / GRAVITY), rel=0.03)
    assert falling[-1]["walnut", "position"].tolist() == pytest.approx([0.46, 0.1, 0.04])


def test_the_expected_end_of_a_sweep_holds_its_exit_conditions() -> None:
    begin = start(hand=(0.01, 0.1, 0.34))
    expected = expect(SWEEPING, BINDING, begin, SWEEPING.initial_values(BINDING, begin))
    assert expected.end is not None
    assert all(float(each.margin(expected.end, BINDING)) >= 0 for each in SWEEPING.measured_exits)
    assert 1.0 < expected.seconds < 4.0


def test_a_rollout_that_comes_to_rest_without_its_exits_ends_early() -> None:
    lost = start(hand=(0.01, 0.1, 0.34), tray=(2.0, 0.0, 0.06))
    expected = expect(SWEEPING, BINDING, lost, SWEEPING.initial_values(BINDING, lost))
    assert expected.seconds < SWEEPING.duration.maximum / 2


def test_a_domain_is_assembled_from_its_blocks() -> None:
    assert [each.name for each in find_classes(TASK.domain.blocks)] == [
        "STATIC END-EFFECTOR",
        "CRUMB",
        "SURFACE",
        "CONTAINER",
    ]
    assert {"cleared", "lies_on", "behind", "at_rest"} <= {each.name for each in find_predicates(TASK.domain.blocks)}
    assert ("REACHING:behind.hand", "SWEEPING.hand") in set(derive_edges(TASK.domain.blocks))
    assert ("RESTING.token", "SWEEPING.hand") not in set(derive_edges(TASK.domain.blocks))


def test_derived_edges_are_edges_of_a_network_written_by_hand() -> None:
    blocks = [b for b in ROLLING_TUMBLING.blocks if b.name in ("REACHING:behind", "ROLLING", "RESTING")]
    derived = {tuple(tuple(end.rsplit(".", 1)) for end in edge) for edge in derive_edges(blocks)}
    assert derived <= set(ROLLING_TUMBLING.network.edges)
