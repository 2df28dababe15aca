"""Checks for authors of domains: the forward model of a block must fulfil the block's declared exit conditions."""

import math
from collections import Counter
from dataclasses import dataclass
from functools import partial

import numpy as np

from hybrid_tamp.model.bindings import enumerate_bindings
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.forward_model import roll_out
from hybrid_tamp.model.predicate import ANY, Binding, Literal
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task

_WALKS = 4  # Maximum number of random walks for each of the `samples`.
_LONGEST_HOLD = 30.0  # Longest rollout of a block that can continue after its exit conditions hold [s].
_STEPS_A_BLOCK = 4  # Maximum number of steps of a random walk for each block.


@dataclass(frozen=True)
class Disagreement:
    """An exit condition that is declared for a block but does not hold at the end of a rollout of the block."""

    block: str
    binding: tuple[tuple[str, str], ...]
    literal: str
    margin: float

    def __str__(self) -> str:
        if not self.binding:
            return f"{self.block}: {self.literal}"
        bound = ", ".join(f"{role}={name}" for role, name in self.binding)
        return f"{self.block}({bound}): {self.literal} has margin {self.margin:.4g} at the end of the rollout"


def check_domain(task: Task, *, samples: int = 8, seed: int = 0, dt: float = 1 / 240) -> list[Disagreement]:
    """Roll out every block from reachable states and check the block's declared exit conditions at the end.

    Each random walk starts in the initial state of the task, but with slightly displaced hands. Each step of a walk
    rolls out a block whose entry conditions hold, preferably a block that was not rolled out before. The next step
    starts in the final state of this rollout. A walk can thus tip a box and then lower the box.

    Args:
        task: a task of the domain. A block is checked only if the task has tokens for its slots.
        samples: minimum number of rollouts of each block, if the entry conditions of the block hold often enough.
        seed: seed of the random walks.
        dt: time step of the rollouts [s].

    Returns:
        An entry for each exit condition that did not hold after a rollout of the block's longest duration, and an entry
        for each checked block that no walk could enter.
    """
    rng = np.random.default_rng(seed)
    blocks = [block for block in task.domain.blocks if all(map(task.values_of, block.roles.values()))]
    done = Counter({block.name: 0 for block in blocks})
    found: list[Disagreement] = []
    for _ in range(_WALKS * samples):
        state = _displaced(task, rng)
        for _ in range(_STEPS_A_BLOCK * len(blocks)):
            chosen = _next(task, blocks, state, done, rng, samples)
            if chosen is None:
                break
            block, binding = chosen
            done[block.name] += 1
            longest = min(block.duration.maximum, _LONGEST_HOLD) if block.hold else block.duration.maximum
            state = roll_out(block, binding, state, longest, dt)[-1]
            found.extend(_disagreements(block, binding, state))
    never = "its entry conditions did not hold in any state that was reached"
    return found + [Disagreement(name, (), never, math.nan) for name, times in done.items() if not times]


def _displaced(task: Task, rng: np.random.Generator) -> State:
    """Return the initial state with slightly displaced hands. Other tokens stay in place, so that the facts hold."""
    moves = {
        (token.name, "position"): task.state[token, "position"] + rng.uniform(-0.05, 0.05, 3)
        for token in task.tokens
        if token.basic_actions
    }
    return task.state.replace(moves)


def _next(
    task: Task, blocks: list[Block], state: State, done: Counter[str], rng: np.random.Generator, samples: int
) -> tuple[Block, Binding] | None:
    """Return a block and a binding that fulfils the block's entry conditions in the state.

    Blocks that were not rolled out before are preferred. Return None if no block can be entered in the state, or if
    every block was rolled out at least `samples` times.
    """
    if min(done.values()) >= samples:
        return None
    # Choose at random among blocks that were rolled out before: only blocks that ran often lead to some states.
    for block in sorted(blocks, key=lambda block: (done[block.name] > 0, rng.random())):
        possible = list(enumerate_bindings(task.choices(block), block.entry, partial(_holds, task, state)))
        if possible:
            return block, possible[int(rng.integers(len(possible)))]
    return None


def _holds(task: Task, state: State, condition: Literal, binding: Binding) -> bool:
    # Static conditions are evaluated in the initial state.
    return float(condition.margin(task.state if condition.predicate.static else state, binding)) >= 0


def _disagreements(block: Block, binding: Binding, end: State) -> list[Disagreement]:
    names = tuple(sorted((role, v if isinstance(v, str) else v.name) for role, v in binding.items()))
    return [
        Disagreement(block.name, names, literal.text, float(literal.margin(end, binding)))
        for literal in block.exit
        if ANY not in literal.arguments and literal.margin(end, binding) < 0
    ]
