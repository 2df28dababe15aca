"""Action blocks: slots, targets, conditions, continuous system, policy, hyperparameters (paper, Sec. II-B).

A block has one symbolic and one continuous face and declares both in one place. Its exit conditions *are* its
effects: deletes (negative literals) before adds.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.plan import split_mode
from hybrid_tamp.model.predicate import ANY, Literal, Predicate, SymbolSort, Value
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray

CONTROL_PERIOD = 1 / 240
"""Time between two commands [s]: policies are asked, and conditions looked at, this often."""

Binding = Mapping[str, Value]
"""Role (slot or target) of an instance to the token or symbol bound to it."""

Commands = dict[tuple[str, str], FloatArray]
"""(token, basic action) to the command, shape ``(..., size)`` in the action's unit."""

Hyperparameters = Mapping[str, FloatArray]
"""Hyperparameter to its value, shape ``(...)``, in its unit."""


class Policy(Protocol):
    """A feedback law: elapsed time and state to basic actions. It keeps no memory of its own."""

    def __call__(self, elapsed: FloatArray, state: State) -> Commands:
        """Return the commands.

        Args:
            elapsed: time since the instance began [s], shape ``(...)``.
            state: current state, batch shape ``(...)``.
        """
        ...


PolicyMaker = Callable[[Binding, State, Hyperparameters], Policy]
"""Make the policy of one instance from its binding, the state at its beginning and its hyperparameters."""

ContinuousSystem = Callable[[Binding, State, Commands, float], State]
"""``system(binding, state, commands, dt)``: next state of the tokens in the block's slots; pure."""


@dataclass(frozen=True)
class Slot:
    """A place in a block for exactly one token of the class."""

    name: str
    object_class: type[ObjectClass]


@dataclass(frozen=True)
class Target:
    """A token or symbol that a block reads but does not hold.

    Attributes:
        name: role of the target.
        sort: class of the token, or the sort of the symbol.
        reads: varying properties of the token that the block reads while it runs.
    """

    name: str
    sort: type[ObjectClass] | SymbolSort
    reads: tuple[str, ...] = ("position", "orientation")


@dataclass(frozen=True)
class Hyperparameter:
    """A bounded number with a unit that shapes a policy.

    Attributes:
        name: e.g. ``"speed"``.
        unit: SI unit.
        lower: lower bound [unit].
        upper: upper bound [unit].
        guess: initial guess ``guess(binding, state)`` of shape ``(...)`` from the state at the block's beginning.
        description: one line.
        within: ``within(binding)`` to bounds that follow from the tokens, e.g. from the length of a handle, or None;
            they narrow the others.
    """

    name: str
    unit: str
    lower: float
    upper: float
    guess: Callable[[Binding, State], FloatArray]
    description: str = ""
    within: Callable[[Binding], tuple[float, float]] | None = None

    def bounds(self, binding: Binding) -> tuple[float, float]:
        """Return the lower and the upper bound [unit] for these tokens."""
        if self.within is None:
            return self.lower, self.upper
        low, high = self.within(binding)
        return float(np.clip(low, self.lower, self.upper)), float(np.clip(high, self.lower, self.upper))

    def initial(self, binding: Binding, state: State) -> FloatArray:
        """Return the guess clipped to the bounds."""
        return np.clip(self.guess(binding, state), *self.bounds(binding))


@dataclass(frozen=True)
class Measure:
    """One term of a block's performance measure (paper, Secs. II-D and III-B): a figure and what it weighs.

    Exactly one of `end`, `peak` and `rate` says how the figure comes about.

    Attributes:
        name: e.g. ``"contact"``.
        unit: SI unit of the figure.
        weight: what one `scale` of it adds to the value of a plan; negative for a cost. Tasks may change it.
        scale: size of the figure that counts as one [unit].
        end: ``end(binding, before, after, hyperparameters)`` from the states at the beginning and the end, ``(...)``.
        peak: ``peak(binding, state)``, of which the largest value while the block ran counts, ``(...)``.
        rate: ``rate(binding, state, commands)``, integrated over the time that the block ran, ``(...)`` [unit/s].
        description: one line.
    """

    name: str
    unit: str
    weight: float
    scale: float = 1.0
    end: Callable[[Binding, State, State, Hyperparameters], FloatArray] | None = None
    peak: Callable[[Binding, State], FloatArray] | None = None
    rate: Callable[[Binding, State, Commands], FloatArray] | None = None
    description: str = ""


@dataclass(frozen=True)
class Duration:
    """How long an instance lasts [s].

    Attributes:
        minimum: lower bound, more than zero.
        maximum: by then the exit conditions must hold; a block without a hold must have ended too.
        expected: estimate ``expected(binding, state, hyperparameters)`` from the state at its beginning.
    """

    minimum: float
    maximum: float
    expected: Callable[[Binding, State, Hyperparameters], float]


@dataclass(frozen=True)
class Movement:
    """What the motor primitive of a block's reference trajectory moves, and what demonstrates it.

    Attributes:
        slot: the slot whose token shows it.
        moves: the varying property of that token that moves: ``position`` or ``orientation``.
        dimensions: 3 for the position itself [m], 1 for the travelled share of the way or of the angle.
    """

    slot: str
    moves: str
    dimensions: int


Outcome = Callable[[Binding, State], State]
"""``outcome(binding, state)``: where the tokens in the slots are going to be when the exit conditions hold; pure."""


def _rest(binding: Binding, state: State, commands: Commands, dt: float) -> State:
    return state


def _measurable(literals: tuple[Literal, ...]) -> tuple[Literal, ...]:
    return tuple(literal for literal in literals if ANY not in literal.arguments)


@dataclass(frozen=True, eq=False)
class Block:
    """One type of action, or one mode of it.

    Modes are outcomes of one action with conditions, targets and hyperparameters of their own; each is a block named
    ``"ACTION:mode"``, and edges of the network that name the action alone hold for all of them.

    Attributes:
        name: e.g. ``"ROLLING"`` or ``"REACHING:behind"``.
        slots: one or more, each for exactly one token.
        anchor: name of the slot whose token names a running instance.
        targets: what it reads but does not hold.
        entry: conditions over roles under which its tokens may be assigned.
        exit: conditions over roles under which its tokens may leave; also its effects.
        writes: slot to the varying properties that its continuous system changes.
        keeps: predicates that stay as they are although they read something written.
        hyperparameters: what shapes its policy.
        duration: bounds and estimate.
        hold: whether it goes on holding once its exit conditions hold.
        policy: maker of the feedback law, or None where no token has basic actions.
        system: the forward model.
        performance: how good one execution was: the weighted sum of these measures, maximised.
        taught: ``taught(primitive)``: the block with another motor primitive (a `motion.dmp.DMP`) for its reference
            trajectory, or None where it has none; all else stays as it is.
        movement: what that primitive moves, or None.
        outcome: estimate of where its tokens are in the end, for schedules, or None where they stay where they are.
        description: what it does, one line.
    """

    name: str
    slots: tuple[Slot, ...]
    anchor: str
    duration: Duration
    targets: tuple[Target, ...] = ()
    entry: tuple[Literal, ...] = ()
    exit: tuple[Literal, ...] = ()
    writes: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    keeps: tuple[Predicate, ...] = ()
    hyperparameters: tuple[Hyperparameter, ...] = ()
    hold: bool = False
    policy: PolicyMaker | None = None
    system: ContinuousSystem = _rest
    performance: tuple[Measure, ...] = ()
    taught: Callable[[Any], "Block"] | None = None
    movement: Movement | None = None
    outcome: Outcome | None = None
    description: str = ""

    def __repr__(self) -> str:
        return f"Block({self.name!r})"

    @property
    def action(self) -> str:
        """The name without the mode."""
        return split_mode(self.name)[0]

    @property
    def roles(self) -> Mapping[str, type[ObjectClass] | SymbolSort]:
        """Slots, then targets, each with its class or sort."""
        found: dict[str, type[ObjectClass] | SymbolSort] = {s.name: s.object_class for s in self.slots}
        return found | {target.name: target.sort for target in self.targets}

    @property
    def moves(self) -> bool:
        """Whether its continuous system changes anything."""
        return self.system is not _rest

    @property
    def others(self) -> tuple[Slot, ...]:
        """The slots other than the anchor, in order."""
        return tuple(slot for slot in self.slots if slot.name != self.anchor)

    @property
    def measured_exits(self) -> tuple[Literal, ...]:
        """The exit conditions that have a margin: a wildcard only says which old facts are void."""
        return _measurable(self.exit)

    @property
    def measured_entries(self) -> tuple[Literal, ...]:
        """The entry conditions that must be measured as it starts; static facts do not change."""
        return tuple(literal for literal in _measurable(self.entry) if not literal.predicate.static)

    def slot(self, name: str) -> Slot:
        """Return the slot of that name; KeyError if there is none."""
        return {slot.name: slot for slot in self.slots}[name]

    def guesses(self, binding: Binding, state: State) -> dict[str, FloatArray]:
        """Return the initial guess of every hyperparameter, clipped to its bounds."""
        return {h.name: h.initial(binding, state) for h in self.hyperparameters}
