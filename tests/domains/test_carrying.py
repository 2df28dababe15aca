"""Tests of boxes that hands carry to a region: forward model, paths, gaps in walls, and runs in PyBullet."""

from pathlib import Path

import numpy as np
import pytest
from hybrid_tamp_domains.joint_lifting.bearing import carried_system
from hybrid_tamp_domains.joint_lifting.load import friction
from hybrid_tamp_domains.joint_lifting.places import CREWS, SLOTS, Roles, height, place_at
from hybrid_tamp_domains.joint_lifting.predicates import DESTINATION_WITHIN_REACH
from random_tasks.carrying import random_carrying

import hybrid_tamp
from hybrid_tamp.collision.bodies import bodies_of, find_nearest, pose_of
from hybrid_tamp.execution.execute import execute
from hybrid_tamp.model.control import CONTROL_PERIOD, Commands, Parameters
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import rotate
from hybrid_tamp.physics.protocol import Backend, open_backend
from hybrid_tamp.report.measures import CONTACT, run_measures
from hybrid_tamp.skills import normal
from hybrid_tamp.taskfile.loader import load_task

PROBLEMS = Path(__file__).parents[2] / "problems"
UP = np.array([0.0, 0.0, 1.0])


def carrying(mode: str) -> Task:
    return load_task(PROBLEMS / f"carry_{mode}_hands.yaml")


def roles_of(task: Task, mode: str) -> dict[str, str]:
    """Return a mapping from roles to tokens. Every hand is in the slot for the side on which it starts."""
    thing = task.token_by_name["box" if mode == "two" else "crate"]
    found = {"object": thing.name, "region": "goal"}
    hands = [token for token in task.tokens if token.basic_actions]
    for slot, place in zip(SLOTS, CREWS[f"{mode} hands"], strict=False):
        spot = place_at(task.state, hands[0], thing, place)
        found[slot] = min(hands, key=lambda hand: float(np.linalg.norm(spot - task.state[hand, "position"]))).name
    return found


def borne(task: Task, mode: str) -> State:
    """Return the state in which the hands touch the box, 0.15 m above the floor."""
    roles = Roles.of(f"{mode} hands", task.bind(roles_of(task, mode)))
    up = task.state.replace({(roles.thing.name, "position"): task.state[roles.thing, "position"] + 0.15 * UP})
    return up.replace({(h.name, "position"): place_at(up, h, roles.thing, place, 0.0) for h, place in roles.hands})


def commands_of(task: Task, mode: str, squeeze: float, extra: FloatArray) -> Commands:
    """Return forces with which each hand squeezes the box, and an additional force ``(3,)`` [N] of each hand."""
    roles = Roles.of(f"{mode} hands", task.bind(roles_of(task, mode)))
    state = borne(task, mode)
    return {(h.name, "force"): extra - squeeze * normal(state, roles.thing, face) for h, face in roles.contacts}


def carry(task: Task, mode: str, physics: Backend, path: FloatArray | None = None) -> State:
    """Run CARRYING until its exit conditions hold, for at most 15 s, and return the states ``(t,)``."""
    block, roles = task.domain.block_by_name[f"CARRYING:{mode}"], roles_of(task, mode)
    binding, state = task.bind(roles), borne(task, mode)
    state = physics.reset(task, state)
    slots = {slot: token for slot, token in roles.items() if slot != "region"}
    physics.assign([BlockInstance("CARRYING-1", block.name, slots, 0.0, 1.0)])
    assert block.policy is not None
    policy = block.policy(binding, state, Parameters(block.initial_values(binding, state), path))
    rows = [state.values]
    for step in range(round(15.0 / CONTROL_PERIOD)):
        state = physics.step(policy(np.asarray(step * CONTROL_PERIOD), state))
        rows.append(state.values)
        if step > 240 and all(float(literal.margin(state, binding)) >= 0 for literal in block.measured_exits):
            return State(state.layout, np.array(rows))
    pytest.fail("the box did not arrive")


@pytest.mark.parametrize("mode", ["two", "four"])
def test_hands_and_box_share_a_sideways_force(mode: str) -> None:
    """The acceleration of all bodies is the total force over the total mass, along and across the faces."""
    task, state = carrying(mode), borne(carrying(mode), mode)
    roles = Roles.of(f"{mode} hands", task.bind(roles_of(task, mode)))
    system = carried_system(f"{mode} hands", task.bind(roles_of(task, mode)), state)
    count, mass = len(roles.hands), roles.thing["mass"]
    weight = mass * 9.81 / count * UP
    for push in (np.array([10.0, 0.0, 0.0]), np.array([0.0, 10.0, 0.0]), np.array([3.0, -4.0, 5.0])):
        after = system(state, commands_of(task, mode, 250.0, push + weight), CONTROL_PERIOD)
        wanted = count * push / (mass + count * 1.5) * CONTROL_PERIOD
        for token in (roles.thing, *(hand for hand, _ in roles.hands)):
            assert after[token, "velocity"] == pytest.approx(wanted, abs=1e-9)


def test_friction_limits_what_hands_pass_on() -> None:
    """Two hands with a squeeze S accelerate the box along its faces by at most 2 mu S/m."""
    task, state = carrying("two"), borne(carrying("two"), "two")
    thing = task.token_by_name["box"]
    system = carried_system("two hands", task.bind(roles_of(task, "two")), state)
    after = system(state, commands_of(task, "two", 50.0, np.array([0.0, 200.0, 0.0])), CONTROL_PERIOD)
    gained = (after[thing, "velocity"] + 9.81 * CONTROL_PERIOD * UP) / CONTROL_PERIOD
    assert np.linalg.norm(gained) == pytest.approx(2.0 * friction(thing) * 50.0 / thing["mass"])
    assert float(after["left-hand", "velocity"][1]) > float(after[thing, "velocity"][1])


def test_a_batch_gives_what_its_members_give() -> None:
    task, state = carrying("four"), borne(carrying("four"), "four")
    system = carried_system("four hands", task.bind(roles_of(task, "four")), state)
    each = [commands_of(task, "four", squeeze, np.array([20.0, 5.0, 60.0])) for squeeze in (20.0, 200.0)]
    batch = {key: np.stack([commands[key] for commands in each]) for key in each[0]}
    together = system(state.repeated(2), batch, CONTROL_PERIOD)
    for row, commands in zip(together.values, each, strict=True):
        assert row == pytest.approx(system(state, commands, CONTROL_PERIOD).values)


@pytest.mark.parametrize("backend", ["analytic", "pybullet"])
@pytest.mark.parametrize("mode", ["two", "four"])
def test_a_carried_box_follows_its_path_and_keeps_its_height(mode: str, backend: str) -> None:
    task = carrying(mode)
    thing = task.token_by_name["box" if mode == "two" else "crate"]
    corner = task.state["goal", "position"] * np.array([1.0, 0.0, 0.0])
    with open_backend(backend) as physics:
        run = carry(task, mode, physics, np.stack([task.state[thing, "position"], corner + 0.3 * UP, np.zeros(3)]))
    place = run[thing, "position"]
    assert place[-1, :2] == pytest.approx(task.state["goal", "position"][:2], abs=0.004)
    assert height(run, thing)[-1] == pytest.approx(0.15, abs=0.003)
    # Halfway to the rounded corner, the box is on the first leg. On a straight way, it would have a larger y.
    first_leg = place[place[:, 0] < 0.7 * corner[0]]
    assert np.abs(first_leg[:, 1]).max() < 0.004
    assert float(np.degrees(np.arccos(np.clip(run[thing, "orientation"][:, 3], -1.0, 1.0))).max()) < 0.5


def test_hands_must_be_in_their_workspaces_at_the_region() -> None:
    """The right hand is 0.185 m ahead of the box, and its workspace ends at 2 m."""
    task = carrying("two")
    hand, box, region = (task.token_by_name[name] for name in ("right-hand", "box", "goal"))
    for x, reached in ((1.79, True), (1.81, False)):
        state = task.state.replace({("goal", "position"): np.array([x, 0.0, 0.0])})
        assert (float(DESTINATION_WITHIN_REACH.evaluate(state, hand, box, "right", region)) >= 0) == reached


def test_random_gaps_are_1_2_to_2_times_as_wide_as_the_box() -> None:
    ratios = []
    for seed in range(20):
        task = random_carrying(seed)
        assert np.array_equal(task.state.values, random_carrying(seed).state.values)
        walls, bodies = ("left wall", "right wall"), bodies_of(task)
        one, other = ((bodies[name], pose_of(task.state, name)) for name in walls)
        across = rotate(task.state["left wall", "orientation"], np.array([0.0, 1.0, 0.0]))
        halves = np.diag(task.token_by_name["box"]["half_extents"])
        width = 2.0 * np.abs(rotate(task.state["box", "orientation"], halves) @ across).sum()
        ratios.append(find_nearest(*one, *other).distance / width)
    assert 1.19 < min(ratios) < 1.4
    assert 1.8 < max(ratios) < 2.01


def test_two_hands_carry_a_box_through_a_gap() -> None:
    """The gap is 0.1 m wider than the box. The box passes each wall without a touch, and stands in the region."""
    task = load_task(PROBLEMS / "carry_through_gap.yaml")
    plan = hybrid_tamp.plan(task).required()
    assert not check_law(task, plan)
    blocks = [instance.block for instance in plan.instances if instance.block != "RESTING"]
    assert blocks == ["REACHING:place"] * 2 + ["LIFTING:two", "CARRYING:two", "LOWERING:two"]
    (carried,) = (instance for instance in plan.instances if instance.block == "CARRYING:two")
    assert len(carried.path) > 2
    with open_backend("pybullet") as physics:
        recording = execute(task, plan, physics)
    assert recording.success
    assert not check_law(task, recording.plan, recording.at)
    assert run_measures(plan, recording)[CONTACT] == 0.0
    bodies = bodies_of(task)
    least = min(
        find_nearest(bodies[name], pose_of(state, name), bodies[wall], pose_of(state, wall)).distance
        for state in (State(recording.trajectory.layout, row) for row in recording.trajectory.values[::24])
        for name in ("box", "left-hand", "right-hand")
        for wall in ("long wall", "short wall")
    )
    assert 0.005 < least < 0.05
    passing = recording.trajectory["box", "position"]
    through = passing[np.abs(passing[:, 0] - 0.9).argmin()]
    assert -0.04 + 0.14 < through[1] < 0.44 - 0.14
