"""For authors of domains: does a domain's symbolic face agree with its continuous one?"""

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

_WALKS = 4  # At most, for each sample.
_LONGEST_HOLD = 30.0  # [s]
_STEPS_A_BLOCK = 4  # How long a walk is, in steps a block of the domain.


@dataclass(frozen=True)
class Disagreement:
    """An exit condition that a block declares, but that does not hold after its forward model has run."""

    block: str
    binding: tuple[tuple[str, str], ...]
    literal: str
    margin: float

    def __str__(self) -> str:
        if not self.binding:
            return f"{self.block}: {self.literal}"
        bound = ", ".join(f"{role}={name}" for role, name in self.binding)
        return f"{self.block}({bound}): {self.literal} ends with margin {self.margin:.4g}"


def check_domain(task: Task, *, samples: int = 8, seed: int = 0, dt: float = 1 / 240) -> list[Disagreement]:
    """Roll every block out from states that the domain itself brings about; compare the ends with what it declares.

    Each walk begins in the task's initial state, with hands displaced at random, and goes on with a block whose
    entry conditions hold there, one that never has been first: what one brings about is where the next can
    begin, so a box is tipped before it is lowered.

    Args:
        task: a task of the domain, with tokens for every block that is to be checked.
        samples: how often each block is rolled out at least, if it can be.
        seed: seed of displacements and choices.
        dt: time step of the roll-out [s].

    Returns:
        Every declared exit condition that did not hold at the end of its block's longest duration, and every block
        that has tokens for its slots and that no walk could enter.
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
    never = "its entry conditions held in no state that the other blocks bring about"
    return found + [Disagreement(name, (), never, math.nan) for name, times in done.items() if not times]


def _displaced(task: Task, rng: np.random.Generator) -> State:
    """Return the initial state with hands displaced a little; other tokens stay, so that the task's facts hold."""
    moves = {
        (token.name, "position"): task.state[token, "position"] + rng.uniform(-0.05, 0.05, 3)
        for token in task.tokens
        if token.basic_actions
    }
    return task.state.replace(moves)


def _next(
    task: Task, blocks: list[Block], state: State, done: Counter[str], rng: np.random.Generator, samples: int
) -> tuple[Block, Binding] | None:
    """Return a block that can begin in the state, preferably one that never began; None if all began often enough."""
    if min(done.values()) >= samples:
        return None
    # Of those that have been rolled out, any: the way to some states leads through blocks that are rolled out often.
    for block in sorted(blocks, key=lambda block: (done[block.name] > 0, rng.random())):
        possible = list(enumerate_bindings(task.choices(block), block.entry, partial(_holds, task, state)))
        if possible:
            return block, possible[int(rng.integers(len(possible)))]
    return None


def _holds(task: Task, state: State, condition: Literal, binding: Binding) -> bool:
    # Feasibility was decided in the initial state.
    return float(condition.margin(task.state if condition.predicate.static else state, binding)) >= 0


def _disagreements(block: Block, binding: Binding, end: State) -> list[Disagreement]:
    names = tuple(sorted((role, v if isinstance(v, str) else v.name) for role, v in binding.items()))
    return [
        Disagreement(block.name, names, str(literal), float(literal.margin(end, binding)))
        for literal in block.exit
        if ANY not in literal.arguments and literal.margin(end, binding) < 0
    ]
