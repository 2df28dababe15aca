"""The check of a domain. Random walks simulate one block after another, and compare the results with declarations."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from hybrid_tamp.model.bindings import enumerate_bindings
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.predicate import Atom, Binding, Literal, Value, name_of
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.testing.batches import check_batches
from hybrid_tamp.testing.disagreement import Disagreement, Disagreements, with_unit
from hybrid_tamp.testing.ends import check_ends
from hybrid_tamp.testing.facts import check_facts
from hybrid_tamp.testing.rollouts import Rollouts, draw_hyperparameters, roll_out_rows
from hybrid_tamp.testing.standing import StandingConditions
from hybrid_tamp.testing.starts import draw_start

_WALKS = 4  # Number of random walks, as a multiple of `samples`.
_STEPS = 100  # Maximum number of steps of a random walk.
_REPETITIONS = 20  # A random walk ends after this number of successive steps that repeat earlier steps.
_DRAWN = 3  # Number of rollouts with drawn hyperparameters for each rollout with initial values.
_INITIAL = 0.5  # Probability that the next step starts after the rollout with initial values.

_Key = tuple[str, tuple[str, ...]]


def check_domain(task: Task, *, samples: int = 8, seed: int = 0, dt: float = 1 / 240) -> list[Disagreement]:
    """Roll out (simulate) every block for every target from reachable states. Compare the results with declarations.

    Random walks start in the initial state of the task, with displaced and turned tokens. Each step of a walk rolls out
    a block whose entry conditions and invariants hold. The walk prefers the block and targets with the fewest rollouts.
    One rollout uses the initial values of the hyperparameters, and further rollouts use drawn values. The next step
    starts in the final state of one of these rollouts. A walk can thus tip a box and then lower the box.

    Args:
        task: a task of the domain. A block is checked only if the task has tokens for its slots.
        samples: minimum number of steps for each block, and for each choice of its targets, if the entry conditions
            hold often enough.
        seed: seed of the random walks.
        dt: time step of the rollouts [s].

    Returns:
        One entry for each kind of disagreement, block and declaration:

        - ``entry``: the entry conditions of a block did not hold in any state that was reached.
        - ``exit``: no rollout of a block towards certain targets reached the exit conditions.
        - ``keeps``: the block changed an atom of a predicate that the block declares in `Block.keeps`.
        - ``fixed``: the block changed an atom of a static predicate, although the predicate reads no varying property.
        - ``bound``: the margin of a static predicate exceeded its declared bound.
        - ``ends``: a final pose differs from the outcome, or the outcome depends on a role that `Block.ends` omits.
        - ``invariant``: an entry condition held throughout all rollouts, but is no invariant and not in `Block.waived`.
        - ``batch``: a function has one result for a state in a batch and another result for the same state alone.

    Raises:
        DomainError: a function of the domain raised an exception, or returned a result of the wrong shape.
    """
    check = _Check(task, samples, seed, dt)
    for _ in range(_WALKS * samples):
        check.walk()
    return check.report()


class _Check:
    """The counts and findings of a check in progress."""

    def __init__(self, task: Task, samples: int, seed: int, dt: float) -> None:
        self._task, self._samples, self._dt = task, samples, dt
        self._due = 0  # Number of steps that each block and each choice of targets should have after this walk.
        self._rng = np.random.default_rng(seed)
        self._blocks = [b for b in task.domain.blocks if any(enumerate_bindings(task.choices(b)))]
        self._done: Counter[_Key] = Counter()
        self._entered = Counter({block.name: 0 for block in self._blocks})
        self._failed: dict[_Key, Rollouts] = {}
        self._succeeded: set[_Key] = set()
        self._found = Disagreements()
        self._standing = StandingConditions(self._blocks)
        self._allowed = self._enter(task.state)

    def walk(self) -> None:
        """Roll out one block after another, until many successive steps have repeated earlier steps.

        A failed step is not counted if an earlier step of the walk used drawn hyperparameters. The planner would avoid
        this failure, because the planner chooses the hyperparameters of consecutive blocks together.
        """
        self._due = min(self._due + 1, self._samples)
        first = state = draw_start(self._task, self._rng, lambda drawn: self._enter(drawn) >= self._allowed)
        initial, repetitions = True, 0
        for _ in range(_STEPS):
            choice = self._choose(first, state)
            if choice is None or repetitions == _REPETITIONS:
                return
            repeated = self._count(choice)
            repetitions = repetitions + 1 if repeated else 0
            rolled = self._roll_out(choice, state, 0 if repeated else _DRAWN)
            if not rolled.rows:
                self._failed.setdefault(choice.key, rolled)
                self._count(choice, 0 if initial else -1)
                return
            self._succeeded.add(choice.key)
            self._standing.note(rolled)
            if not repeated:
                check_batches(rolled, self._found)
                check_facts(self._task, first, rolled, self._found, self._rng)
                check_ends(rolled, choice.bindings, self._found, self._rng)
            row = rolled.rows[0 if self._rng.random() < _INITIAL else -1]
            initial &= row == 0
            state = rolled.end(row)

    def report(self) -> list[Disagreement]:
        """Return the disagreements."""
        for block in self._blocks:
            if not any(key[0] == block.name for key in (*self._succeeded, *self._failed)):
                never = "the conditions did not hold in any state that was reached"
                self._found.add("entry", block, {}, "the entry conditions can hold", never)
        self._report_exits()
        self._standing.report(self._found)
        return self._found.all()

    def _count(self, choice: "_Choice", steps: int = 1) -> bool:
        """Add steps to the counts. Return whether the same block and targets were already rolled out often enough."""
        self._entered[choice.block.name] += steps
        self._done[choice.key] += steps
        return self._done[choice.key] > self._due

    def _roll_out(self, choice: "_Choice", state: State, drawn: int) -> Rollouts:
        block, binding = choice.block, choice.bindings[int(self._rng.integers(len(choice.bindings)))]
        count = drawn if block.hyperparameters else 0
        chosen = draw_hyperparameters(block, binding, state, count, self._rng)
        return roll_out_rows(block, binding, state, chosen, 1 + count, self._dt)

    def _report_exits(self) -> None:
        """Report the failed exit conditions of each block whose rollouts towards certain targets never succeeded.

        A block that fails only from some states is not reported, because a feasibility fact can be an upper bound. Such
        a fact can also hold in some states from which the block fails.
        """
        for key, rolled in self._failed.items():
            if key in self._succeeded:
                continue
            end = rolled.end(0)
            for literal in rolled.block.measured_exits:
                margin = float(literal.margin(end, rolled.binding))
                if margin < 0:
                    measured = f"the margin is {with_unit(margin, literal.predicate)} at the end of the rollout"
                    self._found.add("exit", rolled.block, rolled.binding, literal.text, measured)

    def _enter(self, state: State) -> frozenset[tuple[str, bool]]:
        """Return pairs of (block, facts) for blocks that can be entered in an initial state.

        If `facts` is true, only the entry conditions on static predicates must hold.
        """
        every = ((block, facts) for block in self._blocks for facts in (False, True))
        holds = _Conditions(state, state)
        return frozenset((b.name, facts) for b, facts in every if any(self._bindings(b, holds, facts)))

    def _bindings(self, block: Block, holds: "_Conditions", facts: bool = False) -> Iterator[dict[str, Value]]:
        """Yield the bindings whose entry conditions and invariants hold.

        If `facts` is true, only the entry conditions on static predicates must hold.
        """
        conditions = block.static_entry if facts else (*block.entry, *block.invariants)
        return enumerate_bindings(self._task.choices(block), conditions, holds)

    def _choose(self, first: State, state: State) -> "_Choice | None":
        """Return a block that can be entered in the state, with targets. Prefer the choice with the fewest steps.

        Return None if no block can be entered, or if all blocks and all possible targets had enough steps.
        """
        possible: dict[_Key, _Choice] = {}
        holds = _Conditions(first, state)
        for block in self._blocks:
            for binding in self._bindings(block, holds):
                key = block.name, tuple(name_of(binding[target.name]) for target in block.targets)
                possible.setdefault(key, _Choice(block, key, [])).bindings.append(binding)
        wanted = [choice for key, choice in possible.items() if self._done[key] < self._due]
        if wanted:
            return min(wanted, key=lambda c: (self._entered[c.block.name] > 0, self._done[c.key], self._rng.random()))
        if min(self._entered.values()) >= self._due:
            return None
        return self._repeat(list(possible.values()), state)

    def _repeat(self, possible: list["_Choice"], state: State) -> "_Choice | None":
        """Return a random choice that repeats earlier steps, because only long walks lead to certain states.

        An exit condition of the choice must not hold yet, so that the step leads to another state.
        """
        for index in self._rng.permutation(len(possible)):
            block, key, every = possible[index].block, possible[index].key, possible[index].bindings
            useful = [b for b in every if any(float(each.margin(state, b)) < 0 for each in block.measured_exits)]
            if useful:
                return _Choice(block, key, useful)
        return None


@dataclass(frozen=True)
class _Choice:
    """A block with certain targets, and all bindings with these targets whose conditions hold in a state.

    Attributes:
        block: the block.
        key: pair of (name of the block, names of the values of its targets).
        bindings: bindings that differ only in the tokens in the slots.
    """

    block: Block
    key: "_Key"
    bindings: list[Binding]


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
