"""Random walks over blocks. Each step chooses a block and targets with few earlier steps."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from hybrid_tamp.model.bindings import enumerate_bindings
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.making_way import makes_way
from hybrid_tamp.model.predicate import Atom, Binding, Literal, Value, name_of
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task

Key = tuple[str, tuple[str, ...]]
"""Pair of (name of a block, names of the values of its targets)."""


@dataclass(frozen=True)
class Choice:
    """A block with certain targets, and all bindings with these targets whose conditions hold in a state.

    Attributes:
        block: the block.
        key: pair of (name of the block, names of the values of its targets).
        bindings: bindings that differ only in the tokens in the slots.
    """

    block: Block
    key: Key
    bindings: list[Binding]


class Chooser:
    """Chooses the steps of random walks, and counts the steps of each block and of each choice of targets."""

    def __init__(self, task: Task, blocks: Sequence[Block], samples: int, rng: np.random.Generator) -> None:
        self._task, self._samples, self._rng = task, samples, rng
        self._due = 0  # Number of steps that each block and each choice of targets should have after this walk.
        self.blocks = list(blocks)
        self._done: Counter[Key] = Counter()
        self._entered = Counter({block.name: 0 for block in self.blocks})

    def begin(self) -> None:
        """Begin another walk."""
        self._due = min(self._due + 1, self._samples)

    def drop(self, block: Block) -> None:
        """Never choose a block again."""
        if block in self.blocks:
            self.blocks.remove(block)
            del self._entered[block.name]

    def count(self, choice: Choice, steps: int = 1) -> bool:
        """Add steps to the counts. Return whether the same block and targets were already rolled out often enough."""
        self._entered[choice.block.name] += steps
        self._done[choice.key] += steps
        return self._done[choice.key] > self._due

    def enter(self, state: State) -> frozenset[tuple[str, bool]]:
        """Return pairs of (block, facts) for blocks that can be entered in an initial state.

        If `facts` is true, only the entry conditions on static predicates must hold.
        """
        every = ((block, facts) for block in self.blocks for facts in (False, True))
        holds = _Conditions(state, state)
        return frozenset((b.name, facts) for b, facts in every if any(self._bindings(b, holds, facts)))

    def choices(self, first: State, state: State) -> list[Choice]:
        """Return the blocks and targets that can be entered in a state. The walk started in the state `first`."""
        possible: dict[Key, Choice] = {}
        holds = _Conditions(first, state)
        for block in self.blocks:
            for binding in self._bindings(block, holds):
                key = block.name, tuple(name_of(binding[target.name]) for target in block.targets)
                possible.setdefault(key, Choice(block, key, [])).bindings.append(binding)
        return list(possible.values())

    def choose(self, first: State, state: State) -> Choice | None:
        """Return a block that can be entered in the state, with targets. Prefer the choice with the fewest steps.

        Return None if no block can be entered, or if all blocks and all possible targets had enough steps.
        """
        possible = self.choices(first, state)
        wanted = [choice for choice in possible if self._done[choice.key] < self._due]
        if wanted:
            return min(wanted, key=self._rank)
        if min(self._entered.values(), default=0) >= self._due:
            return None
        return self._repeat(possible, state)

    def _rank(self, choice: Choice) -> tuple[bool, bool, int, float]:
        """Return a key. The choice with the smallest key comes first.

        Blocks with which tokens give way come last, because the tokens then leave the places that other blocks need.
        """
        block = choice.block
        return makes_way(block), self._entered[block.name] > 0, self._done[choice.key], self._rng.random()

    def _bindings(self, block: Block, holds: "_Conditions", facts: bool = False) -> Iterator[dict[str, Value]]:
        """Yield the bindings whose entry conditions and invariants hold.

        If `facts` is true, only the entry conditions on static predicates must hold.
        """
        conditions = block.static_entry if facts else (*block.entry, *block.invariants)
        return enumerate_bindings(self._task.choices(block), conditions, holds)

    def _repeat(self, possible: list[Choice], state: State) -> Choice | None:
        """Return a random choice that repeats earlier steps, because only long walks lead to certain states.

        An exit condition of the choice must not hold yet, so that the step leads to another state.
        """
        possible = [choice for choice in possible if not makes_way(choice.block)]
        for index in self._rng.permutation(len(possible)):
            block, key, every = possible[index].block, possible[index].key, possible[index].bindings
            useful = [b for b in every if any(float(each.margin(state, b)) < 0 for each in block.measured_exits)]
            if useful:
                return Choice(block, key, useful)
        return None


class _Conditions:
    """Function that returns whether conditions hold in a state. Each margin is evaluated only once."""

    def __init__(self, first: State, state: State) -> None:
        """Store both states. Predicates with `at_start` are evaluated in the state `first` at the start of the walk."""
        self._first, self._state = first, state
        self._known: dict[Atom, float] = {}

    def __call__(self, condition: Literal, binding: Binding) -> bool:
        atom = condition.ground(binding)
        if atom not in self._known:
            where = self._first if condition.predicate.at_start else self._state
            self._known[atom] = float(condition.margin(where, binding))
        return self._known[atom] >= 0
