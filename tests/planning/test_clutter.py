"""Scenes with obstacles: the planner and an oracle that shares no code with the planner agree."""

import numpy as np
import pytest
from random_tasks.clutter import MOST, add_clutter
from random_tasks.flood import find_obstruction
from random_tasks.rolling import random_rolling

import hybrid_tamp
from hybrid_tamp.geometry.shapes import Box
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token

SEED = 0
"""Seed of a task whose hand is beside the way of the drum."""


def with_walls(*walls: tuple[list[float], list[float]]) -> Task:
    """Return a task of `random_rolling` with walls, given as pairs of (position, half extents) relative to the drum."""
    task = random_rolling(SEED)
    tokens, given = list(task.tokens), {(t, n): task.state[t, n] for t, n, _ in task.state.layout.entries}
    for number, (place, halves) in enumerate(walls):
        half = (halves[0], halves[1], halves[2])
        wall = Token.make(f"wall-{number}", [], {}, Box(kind="box", half_extents=half), immovable=True)
        tokens.append(wall)
        given[wall.name, "position"] = np.array(place)
    return task.replaced(tokens=tuple(tokens), state=State.of(tokens, given))


def test_the_oracle_names_what_is_in_the_way() -> None:
    task = with_walls()
    hand, drum, goal = (task.state[name, "position"] for name in ("hand", "cylinder", "goal"))
    ahead = (goal - drum) * [1.0, 1.0, 0.0]
    ahead /= np.linalg.norm(ahead)
    middle = [*((drum + goal) / 2)[:2], 0.1]
    radius = task.token_by_name["cylinder"]["radius_of_rotation"]
    behind = [*(drum - (radius + 0.04) * ahead)[:2], 0.2]
    cage = [
        ([hand[0] + x, hand[1] + y, hand[2]], [0.01 + abs(y), 0.01 + abs(x), 2.0])
        for x, y in ((-0.1, 0.0), (0.1, 0.0), (0.0, -0.1), (0.0, 0.1))
    ]
    assert find_obstruction(task) == ""
    assert find_obstruction(with_walls((middle, [0.05, 0.05, 0.1]))) == "drum"
    assert find_obstruction(with_walls((behind, [0.02, 0.02, 0.2]))) == "hand behind the drum"
    roof = ([hand[0], hand[1], hand[2] + 2.0], [0.2, 0.2, 0.02])
    assert find_obstruction(with_walls(*cage, roof)) == "way of the hand"


@pytest.mark.parametrize("seed", [1, 4, 8])
def test_the_planner_agrees_with_the_oracle(seed: int) -> None:
    task = add_clutter(random_rolling(seed), seed)
    outcome = hybrid_tamp.plan(task, optimise=True, trials=0)
    assert (outcome.plan is None) == bool(find_obstruction(task))


def test_scenes_are_reproducible_and_their_bodies_are_apart() -> None:
    counts = set()
    for seed in range(9):
        task, again = (add_clutter(random_rolling(seed), seed) for _ in range(2))
        assert np.array_equal(task.state.values, again.state.values)
        counts.add(len(task.tokens) - len(random_rolling(seed).tokens))
    assert max(counts) <= MOST
    assert len(counts) > 3
