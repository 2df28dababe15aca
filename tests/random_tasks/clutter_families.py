"""Tasks of all families of scenes with obstacles, before the obstacles are added."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.skills import Region, TurningEndEffector
from random_tasks.arranging import Arrangement
from random_tasks.hammer import random_hammer
from random_tasks.lifting import random_lifting
from random_tasks.rolling import random_rolling
from random_tasks.tumbling import random_tumbling

_EVALUATIONS = 100
"""Largest number of rollouts in the optimisation of a task with a hammer."""
_WRIST = {"maximal_torque": 5.0, "wrist_inertia": 0.02}


def _tumbling(seed: int, hands: int) -> Task:
    """Return a task of tumbling whose hands can turn."""
    task = random_tumbling(seed, hands)
    tokens = [
        Token.make(token.name, [TurningEndEffector], {**token.properties, **_WRIST}) if token.basic_actions else token
        for token in task.tokens
    ]
    return Arrangement.of(task, tokens).task(task, task.name)


def _carrying(seed: int, hands: int) -> Task:
    """Return a task in which hands carry a box to a region, U(0.3, 1.0) m away in any direction."""
    task, rng = random_lifting(seed, hands), np.random.default_rng([seed, 7])
    distance, way = rng.uniform(0.3, 1.0), rng.uniform(-np.pi, np.pi)
    scene = Arrangement.of(task)
    scene.add(Token.make("goal", [Region], {"radius": 0.05}), distance * np.array([np.cos(way), np.sin(way), 0.0]))
    goal = (Atom("inside", ("box", "goal")), Atom("stands", ("box",)))
    return scene.task(task, f"carry_{seed}").replaced(goal=goal)


def _hammer(seed: int) -> Task:
    """Return a task with a hammer, with few evaluations, because each of them takes long."""
    task = random_hammer(seed)
    return task.replaced(midlevel=replace(task.midlevel, evaluations=_EVALUATIONS))


FAMILIES: dict[str, Callable[[int], Task]] = {
    "roll": random_rolling,
    "tumble_two": partial(_tumbling, hands=2),
    "tumble_four": partial(_tumbling, hands=4),
    "carry_two": partial(_carrying, hands=2),
    "carry_four": partial(_carrying, hands=4),
    "hammer": _hammer,
}
"""Maps each family to a function that returns the task of a seed without obstacles."""
