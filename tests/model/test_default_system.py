"""Blocks without a continuous system: hands obey their commands, and what they hold or push moves with them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from default_domains import hoisting_task, shoving_task

import hybrid_tamp
from hybrid_tamp.errors import DomainError
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.control import CONTROL_PERIOD, Commands
from hybrid_tamp.model.forward_model import roll_out
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.constants import GRAVITY
from hybrid_tamp.skills import MOTION
from hybrid_tamp.testing import check_domain

GOAL = {"region": "goal"}
TASKS = {"SHOVING": shoving_task, "HOISTING": hoisting_task}


@pytest.fixture(scope="module", params=TASKS)
def last(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="module")
def task(last: str) -> Task:
    return TASKS[last]()


def test_a_block_without_a_system_is_planned_optimised_and_run(task: Task, last: str, tmp_path: Path) -> None:
    result = hybrid_tamp.run(task, tmp_path)
    assert result.success
    recording = hybrid_tamp.load_recording(tmp_path / "recording.npz")
    (moved,) = [each for each in recording.instances if each.block == last]
    block, binding = task.domain.block_by_name[last], task.bind(moved.roles)
    predicted = roll_out(block, binding, recording.at(moved.start), block.duration.maximum)
    thing = binding["object"]
    away = predicted[-1][thing, "position"] - recording.at(moved.end)[thing, "position"]
    assert np.linalg.norm(away) < 0.01
    reached = moved.end if moved.reached is None else moved.reached
    assert len(predicted) / 240 == pytest.approx(reached - moved.start, abs=0.2)


def test_the_check_of_the_domain_reports_nothing(task: Task) -> None:
    assert check_domain(task) == []


def test_explanations_and_views_work(task: Task) -> None:
    assert hybrid_tamp.explain(task)
    assert hybrid_tamp.affordances(task)


def move(block: Block, binding: Binding, state: State, commands: Commands, steps: int = 1) -> State:
    system = block.system_maker(binding, state)
    for _ in range(steps):
        state = system(state, commands, CONTROL_PERIOD)
    return state


def test_a_declared_attachment_turns_with_the_hand_and_weighs_on_it() -> None:
    task = hoisting_task()
    block = replace(task.domain.block_by_name["HOISTING"], attached={"object": "hand"})
    binding = task.bind({"hand": "hand", "object": "can"})
    beside = task.state.replace({("can", "position"): (0.1, 0.0, 0.05)})
    weight = 0.5 * GRAVITY
    fallen = move(block, binding, beside, {})
    assert fallen["hand", "velocity"][2] == pytest.approx(-weight / 1.5 * CONTROL_PERIOD)
    borne = {("hand", "force"): np.array([0.0, 0.0, weight]), ("hand", "torque"): np.array([0.0, -0.1 * weight, 0.0])}
    still = move(block, binding, beside, borne, 10)
    np.testing.assert_allclose(still.values, beside.values, atol=1e-12)
    spinning = beside.replace({("hand", "angular_velocity"): (0.0, 0.0, 2.0)})
    turned = move(block, binding, spinning, borne, 60)
    # The torque does not turn with the can, so it tilts the hand a little.
    np.testing.assert_allclose(turned["can", "position"][:2], 0.1 * np.array([np.cos(0.5), np.sin(0.5)]), atol=1e-3)
    np.testing.assert_allclose(turned["can", "orientation"], turned["hand", "orientation"], atol=1e-12)
    free = move(replace(block, attached={}), binding, beside, {})
    np.testing.assert_array_equal(free["can", "position"], beside["can", "position"])


def test_a_pushed_body_meets_the_hand_without_a_bounce_and_stops_by_friction() -> None:
    task = shoving_task()
    block, binding = task.domain.block_by_name["SHOVING"], task.bind({"hand": "hand", "object": "crate"} | GOAL)
    touching = task.state.replace({("hand", "position"): (-0.12, 0.0, 0.06), ("hand", "velocity"): (0.3, 0.0, 0.0)})
    pushed = move(block, binding, touching, {})
    assert pushed["crate", "velocity"][0] == pytest.approx(0.3 / 1.8)
    assert pushed["hand", "velocity"][0] == pytest.approx(0.3 / 1.8)
    sliding = task.state.replace({("crate", "velocity"): (0.5, 0.0, 0.0)})
    stopped = move(block, binding, sliding, {}, 60)
    assert np.all(stopped["crate", "velocity"] == 0.0)
    assert stopped["crate", "position"][0] == pytest.approx(0.5**2 / (2 * 0.4 * GRAVITY), abs=0.002)
    aside = touching.replace({("hand", "position"): (-0.12, 0.3, 0.06)})
    np.testing.assert_array_equal(move(block, binding, aside, {})["crate", "velocity"], np.zeros(3))


def test_only_written_properties_change() -> None:
    task = shoving_task(writes={"hand": MOTION, "object": ("position",)})
    block, binding = task.domain.block_by_name["SHOVING"], task.bind({"hand": "hand", "object": "crate"} | GOAL)
    touching = task.state.replace({("hand", "position"): (-0.12, 0.0, 0.06), ("hand", "velocity"): (0.3, 0.0, 0.0)})
    after = move(block, binding, touching, {})
    assert after["crate", "position"][0] > 0.0
    assert np.all(after["crate", "velocity"] == 0.0)


@pytest.mark.parametrize("attached", [{"objekt": "hand"}, {"object": "haand"}])
def test_attached_names_slots(attached: dict[str, str]) -> None:
    with pytest.raises(DomainError, match=r"SHOVING\.attached: .*slots to slots"):
        shoving_task(attached=attached)
