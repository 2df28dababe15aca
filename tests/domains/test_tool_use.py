"""Tests of tool use with the forward models: closed forms, the best grasp, feasibility and batches."""

from collections.abc import Callable
from itertools import chain
from pathlib import Path

import numpy as np
import pytest
from hybrid_tamp_domains.tool_use import DOMAIN
from hybrid_tamp_domains.tool_use.classes import Striker
from hybrid_tamp_domains.tool_use.feasibility import ABLE_TO_STRIKE
from hybrid_tamp_domains.tool_use.geometry import RAISED, push_pose, top
from hybrid_tamp_domains.tool_use.swing import LARGEST_RADIUS, largest_impulse, swing_of
from random_tasks.hammer import Scene, hammer_shape, hammer_task, random_hammer
from validation import val_accepts

import hybrid_tamp
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.control import CONTROL_PERIOD, Parameters
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.predicate import ANY, Atom, Binding
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import rotate
from hybrid_tamp.skills import Graspable, attitude, on_handle
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.taskfile.domains import find_task_file
from hybrid_tamp.taskfile.loader import load_task
from hybrid_tamp.testing import check_domain

USES = {"push": ("CARRYING:push", "PUSHING"), "strike": ("CARRYING:strike", "STRIKING")}
PROBLEMS = ("hammer_push", "hammer_strike", "hammer_push_then_strike")
TASK = hammer_task("hammer", Scene())
HAND, HAMMER, BLOCK = TASK.tokens[:3]
GRASPS = np.linspace(0.0, 0.15, 31)
USED = {"hand": HAND, "tool": HAMMER, "object": BLOCK, "region": TASK.token_by_name["goal"]}
SECONDS = {"PUSHING": 10.0, "STRIKING": 2.0}
"""Largest duration of a rollout [s]."""
FORCE = 0.5 * 9.81 * 2.0
"""Friction force of the floor on the block [N]."""


def held(state: State, place: FloatArray, orientation: FloatArray, grasps: FloatArray) -> State:
    """Return states in which the hand holds the hammer at an arbitrary place."""
    at = place + rotate(orientation, on_handle(HAMMER, grasps))
    return state.repeated(len(grasps)).replace(
        {
            ("hammer", "position"): place,
            ("hammer", "orientation"): orientation,
            ("hand", "position"): at,
            ("hand", "orientation"): orientation,
            ("hand", "aperture"): HAMMER["handle_width"],
        }
    )


def ready_to_push(grasps: FloatArray, distance: float) -> State:
    state = TASK.state.replace({("goal", "position"): (0.1 + distance, 0.0, 0.0)})
    place, yaw = push_pose(state, HAMMER, BLOCK, USED["region"])
    return held(state, place, attitude(yaw, 0.0), grasps)


def ready_to_strike(grasps: FloatArray) -> State:
    """Return states with a raised hammer that would hit the middle of the block's top if the hammer were level."""
    lever = HAMMER["impact_point"][0] + grasps
    hand = top(TASK.state, BLOCK) + np.stack([-lever, 0 * grasps, np.full_like(grasps, 0.045)], axis=-1)
    orientation = attitude(0.0, RAISED)
    return held(TASK.state, hand - rotate(orientation, on_handle(HAMMER, grasps)), orientation, grasps)


def rolled(block: Block, binding: Binding, start: State, **chosen: float | FloatArray) -> dict[str, FloatArray]:
    """Roll out a block to its exit, and return the values of its measures without code of the mid-level planner."""
    count = len(start.values)
    given = block.initial_values(binding, start) | chosen
    hyperparameters = {name: np.broadcast_to(value, count) for name, value in given.items()}
    policy, system = block.policy(binding, start, Parameters(hyperparameters)), block.system(binding, start)
    state, pending = start, np.ones(count, dtype=bool)
    figures = {m.name: np.zeros(count) for m in block.performance}
    for step in range(round(block.duration.maximum / CONTROL_PERIOD)):
        commands = policy(np.float64(step * CONTROL_PERIOD), state)
        for measure in block.performance:
            if measure.rate is not None:
                figures[measure.name] += np.where(pending, measure.rate(binding, state, commands) * CONTROL_PERIOD, 0)
        state = system(state, commands, CONTROL_PERIOD)
        for measure in block.performance:
            if measure.peak is not None:
                now = np.maximum(figures[measure.name], measure.peak(binding, state))
                figures[measure.name] = np.where(pending, now, figures[measure.name])
        margins = [literal.margin(state, binding) for literal in block.exit if ANY not in literal.arguments]
        pending &= ~((np.min(margins, axis=0) >= 0) & (step * CONTROL_PERIOD > block.duration.minimum))
        # If a grasp does not strike the block, the rollout never reaches its exit.
        if not pending.any() or step * CONTROL_PERIOD > SECONDS[block.name]:
            break
    return figures | {m.name: m.end(binding, start, state, hyperparameters) for m in block.performance if m.end}


def value(block: Block, figures: dict[str, FloatArray]) -> FloatArray:
    terms = [m.weight * figures[m.name] / m.scale for m in block.performance]
    return np.asarray(np.sum(terms, axis=0))


PUSHING, STRIKING, GRASPING = (DOMAIN.block_by_name[name] for name in ("PUSHING", "STRIKING", "GRASPING"))


@pytest.fixture(scope="module")
def struck() -> dict[str, FloatArray]:
    return rolled(STRIKING, USED, ready_to_strike(GRASPS))


@pytest.fixture(scope="module")
def touched() -> FloatArray:
    """Return the contact of each grasp by the closed form for the paper's 'linear in the amount of contact'."""
    return (np.minimum(GRASPS + 0.03, 0.15) - np.maximum(GRASPS - 0.03, 0.0)) / 0.06


def test_the_tip_is_as_fast_as_the_work_of_the_torque_makes_it(struck: dict[str, FloatArray]) -> None:
    """sqrt(2 tau phi / (I_c + m g^2 + I_w)) (g + .025), if the butt of the handle does not hit the block."""
    rate = np.sqrt(2.0 * 4.0 * np.pi / 2 / (0.00199 + 0.6 * GRASPS**2 + 0.002))
    free = GRASPS >= 0.04
    # No feedback controls the speed, so the rest of the wind-up remains: at most 0.3 %.
    assert np.allclose(np.sqrt(struck["tip_speed_squared"])[free], (rate * (GRASPS + 0.025))[free], rtol=3e-3)


def test_a_hammer_held_near_its_head_cannot_strike_because_its_butt_is_in_the_way(
    struck: dict[str, FloatArray],
) -> None:
    assert np.all(struck["tip_speed_squared"][(GRASPS > 0.004) & (GRASPS < 0.03)] < 0.1)


def test_a_hand_that_swings_about_an_elbow_is_slower_at_the_tip_and_moves_itself() -> None:
    grasps, radius = np.full(3, 0.08), np.array([0.05, 0.1, 0.3])
    found = rolled(STRIKING, USED, ready_to_strike(grasps), swing_radius=radius)
    rate = np.sqrt(2.0 * 4.0 * np.pi / 2 / (0.00399 + 0.6 * (0.08 + radius) ** 2 + 1.5 * radius**2))
    assert np.allclose(np.sqrt(found["tip_speed_squared"]), rate * (0.105 + radius), rtol=5e-3)
    assert np.allclose(found["hand_speed"], rate * radius, rtol=0.05)


@pytest.mark.parametrize(("wrist", "torque"), [(10.0, 4.0), (0.5, 0.05), (0.09, 0.05)])
def test_no_strike_exceeds_the_bound_of_able_to_strike(wrist: float, torque: float) -> None:
    """Strikes about an elbow have larger impulses than strikes in which the hand only turns."""
    hand = Token.make("hand", list(HAND.classes), {**HAND.properties, "maximal_torque": wrist, "strike_torque": torque})
    held_at, radius = np.linspace(-0.15, 0.0, 301)[:, None], np.linspace(0.0, LARGEST_RADIUS, 301)
    swing = swing_of(hand, HAMMER, held_at, radius)
    borne = np.broadcast_to(swing.weight_torque <= wrist, swing.impulse.shape)
    bound, most = largest_impulse(hand, HAMMER), swing.impulse[borne].max()
    assert 1.06 * most <= bound <= 1.13 * most
    assert bound > 1.2 * swing.impulse[:, 0][borne[:, 0]].max()


@pytest.mark.parametrize("grip", [11.0, 13.0, 20.0, 60.0])
def test_no_strike_that_a_grip_bears_exceeds_the_bound_of_firm_enough(grip: float) -> None:
    """The grip bears the centrifugal force by friction, and the tool's share of the torque by the pads' pressure."""
    hand = Token.make("hand", list(HAND.classes), {**HAND.properties, "maximal_grip": grip})
    grasp, radius = np.linspace(0.0, 0.15, 301)[:, None], np.linspace(0.0, LARGEST_RADIUS, 301)
    swing = swing_of(hand, HAMMER, -grasp, radius)
    pull = 0.6 * swing.rate**2 * (radius + grasp)
    moment = 4.0 / swing.inertia * (0.00199 + 0.6 * (radius + grasp) * grasp) - 0.6 * 9.81 * grasp
    held = (pull <= grip) & (moment <= 0.06 * grip)
    most = np.max(swing.impulse[held], initial=0.0)
    bound = largest_impulse(hand, HAMMER, gripped=True)
    assert most <= bound <= largest_impulse(hand, HAMMER)
    assert bound <= 1.2 * most or not held.any()


def test_a_strike_about_an_elbow_is_stronger_than_able_to_strike_allowed_for_grasps_alone() -> None:
    """With a strike torque of 0.05 N m, no grasp alone gives 0.4 N s, but a swing about an elbow does."""
    hand = Token.make("hand", list(HAND.classes), {**HAND.properties, "maximal_torque": 0.09, "strike_torque": 0.05})
    block = Token.make("block", list(BLOCK.classes), {**BLOCK.properties, "impulse_needed": 0.4}, BLOCK.shape)
    used = {**USED, "hand": hand, "object": block}
    facts = dict(zip(("hand", "tool", "object"), (hand, HAMMER, block), strict=True))
    assert ABLE_TO_STRIKE.evaluate(TASK.state, *facts.values()) >= 0
    start = ready_to_strike(np.array([0.01]))
    chosen = STRIKING.initial_values(used, start) | {"swing_radius": np.array([0.047])}
    policy, system = STRIKING.policy(used, start, Parameters(chosen)), STRIKING.system(used, start)
    state = start
    for step in range(900):
        state = system(state, policy(np.float64(step * CONTROL_PERIOD), state), CONTROL_PERIOD)
    assert float(state[block, "impulse"].max()) > 0.4


def test_the_target_point_does_not_matter_for_the_measures() -> None:
    grasps = np.full(3, 0.1)
    beside = np.array([0.0, -0.03, 0.02])
    found = rolled(STRIKING, USED, ready_to_strike(grasps), target_x=beside / 2, target_y=beside)
    # Only the rest of the wind-up differs, as no feedback controls the speed.
    assert np.ptp(np.sqrt(found["tip_speed_squared"])) < 0.01


def test_the_torque_of_a_push_is_its_resistance_times_the_lever() -> None:
    found = rolled(PUSHING, USED, ready_to_push(GRASPS, 0.3))
    assert np.allclose(found["torque_work"], (FORCE * (GRASPS + 0.025)) ** 2 * 0.3, rtol=0.02)


def test_contact_is_the_share_of_the_hand_that_is_on_the_handle(touched: FloatArray) -> None:
    grasps = np.array([0.0, 0.015, 0.03, 0.1, 0.12, 0.135, 0.15])
    upright = attitude(0.0, 0.0)
    start = held(TASK.state, TASK.state[HAMMER, "position"], upright, grasps)
    found = GRASPING.performance[0].end(USED, start, start, {})
    assert np.allclose(found, [0.5, 0.75, 1.0, 1.0, 1.0, 0.75, 0.5])


@pytest.mark.parametrize(
    ("final", "push", "both"), [(0.2, 0.03, 0.116), (0.5, 0.029, 0.07), (0.6, 0.018, 0.062), (1.0, 0.0, 0.04)]
)
def test_the_best_grasps_are_those_of_the_closed_form(
    final: float, push: float, both: float, struck: dict[str, FloatArray], touched: FloatArray
) -> None:
    """J = contact - 4 torque^2 d + .2 v_tip^2 - .1 v_hand, as in the paper's Fig. 6."""
    pushed = touched + value(PUSHING, rolled(PUSHING, USED, ready_to_push(GRASPS, final - 0.1)))
    hit = value(STRIKING, struck)
    assert GRASPS[np.argmax(pushed)] == pytest.approx(push, abs=0.005)
    assert GRASPS[np.argmax(touched + hit)] == pytest.approx(0.12, abs=0.005)
    assert GRASPS[np.argmax(pushed + hit)] == pytest.approx(both, abs=0.005)


@pytest.mark.parametrize(("block", "ready"), [(PUSHING, lambda g: ready_to_push(g, 0.2)), (STRIKING, ready_to_strike)])
def test_a_batch_gives_what_its_members_give(block: Block, ready: Callable[[FloatArray], State]) -> None:
    grasps = np.array([0.05, 0.11])
    together = rolled(block, USED, ready(grasps))
    for index in range(len(grasps)):
        alone = rolled(block, USED, ready(grasps[index : index + 1]))
        for name, figures in together.items():
            assert figures[index] == pytest.approx(alone[name][0], rel=1e-6, abs=1e-9)


def test_symbols_and_forward_models_agree() -> None:
    assert check_domain(load_task(find_task_file("hammer_push_then_strike")), samples=1) == []


@pytest.mark.parametrize("name", PROBLEMS)
def test_problems_are_solved_by_lawful_plans_that_val_accepts(name: str, tmp_path: Path) -> None:
    task = load_task(find_task_file(name))
    plan = hybrid_tamp.plan(task).required()
    assert not check_law(task, plan)
    uses = [USES[word] for word in name.split("_") if word in USES]
    blocks = [instance.block for instance in plan.instances if instance.block != "RESTING"]
    assert blocks == ["REACHING:handle", "GRASPING", *chain(*uses), "CARRYING:down", "RELEASING"]
    assert val_accepts(tmp_path, compile_task(task).problem, plan.actions)


def with_hammer(task: Task, **properties: object) -> Task:
    """Return the task with changed properties of the hammer."""
    other = Token.make("hammer", HAMMER.classes, HAMMER.properties | properties, HAMMER.shape)
    return task.replaced(tokens=tuple(other if token.name == "hammer" else token for token in task.tokens))


@pytest.mark.parametrize(
    ("properties", "fact"),
    [
        ({"mass": 40.0}, "liftable"),
        ({"handle_width": 0.07}, "wide_enough"),
    ],
)
def test_what_a_hand_cannot_hold_has_no_plan(properties: dict[str, float], fact: str) -> None:
    outcome = hybrid_tamp.plan(with_hammer(TASK, **properties))
    assert outcome.plan is None
    (predicate,) = (each for each in TASK.domain.predicates if each.name == fact)
    assert predicate.sentence(("hand", "hammer"), positive=False) in str(outcome.error)


def test_a_tool_that_strikes_is_chosen_among_others() -> None:
    """A stick with the same handle is nearer, but is not a STRIKER."""
    stick = Token.make(
        "stick",
        [Graspable],
        {key: value for key, value in HAMMER.properties.items() if not key.endswith("_point")},
        hammer_shape(),
    )
    tokens = (stick, *TASK.tokens)
    given = {(token, name): TASK.state[token, name] for token, name, _ in TASK.state.layout.entries}
    given |= {
        ("stick", "position"): (-0.3, -0.15, HAMMER.properties["impact_point"][0] + 0.015),
        ("stick", "orientation"): TASK.state["hammer", "orientation"],
    }
    task = TASK.replaced(tokens=tokens, state=State.of(tokens, given), goal=(Atom("struck", ("block",)),))
    plan = hybrid_tamp.plan(task).required()
    assert not check_law(task, plan)
    assert {i.slots["tool"] for i in plan.instances if "tool" in i.slots} == {"hammer"}
    assert HAMMER.is_member(Striker)


def test_random_tasks_are_the_same_for_the_same_seed() -> None:
    one, other = random_hammer(5), random_hammer(5)
    assert np.array_equal(one.state.values, other.state.values)
    assert one.token_by_name["block"].properties == other.token_by_name["block"].properties
