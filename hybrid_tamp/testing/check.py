"""The check of a domain. Random walks simulate one block after another, and compare the results with declarations."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TypeVar

import numpy as np

from hybrid_tamp.errors import DomainError
from hybrid_tamp.model.bindings import enumerate_bindings
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.disagreement import Disagreement
from hybrid_tamp.model.predicate import Predicate
from hybrid_tamp.model.simulated import is_simulated, pass_simulator
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.protocol import SIMULATOR, open_backend
from hybrid_tamp.testing.arrivals import Arrivals
from hybrid_tamp.testing.batches import check_batches
from hybrid_tamp.testing.courses import check_courses
from hybrid_tamp.testing.disagreement import Disagreements
from hybrid_tamp.testing.effects import Promises, check_undeclared, check_velocities, check_writes
from hybrid_tamp.testing.ends import check_ends
from hybrid_tamp.testing.entering import report_closed, report_unestablished
from hybrid_tamp.testing.facts import check_facts, check_keeps
from hybrid_tamp.testing.key_poses import check_key_poses
from hybrid_tamp.testing.laws import check_laws
from hybrid_tamp.testing.margins import check_margins
from hybrid_tamp.testing.refusals import add_refusal, predicates_of
from hybrid_tamp.testing.rollouts import Rollouts, draw_hyperparameters, roll_out_rows
from hybrid_tamp.testing.simulation import simulate_blocks
from hybrid_tamp.testing.standing import StandingConditions
from hybrid_tamp.testing.starts import draw_start
from hybrid_tamp.testing.targets import check_target_reads
from hybrid_tamp.testing.tuning import Tuning
from hybrid_tamp.testing.units import check_units
from hybrid_tamp.testing.walk import Choice, Chooser

_WALKS = 4  # Number of random walks, as a multiple of `samples`.
_STEPS = 100  # Maximum number of steps of a random walk.
_REPETITIONS = 20  # A random walk ends after this number of successive steps that repeat earlier steps.
_DRAWN = 3  # Number of rollouts with drawn hyperparameters for each rollout with initial values.
_INITIAL = 0.5  # Probability that the next step starts after the rollout with initial values.
_REMEMBERED = 50  # Number of states in which entry conditions that never hold are evaluated.

_Result = TypeVar("_Result")


def check_domain(
    task: Task, *, samples: int = 8, seed: int = 0, dt: float = 1 / 240, simulate: bool = True
) -> list[Disagreement]:
    """Roll out (simulate) every block for every target from reachable states. Compare the results with declarations.

    Random walks start in the initial state of the task, with displaced and turned tokens. Each step of a walk rolls out
    a block whose entry conditions and invariants hold. The walk prefers the block and targets with the fewest rollouts.
    One rollout uses the initial values of the hyperparameters, and further rollouts use drawn values. The next step
    starts in the final state of one of these rollouts. A walk can thus tip a box and then lower the box. Afterwards,
    each block runs once in physics.

    Args:
        task: a task of the domain. A block is checked only if the task has tokens for its slots.
        samples: minimum number of steps for each block, and for each choice of its targets, if the entry conditions
            hold often enough.
        seed: seed of the random walks.
        dt: time step of the rollouts [s].
        simulate: whether to run the blocks in physics too. Without this, no mistakes of the kinds ``contact`` and
            ``model`` are found.

    Returns:
        One entry for each kind of mistake, block and declaration. The table `KINDS` contains the kinds with meanings
        and remedies. If a function of the domain fails, its block is reported and then left out of the walks.
    """
    check = _Check(pass_simulator(task, partial(open_backend, SIMULATOR)), samples, seed, dt)
    for _ in range(_WALKS * samples):
        check.walk()
    if simulate:
        check.simulate()
    return check.report()


class _Check:
    """The findings of a check in progress."""

    def __init__(self, task: Task, samples: int, seed: int, dt: float) -> None:
        self._dt = dt
        # The walks have a generator of their own, so that further checks do not change the walks.
        self._rng, self._other_rng = np.random.default_rng(seed), np.random.default_rng(seed)
        self._blocks = [b for b in task.domain.blocks if any(enumerate_bindings(task.choices(b)))]
        self._found, self._refused = Disagreements(), set[Block]()
        check_units(task, self._blocks, self._found)
        check_keeps(task.domain, self._blocks, self._found)
        unsound = check_margins(task, self._blocks, self._found, self._other_rng)
        self._task = _without(task, unsound)
        self._refused.update(b for b in self._blocks if not unsound.isdisjoint(predicates_of(b)))
        self._chooser = Chooser(task, [b for b in self._blocks if b not in self._refused], samples, self._rng)
        self._standing, self._tuning = StandingConditions(self._blocks), Tuning(dt)
        self._arrivals, self._promises = Arrivals(dt), Promises(self._task)
        self._reached = [task.state]
        self._allowed = self._attempt(lambda: self._chooser.enter(task.state)) or frozenset()

    def walk(self) -> None:
        """Roll out one block after another, until many successive steps have repeated earlier steps."""
        self._chooser.begin()
        self._attempt(self._walk)

    def _walk(self) -> None:
        """Walk once. A failed step is not counted if an earlier step of the walk used drawn hyperparameters.

        The planner would avoid this failure, because the planner chooses the hyperparameters of consecutive blocks
        together.
        """
        first = state = draw_start(self._task, self._rng, lambda drawn: self._chooser.enter(drawn) >= self._allowed)
        initial, repetitions = True, 0
        for _ in range(_STEPS):
            choice = self._chooser.choose(first, state)
            if choice is None or repetitions == _REPETITIONS:
                return
            repeated = self._chooser.count(choice)
            repetitions = repetitions + 1 if repeated else 0
            rolled = self._step(first, choice, state, repeated)
            if rolled is None:
                return
            if not rolled.rows:
                self._chooser.count(choice, 0 if initial else -1)
                return
            row = rolled.rows[0 if self._rng.random() < _INITIAL else -1]
            initial &= row == 0
            state = rolled.end(row)
            if len(self._reached) < _REMEMBERED:
                self._reached.append(state)

    def _step(self, first: State, choice: Choice, state: State, repeated: bool) -> Rollouts | None:
        """Roll out a block and examine the rollouts. Return None if a function of the block failed."""
        block, binding = choice.block, choice.bindings[int(self._rng.integers(len(choice.bindings)))]
        count = _DRAWN if block.hyperparameters and not repeated else 0
        try:
            chosen = draw_hyperparameters(block, binding, state, count, self._rng)
            rolled = roll_out_rows(block, binding, state, chosen, 1 + count, self._dt)
            self._examine(first, choice, rolled, repeated)
        except DomainError as error:
            self._refuse(add_refusal(error, [block, *self._blocks], binding, self._found) or [block])
            return None
        return rolled

    def _examine(self, first: State, choice: Choice, rolled: Rollouts, repeated: bool) -> None:
        self._arrivals.note(choice.key, rolled)
        if not repeated:
            if not check_laws(rolled, self._found):
                self._refuse([rolled.block])
                return
            check_writes(rolled, self._found)
            if not is_simulated(rolled.block):  # Contacts in physics can change a velocity within a time step.
                check_velocities(rolled, self._found)
            check_target_reads(self._task, rolled, self._found, self._other_rng)
            self._tuning.note(rolled, self._found)
        if not rolled.rows:
            return
        self._standing.note(rolled)
        if not repeated:
            check_batches(rolled, self._found)
            check_facts(self._task, first, rolled, self._found, self._rng)
            check_courses(rolled, self._found)
            check_key_poses(rolled, self._found)
            check_ends(rolled, choice.bindings, self._found, self._rng)
            check_undeclared(self._task, rolled, self._found)
            self._promises.note(rolled)

    def _refuse(self, blocks: list[Block]) -> None:
        """Leave out blocks whose functions fail."""
        for block in blocks:
            self._refused.add(block)
            self._chooser.drop(block)

    def _attempt(self, action: Callable[[], _Result]) -> _Result | None:
        """Return the result of an action, or None after a function of the domain failed."""
        try:
            return action()
        except DomainError as error:
            self._refuse(add_refusal(error, self._blocks, {}, self._found))
            return None

    def simulate(self) -> None:
        """Run each block in physics."""
        self._attempt(lambda: simulate_blocks(self._task, self._chooser, self._found, self._other_rng, self._dt))

    def report(self) -> list[Disagreement]:
        """Return the disagreements."""
        report_unestablished(self._task, self._blocks, self._found)
        for block in self._blocks:
            # If functions of other blocks fail, these blocks cannot establish the entry conditions.
            if not self._refused and not self._arrivals.ran(block) and not self._found.has("entry", block):
                report_closed(self._task, block, self._reached, self._found)
        self._arrivals.report(self._found)
        self._standing.report(self._found)
        self._promises.report(self._found)
        self._tuning.report(self._found)
        return self._found.all()


def _without(task: Task, unsound: frozenset[Predicate]) -> Task:
    """Return the task with a domain that lacks predicates whose margins cannot be evaluated."""
    if not unsound:
        return task
    predicates = tuple(each for each in task.domain.predicates if each not in unsound)
    return task.replaced(domain=replace(task.domain, predicates=predicates, reduced=True))
