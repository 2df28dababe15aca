"""The view of an agent and the planner agree on random tasks: a block is afforded if and only if a plan exists."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from bank import problem
from random_tasks.lifting import random_lifting
from random_tasks.rolling import random_rolling
from random_tasks.tumbling import random_tumbling
from workshop import WORKSHOP, cut, workshop_task

from hybrid_tamp.model.affordance import CapabilityClass
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.network import ReassignmentNetwork
from hybrid_tamp.model.predicate import Atom, Parameter, Predicate
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.plan import plan_task
from hybrid_tamp.questions.affordances.perspectives import afforded_to, environment
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess


@pytest.fixture(scope="module")
def planner() -> Iterator[PlannerProcess]:
    with PlannerProcess() as process:
        yield process


def use(task: Task, block: Block, slot: str, thing: str) -> Task:
    """Return the task whose goal is a new effect of the block, which states that `thing` was in `slot`."""
    used = Predicate(
        "used",
        (Parameter("thing", block.slot(slot).object_class),),
        lambda state, value: np.full(state.values.shape[:-1], -1.0),
    )
    domain = task.domain.with_blocks([replace(block, exit=(*block.exit, used(slot)))], [used])
    return task.replaced(domain=domain, goal=(Atom("used", (thing,)),))


def disagreements(task: Task, planner: PlannerProcess) -> tuple[list[str], set[bool]]:
    """Return the disagreements between view and planner, and the answers of the view."""
    seen = {(each.object, each.block, each.slot) for each in afforded_to(task, *task.agents)}
    found, answers = [], set()
    for each in environment(task):
        key = (each.object, each.block, each.slot)
        planned = plan_task(use(task, task.domain.block_by_name[each.block], each.slot, each.object), planner)
        answers.add(key in seen)
        if planned.status != ("solved" if key in seen else "unsolvable"):
            found.append(f"{task.name}: {key} is {'' if key in seen else 'not '}afforded, but {planned.status}")
    return found, answers


def owned(task: Task, rng: np.random.Generator) -> Task:
    """Return the task in which one agent owns all hands, and the hands are displaced by up to 0.8 m."""
    hands = [token for token in task.tokens if any(issubclass(each, CapabilityClass) for each in token.classes)]
    moves = {
        (hand.name, "position"): task.state[hand, "position"] + np.array([*rng.uniform(-0.8, 0.8, 2), 0.0])
        for hand in hands
    }
    return task.replaced(agents={"robot": tuple(hand.name for hand in hands)}, state=task.state.replace(moves))


def random_workshop(seed: int) -> Task:
    """Return a task with random hands, parts and cutters, in a network without some of the edges."""
    rng = np.random.default_rng(seed)
    edges = [(".".join(one), ".".join(other)) for one, other in WORKSHOP.network.edges]
    kept = [edge for edge in edges if edge[1] == "RESTING.token" or rng.random() < 0.8]
    domain = replace(WORKSHOP, network=ReassignmentNetwork(kept), reduced=True)
    return workshop_task(
        (cut(),),
        hands=tuple(rng.choice([20.0, 50.0], rng.integers(1, 4))),
        parts=((60.0, 3.0), (30.0, float(rng.uniform(2.0, 6.0)))),
        edges=tuple(rng.uniform(1.0, 6.0, rng.integers(0, 3))),
        loads=(float(rng.uniform(20.0, 80.0)),),
        domain=domain,
    )


def test_views_and_planner_agree_in_the_workshop(planner: PlannerProcess) -> None:
    answers: set[bool] = set()
    for seed in range(6):
        found, given = disagreements(random_workshop(seed), planner)
        assert found == []
        answers |= given
    assert answers == {True, False}


@pytest.mark.parametrize("make", [random_tumbling, random_rolling, random_lifting])
def test_views_and_planner_agree_on_hands_that_start_anywhere(make: object, planner: PlannerProcess) -> None:
    assert callable(make)
    assert disagreements(owned(make(0), np.random.default_rng(0)), planner)[0] == []


def test_a_lying_hammer_affords_nothing() -> None:
    upright = "pose: {position: [-0.25, 0, 0.04], rpy: [0, 1.5707963267948966, 0]}"
    assert afforded_to(problem("hammer_strike"), "robot")
    assert afforded_to(problem("hammer_strike", (upright, "pose: {position: [-0.25, 0, 0.046]}")), "robot") == []


def test_two_hands_on_one_side_can_tip_a_box() -> None:
    task = random_tumbling(0).replaced(agents={"robot": ("hand 1", "hand 2")})
    assert {each.block for each in afforded_to(task, "robot")} >= {"TIPPING:lower", "TILTING"}
    moved = task.state.replace({("hand 2", "position"): np.array([-0.5, 0.3, 0.55])})
    assert "TIPPING:lower" in {each.block for each in afforded_to(task.replaced(state=moved), "robot")}
