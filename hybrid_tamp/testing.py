"""For authors of domains: does a domain's symbolic face agree with its continuous one?"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from hybrid_tamp.model.block import Binding, Block
from hybrid_tamp.model.predicate import ANY
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task


@dataclass(frozen=True)
class Disagreement:
    """An exit condition that a block declares and its own forward model does not bring about."""

    block: str
    binding: tuple[tuple[str, str], ...]
    literal: str
    margin: float

    def __str__(self) -> str:
        bound = ", ".join(f"{role}={name}" for role, name in self.binding)
        return f"{self.block}({bound}): {self.literal} ends with margin {self.margin:.4g}"


def check_domain(task: Task, *, samples: int = 8, seed: int = 0, dt: float = 1 / 240) -> list[Disagreement]:
    """Roll every block out from entry states near the task's and compare classifiers with declared effects.

    Entry states are the task's initial state with the moved tokens displaced at random; where a block has entry
    conditions that only another block's end satisfies (e.g. a hand that stands by), that end is made first by
    rolling the other block out.

    Args:
        task: a task of the domain, with at least one binding for every block.
        samples: entry states a block.
        seed: seed of the displacements.
        dt: time step of the roll-out [s].

    Returns:
        Every declared exit condition that did not hold at the end of its block's longest duration.
    """
    rng = np.random.default_rng(seed)
    found = []
    for block in task.domain.blocks:
        for binding in task.bindings(block):
            for start in _entry_states(task, block, binding, rng, samples, dt):
                found.extend(_disagreements(block, binding, _roll_out(block, binding, start, dt)))
    return found


def _displaced(task: Task, rng: np.random.Generator) -> State:
    """Return the initial state with hands moved a little; other tokens stay where the task's facts hold."""
    moves = {
        (token.name, "position"): task.state[token, "position"] + rng.uniform(-0.05, 0.05, 3)
        for token in task.tokens
        if token.basic_actions
    }
    return task.state.replace(moves)


def _entry_states(
    task: Task, block: Block, binding: Binding, rng: np.random.Generator, samples: int, dt: float
) -> Iterator[State]:
    for _ in range(samples):
        state = _displaced(task, rng)
        for condition in block.entry:
            if condition.margin(state, binding) < 0 and condition.predicate.maintained:
                state = _brought_about(task, block, binding, state, dt)
        if all(condition.margin(state, binding) >= 0 for condition in block.entry):
            yield state


def _brought_about(task: Task, block: Block, binding: Binding, state: State, dt: float) -> State:
    """Roll out the blocks that maintain what this one's entry needs, on the same tokens."""
    for other in task.domain.blocks:
        for kept in other.exit:
            for wanted in block.entry:
                if kept.predicate.maintained and wanted.predicate is kept.predicate:
                    roles = dict(zip(kept.arguments, wanted.arguments, strict=True))
                    if set(roles) == set(other.roles):
                        before = {role: binding[same] for role, same in roles.items()}
                        state = _roll_out(other, before, state, dt)
    return state


def _roll_out(block: Block, binding: Binding, start: State, dt: float) -> State:
    """Run a block's own forward model until its exit conditions hold, at most for its longest duration."""
    hyperparameters = block.guesses(binding, start)
    policy = block.policy(binding, start, hyperparameters) if block.policy else None
    longest = block.duration.maximum if not block.hold else min(block.duration.maximum, 30.0)
    state = start
    for step in range(round(longest / dt)):
        elapsed = step * dt
        if elapsed >= block.duration.minimum and not _disagreements(block, binding, state):
            break
        commands = policy(np.asarray(elapsed), state) if policy else {}
        state = block.system(binding, state, commands, dt)
    return state


def _disagreements(block: Block, binding: Binding, end: State) -> list[Disagreement]:
    names = tuple(sorted((role, v if isinstance(v, str) else v.name) for role, v in binding.items()))
    return [
        Disagreement(block.name, names, str(literal), float(literal.margin(end, binding)))
        for literal in block.exit
        if ANY not in literal.arguments and literal.margin(end, binding) < 0
    ]
