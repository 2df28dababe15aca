"""Random tasks with several things to move, to compare the number of planned actions with the fewest actions."""

from dataclasses import replace

import numpy as np
from hybrid_tamp_domains.rolling_tumbling import DOMAIN as ROLLING_TUMBLING
from numpy.typing import ArrayLike

from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.skills import Region
from random_tasks.lifting import random_lifting
from random_tasks.small_rolling import Given, place_drum, random_drum, roller
from random_tasks.small_tools import hammer_scene, turned
from random_tasks.tumbling import random_tumbling

_POSTURES = ("right", "left", "front")


def several_task(seed: int) -> Task:
    """Return a task with several blocks, drums or boxes, and one or more hands and tools. The seed gives the kind."""
    rng = np.random.default_rng(seed)
    kind = seed % 4
    if kind in (0, 2):
        return _blocks(seed, rng)
    if kind == 1:
        return _drums(seed, rng)
    return _boxes(seed, rng)


def _blocks(seed: int, rng: np.random.Generator) -> Task:
    """Return a task with two to four blocks, of which each must be pushed, struck or both, and one or two hammers."""
    yaw = float(rng.uniform(-np.pi, np.pi))
    names = [f"block {number + 1}" for number in range(int(rng.integers(2, 5)))]
    blocks = {each: (turned(yaw, (0.0, 0.5 * row)), yaw) for row, each in enumerate(names)}
    places = {f"goal {row + 1}": turned(yaw, (rng.uniform(0.2, 0.4), 0.5 * row)) for row, _ in enumerate(names)}
    goal: list[Atom] = []
    for row, each in enumerate(names):
        wanted = rng.choice(["push", "strike", "both"])
        goal += [Atom("inside", (each, f"goal {row + 1}"))] if wanted != "strike" else []
        goal += [Atom("struck", (each,))] if wanted != "push" else []
    rack = turned(yaw, (-rng.uniform(0.3, 0.4), rng.uniform(0.15, 0.25)))
    task = hammer_scene(
        f"several_{seed}", seed, blocks, places, [goal[i] for i in rng.permutation(len(goal))], rack=rack
    )
    return _second_hammer(task) if rng.random() < 0.3 else task


def _second_hammer(task: Task) -> Task:
    """Return the task with a second hammer, 0.3 m beside the first, and a second hand above it."""
    copies = {each: replace(task.token_by_name[each], name=f"second {each}") for each in ("hammer", "rack", "hand")}
    tokens = (*task.tokens, *copies.values())
    given: dict[tuple[str, str], ArrayLike] = {
        (token.name, varying.name): task.state[token.name, varying.name]
        for token in task.tokens
        for varying in token.varying
    }
    for each, copy in copies.items():
        for varying in copy.varying:
            given[copy.name, varying.name] = task.state[each, varying.name]
        given[copy.name, "position"] = task.state[each, "position"] - np.array([0.3, 0.0, 0.0])
    return task.replaced(tokens=tokens, state=State.of(tokens, given))


def _drums(seed: int, rng: np.random.Generator) -> Task:
    """Return a task in which one to three hands roll two to four drums."""
    given = Given()
    tokens: list[Token] = []
    goal: list[Atom] = []
    for row in range(int(rng.integers(2, 5))):
        drum = random_drum(rng, f"drum {row + 1}")
        place_drum(given, drum, np.array([0.0, 0.9 * row, 0.0]), 0.0)
        region = Token.make(f"goal {row + 1}", [Region], {"radius": 0.05})
        given[region.name, "position"] = (rng.uniform(0.3, 0.8), 0.9 * row, 0.0)
        tokens += [drum, region]
        goal.append(Atom("inside", (drum.name, region.name)))
    for number in range(int(rng.integers(1, 4))):
        hand = roller(f"hand {number + 1}", (-4.0, -4.0, 0.0), (4.0, 4.0, 1.2))
        given[hand.name, "position"] = (-rng.uniform(0.5, 0.8), 0.9 * number, rng.uniform(0.3, 0.5))
        tokens.append(hand)
    state = State.of(tokens, given)
    return Task(f"several_{seed}", ROLLING_TUMBLING, tuple(tokens), state, tuple(goal), seed=seed)


def _boxes(seed: int, rng: np.random.Generator) -> Task:
    """Return a task in which hands tumble one or two boxes, or lift a box."""
    kind = rng.integers(0, 4)
    if kind == 0:
        return random_lifting(seed, hands=int(rng.choice([2, 4])))
    hands, boxes = [(2, 1), (4, 1), (4, 2)][kind - 1]
    return random_tumbling(seed, hands, boxes, onto=str(rng.choice(_POSTURES))).replaced(objective="length")
