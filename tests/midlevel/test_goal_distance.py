"""The distance between the final state and the goal as the objective of the mid-level planner (paper, Sec. II-D)."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import hybrid_tamp
from hybrid_tamp.errors import DomainError
from hybrid_tamp.model.goal_distance import measure_goal_distance
from hybrid_tamp.model.refined import GOAL
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task

PUSH = Path(__file__).parents[2] / "problems" / "hammer_push.yaml"


def moved(task: Task, offset: float) -> State:
    """Return a batch of two states: the initial state, and the block beside the centre of its region."""
    values = np.stack([task.state.values, task.state.values])
    state = State(task.state.layout, values)
    centre = task.state["goal", "position"] + [offset, 0.0, task.state["block", "position"][2]]
    state["block", "position"][1] = centre
    return state


def test_the_distance_of_a_region_is_the_distance_of_its_centre() -> None:
    task = hybrid_tamp.load_task(PUSH)
    scale = task.domain.predicate_by_name["inside"].scale
    start = np.linalg.norm((task.state["block", "position"] - task.state["goal", "position"])[:2])
    assert measure_goal_distance(task, moved(task, 0.003)) * scale == pytest.approx([start, 0.003], abs=1e-12)


def test_without_a_declared_distance_an_atom_that_holds_is_at_the_goal() -> None:
    task = hybrid_tamp.load_task(PUSH.with_name("hammer_strike.yaml"))
    needed = task.token_by_name["block"]["impulse_needed"]
    values = np.stack([task.state.values] * 2)
    state = State(task.state.layout, values)
    state["block", "impulse"][1] = 2.0 * needed
    scale = task.domain.predicate_by_name["struck"].scale
    assert measure_goal_distance(task, state) == pytest.approx([needed / scale, 0.0])


def test_a_distance_of_the_wrong_shape_is_refused_by_name() -> None:
    task = hybrid_tamp.load_task(PUSH)
    inside = task.domain.predicate_by_name["inside"]
    wrong: Any = replace(inside, distance=lambda state, thing, region: np.linalg.norm(state[thing, "position"]))
    predicates = tuple(wrong if each is inside else each for each in task.domain.predicates)
    domain = replace(task.domain)
    object.__setattr__(domain, "predicate_by_name", {each.name: each for each in predicates})
    with pytest.raises(DomainError, match="the distance of inside"):
        measure_goal_distance(replace(task, domain=domain), moved(task, 0.0))


def distance_of_plan(objective: str, folder: Path) -> float:
    """Return the distance of the block from its region's centre [m] at the end of an optimised plan."""
    text = PUSH.read_text(encoding="utf-8")
    free = "PUSHING.beyond: {lower: -0.02, upper: 0.02, default: 0.02}"
    assert "PUSHING.beyond: 0\n" in text
    text = text.replace("PUSHING.beyond: 0\n", f"{free}\n  evaluations: 200\n  objective: {objective}\n")
    path = folder / f"{objective}.yaml"
    path.write_text(text, encoding="utf-8")
    refined = hybrid_tamp.plan(path, optimise=True).refinement
    assert refined is not None
    assert refined.best.violation == 0.0
    (goal,) = [atom for atom in hybrid_tamp.load_task(path).goal if atom.predicate == "inside"]
    return 0.03 - refined.expected[GOAL, goal]


def test_a_plan_ends_nearer_to_the_centre_if_the_distance_is_the_objective(tmp_path: Path) -> None:
    assert distance_of_plan("distance", tmp_path) < 0.001
    assert distance_of_plan("performance", tmp_path) > 0.005
