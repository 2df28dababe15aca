"""Tests of joint lifting with closed forms and forward models: loads, feasibility and slip."""

from functools import partial
from pathlib import Path

import numpy as np
import pytest
from hybrid_tamp_domains.joint_lifting.classes import Liftable
from hybrid_tamp_domains.joint_lifting.lifting import usual_height
from hybrid_tamp_domains.joint_lifting.load import RESERVE, bearable, largest_squeeze, load, squeeze_for
from hybrid_tamp_domains.joint_lifting.places import CREWS, SLOTS, SPOTS, Roles, corner_heights, place_at
from hybrid_tamp_domains.joint_lifting.predicates import (
    BEARS,
    FITS,
    OF_BOX,
    OF_HAND,
    UPRIGHT,
    WITHIN_REACH,
    room_above,
)
from pydantic import ValidationError
from random_tasks.lifting import random_lifting
from texts import load_task_text
from validation import val_accepts

import hybrid_tamp
from hybrid_tamp.authoring import DEFAULT_FRICTION
from hybrid_tamp.errors import InputError
from hybrid_tamp.geometry.shapes import Cylinder
from hybrid_tamp.model.control import CONTROL_PERIOD, Parameters
from hybrid_tamp.model.expectation import expect
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.poses import quaternion_from_rpy
from hybrid_tamp.physics import scene
from hybrid_tamp.physics.protocol import Backend, open_backend
from hybrid_tamp.skills import gaps_to_faces
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.reencode import reencode
from hybrid_tamp.taskfile.loader import load_task
from hybrid_tamp.testing import check_domain

PROBLEMS = Path(__file__).parents[2] / "problems"
NAMES = {"two": "lift_two_hands", "four": "lift_four_hands"}


def lifting(mode: str) -> Task:
    return load_task(PROBLEMS / f"{NAMES[mode]}.yaml")


def crate(task: Task) -> Token:
    return next(token for token in task.tokens if token.is_member(Liftable))


def roles_of(task: Task, mode: str) -> dict[str, str]:
    """Return a mapping from slots to tokens. Every slot contains the hand that starts nearest to its place."""

    def distance(place: str, hand: Token) -> float:
        return float(np.linalg.norm(place_at(task.state, hand, crate(task), place) - task.state[hand, "position"]))

    hands = [token for token in task.tokens if token.basic_actions]
    nearest = {
        slot: min(hands, key=partial(distance, place)).name
        for slot, place in zip(SLOTS, CREWS[f"{mode} hands"], strict=False)
    }
    return {"object": crate(task).name, **nearest}


def ready(task: Task, mode: str) -> State:
    """Return the state in which every hand is at its place beside the box."""
    roles = Roles.of(f"{mode} hands", task.bind(roles_of(task, mode)))
    places = {(h.name, "position"): place_at(task.state, h, roles.thing, place) for h, place in roles.hands}
    return task.state.replace(places)


def act(task: Task, action: str, mode: str, physics: Backend, state: State, **chosen: float) -> State:
    """Run a block until its exit conditions hold, but at most one second longer than its expected duration."""
    block = task.domain.block_by_name[f"{action}:{mode}"]
    binding = task.bind(roles_of(task, mode))
    physics.assign([BlockInstance(f"{action}-1", block.name, roles_of(task, mode), 0.0, 1.0)])
    hyperparameters = block.initial_values(binding, state) | {name: np.asarray(value) for name, value in chosen.items()}
    assert block.policy is not None
    policy = block.policy(binding, state, Parameters(hyperparameters))
    expected = expect(block, binding, state, hyperparameters).seconds
    for step in range(round((expected + 1.0) / CONTROL_PERIOD)):
        done = all(float(literal.margin(state, binding)) >= 0 for literal in block.exit)
        if done and step * CONTROL_PERIOD >= block.duration.minimum:
            assert step * CONTROL_PERIOD == pytest.approx(expected, abs=0.05)
            break
        state = physics.step(policy(np.asarray(step * CONTROL_PERIOD), state))
    return state


# -- what hands bear ------------------------------------------------------------------------------------------------


def test_a_hand_bears_as_much_as_its_force_and_friction_allow() -> None:
    """W^2 + (1.5 W / mu)^2 = F^2, mu the product of the frictions: 300 N and .4 bear 77.3 N."""
    task = lifting("four")
    hand, thing = task.tokens[0], crate(task)
    assert bearable(hand, thing, 1.5) == pytest.approx(300.0 / np.sqrt(1.0 + (1.5 / 0.4) ** 2))
    assert bearable(hand, thing, 1.0) == pytest.approx(300.0 / np.sqrt(1.0 + (1.0 / 0.4) ** 2))
    assert load(thing, "two hands") == pytest.approx(24 * 9.81 / 2)
    assert load(thing, "four hands") == pytest.approx(24 * 9.81 / 4)
    assert float(BEARS.evaluate(task.state, hand, thing, "two hands")) == pytest.approx(-40.42, abs=0.01)
    assert float(BEARS.evaluate(task.state, hand, thing, "four hands")) == pytest.approx(18.44, abs=0.01)


def test_what_is_just_borne_takes_all_the_force_of_the_hand() -> None:
    hand, thing = lifting("four").tokens[0], crate(lifting("four"))
    most = Token.make("box", [Liftable], {**thing.properties, "mass": 4.0 * bearable(hand, thing, RESERVE) / 9.81})
    assert squeeze_for(most, "four hands") == pytest.approx(largest_squeeze(hand, most, "four hands"))
    assert np.hypot(squeeze_for(most, "four hands"), load(most, "four hands")) == pytest.approx(hand["maximal_force"])


def test_without_friction_nothing_is_borne() -> None:
    hand, thing = lifting("two").tokens[0], crate(lifting("two"))
    smooth = Token.make("box", [Liftable], {**thing.properties, "friction": 0.0})
    assert bearable(hand, smooth, 1.0) == 0.0
    assert squeeze_for(smooth, "two hands") == np.inf


def test_hands_have_the_friction_that_physics_gives_them() -> None:
    assert {body.friction for body in scene.make_bodies(lifting("four")) if body.driven} == {DEFAULT_FRICTION}


# -- what is feasible -----------------------------------------------------------------------------------------------


def test_there_is_room_for_two_hands_side_by_side_on_wide_faces_only() -> None:
    task = lifting("four")
    narrow = Token.make("box", [Liftable], {**crate(task).properties, "half_extents": (0.2, 0.08, 0.15)})
    flat = Token.make("box", [Liftable], {**crate(task).properties, "half_extents": (0.2, 0.25, 0.03)})
    for place, (_, along) in SPOTS.items():
        room, less, least = (
            float(FITS.evaluate(task.state, task.tokens[0], box, place)) for box in (crate(task), narrow, flat)
        )
        # The hand needs 3 cm between the top and 1 cm above the middle. Half of 0.16 m minus 2 cm is less than 7 cm.
        assert room == pytest.approx(0.15 - 0.01 - 0.03)
        assert less == pytest.approx(0.08 - 0.02 - 0.07 if along else 0.16 - 0.07)
        assert least == pytest.approx(0.03 - 0.01 - 0.03)


def test_hands_may_start_on_one_side() -> None:
    task = lifting("four")
    ahead = {(name, "position"): (-0.5, y, 0.4) for name, y in (("a-right", -0.6), ("b-right", 0.6))}
    outcome = hybrid_tamp.plan(task.replaced(state=task.state.replace(ahead)), optimise=True)
    assert outcome.plan is not None
    places = {each.targets["place"] for each in outcome.plan.instances if each.block == "REACHING:place"}
    assert places == set(CREWS["four hands"])


def test_a_hand_that_leans_is_not_upright() -> None:
    task = lifting("two")
    hand = task.tokens[0]
    for lean, upright in ((0.0, True), (2.0, True), (4.0, False), (90.0, False)):
        leaning = quaternion_from_rpy(np.array([np.radians(lean), 0.0, 1.0]))
        state = task.state.replace({(hand.name, "orientation"): leaning})
        assert (float(UPRIGHT.evaluate(state, hand)) >= 0) == upright


def test_a_low_workspace_allows_a_low_lift() -> None:
    """Hands that can rise by only 0.12 m lift a box by 0.12 m, and hands that can rise by 0.1 m cannot lift it."""
    task = lifting("two")
    top = float(room_above(task.state, task.tokens[0], crate(task), "left"))
    for room, usual in ((0.5, 0.15), (0.12, 0.12), (0.1, None)):
        upper = (2.0, 2.0, 1.5 - top + room)
        hands = [
            Token.make(h.name, list(h.classes), {**h.properties, "workspace_upper": upper}) for h in task.tokens[:2]
        ]
        low = task.replaced(tokens=(*hands, crate(task)))
        able = float(WITHIN_REACH.evaluate(low.state, hands[0], crate(low), "left")) >= 0
        assert able == (usual is not None)
        if usual is not None:
            assert usual_height("two hands", low.bind(roles_of(low, "two")), low.state) == pytest.approx(usual)


def test_a_lifted_box_is_as_near_as_on_the_floor() -> None:
    task = lifting("two")
    box = crate(task)
    raised = task.state.replace({(box.name, "position"): task.state[box, "position"] + np.array([0.0, 0.0, 0.3])})
    on_floor, in_air = (WITHIN_REACH.evaluate(state, task.tokens[0], box, "left") for state in (task.state, raised))
    assert in_air == pytest.approx(on_floor)


def test_margins_take_a_whole_population_at_once() -> None:
    task = load_task(PROBLEMS / "carry_four_hands.yaml")
    for predicate in task.domain.predicates:
        values = [task.values_of(parameter.sort)[0] for parameter in predicate.parameters]
        margins = predicate.evaluate(task.state.repeated(3), *values)
        assert margins.shape == (3,), predicate
        assert np.allclose(margins, predicate.evaluate(task.state, *values)), predicate


def test_what_no_box_can_be_is_refused() -> None:
    properties = {"half_extents": (0.1, 0.1, 0.1), "mass": 1.0, "friction": 0.5}
    with pytest.raises(ValidationError, match="greater than 0"):
        Token.make("box", [Liftable], properties | {"half_extents": (0.1, 0.0, 0.1)})
    drum = Token.make("box", [Liftable], properties, Cylinder(kind="cylinder", radius=0.1, length=0.2))
    assert "box" in (Liftable.consistent(drum) or "")
    assert Liftable.consistent(Token.make("box", [Liftable], properties)) is None


@pytest.mark.parametrize(
    ("pose", "said"),
    [
        ("[0, 0, 0.3]", "0.18 to 0.18 m above the floor"),
        ("[0, 0, 0.15], rpy: [0, 1.5707963267948966, 0]", "0 to 0.3 m"),
    ],
)
def test_a_box_that_does_not_stand_on_its_bottom_face_is_refused(pose: str, said: str) -> None:
    text = (PROBLEMS / "lift_two_hands.yaml").read_text(encoding="utf-8")
    assert "[0, 0, 0.12]" in text
    with pytest.raises(InputError, match="LIFTABLE box must stand on its bottom face") as raised:
        load_task_text(text.replace("[0, 0, 0.12]", pose), "box")
    assert said in str(raised.value)


# -- blocks ---------------------------------------------------------------------------------------------------------


def test_symbols_and_forward_models_agree() -> None:
    """Two hands can lift this crate, and four hands too. With this seed, the walks reach all blocks of both modes."""
    text = (PROBLEMS / "lift_four_hands.yaml").read_text(encoding="utf-8")
    assert "mass: 24" in text
    assert not check_domain(load_task_text(text.replace("mass: 24", "mass: 12"), "crate"), samples=1, seed=9)


@pytest.mark.parametrize("mode", NAMES)
@pytest.mark.parametrize("backend", ["analytic", "pybullet"])
def test_a_box_is_lifted_held_and_set_down_again(mode: str, backend: str) -> None:
    task = lifting(mode)
    thing, binding = crate(task), task.bind(roles_of(task, mode))
    with open_backend(backend) as physics:
        state = physics.reset(task, ready(task, mode))
        for action, height in (("LIFTING", 0.148), ("HOLDING", 0.148), ("LOWERING", 0.0)):
            state = act(task, action, mode, physics, state)
            for literal in task.domain.block_by_name[f"{action}:{mode}"].exit:
                assert float(literal.margin(state, binding)) >= 0, f"{action}: {literal}"
            assert corner_heights(state, thing) == pytest.approx(np.full(4, height), abs=0.002)
            if action != "LOWERING":
                for gap in gaps_to_faces(Roles.of(f"{mode} hands", binding).contacts, thing, state):
                    assert abs(float(gap)) < 0.001


@pytest.mark.parametrize("backend", ["analytic", "pybullet"])
def test_hands_that_squeeze_too_little_slip_off(backend: str) -> None:
    """Only friction bears the box, so mu S must exceed each hand's share of the weight."""
    task = lifting("four")
    thing = crate(task)
    slipping = squeeze_for(thing, "four hands") / 1.5
    with open_backend(backend) as physics:
        for part, lifted in ((0.9, False), (1.2, True)):
            state = physics.reset(task, ready(task, "four"))
            state = act(task, "LIFTING", "four", physics, state, squeeze=part * slipping)
            assert (float(corner_heights(state, thing).min()) > 0.1) == lifted


def test_hands_that_let_go_let_the_box_fall() -> None:
    task = lifting("two")
    with open_backend("pybullet") as physics:
        state = act(task, "LIFTING", "two", physics, physics.reset(task, ready(task, "two")))
        assert float(corner_heights(state, crate(task)).min()) > 0.1
        for _ in range(120):
            state = physics.step({})
    assert float(corner_heights(state, crate(task)).max()) < 0.01


def test_a_batch_gives_what_its_members_give() -> None:
    task = lifting("four")
    block, binding = task.domain.block_by_name["LIFTING:four"], task.bind(roles_of(task, "four"))
    squeezes = np.array([30.0, 200.0])

    def rolled(state: State, squeeze: object) -> State:
        hyperparameters = block.initial_values(binding, state) | {"squeeze": np.asarray(squeeze)}
        assert block.policy is not None
        policy = block.policy(binding, state, Parameters(hyperparameters))
        system = block.system(binding, state)
        for step in range(480):
            state = system(state, policy(np.asarray(step * CONTROL_PERIOD), state), CONTROL_PERIOD)
        return state

    together = rolled(ready(task, "four").repeated(2), squeezes)
    for row, squeeze in zip(together.values, squeezes, strict=True):
        assert row == pytest.approx(rolled(ready(task, "four"), squeeze).values)


@pytest.mark.parametrize("mode", NAMES)
def test_problems_are_solved_by_lawful_plans_that_val_accepts(mode: str, tmp_path: Path) -> None:
    task = lifting(mode)
    plan = hybrid_tamp.plan(task).required()
    assert not check_law(task, plan)
    blocks = [instance.block for instance in plan.instances if instance.block != "RESTING"]
    assert blocks == ["REACHING:place"] * (len(task.tokens) - 1) + [f"LIFTING:{mode}", f"HOLDING:{mode}"]
    assert next(i.slots for i in plan.instances if i.block == f"LIFTING:{mode}") == roles_of(task, mode)
    # The plan was found with the blocks that the task needs, whose actions have other names.
    compilation = compile_task(task)
    assert val_accepts(tmp_path, compilation.problem, reencode(compilation, plan))


@pytest.mark.parametrize("make", [random_lifting, partial(random_lifting, hands=4)])
def test_random_tasks_are_feasible_and_those_for_four_hands_too_heavy_for_two(make: partial[Task]) -> None:
    for seed in range(20):
        task = make(seed)
        assert np.array_equal(task.state.values, make(seed).state.values)
        mode = "four" if len(task.tokens) == 5 else "two"
        roles = Roles.of(f"{mode} hands", task.bind(roles_of(task, mode)))
        for hand, place in roles.hands:
            for predicate in (*OF_HAND, *OF_BOX):
                every = {"hand": hand, "object": roles.thing, "place": place, "crew": roles.crew}
                values = [every[parameter.name] for parameter in predicate.parameters]
                assert float(predicate.evaluate(task.state, *values)) >= 0, predicate
            assert (float(BEARS.evaluate(task.state, hand, roles.thing, "two hands")) >= 0) == (mode == "two")
