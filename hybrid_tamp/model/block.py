"""Action blocks: slots, targets, conditions, continuous system, policy, hyperparameters (paper, Sec. II-B).

A block declares its symbolic and its continuous side in one place. Its exit conditions *are* its effects; deletes
(negative literals) come before adds.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.control import (
    Commands,
    ContinuousSystem,
    Hyperparameter,
    Hyperparameters,
    PolicyMaker,
    SystemMaker,
)
from hybrid_tamp.model.plan import split_mode
from hybrid_tamp.model.predicate import ANY, Binding, Literal, Predicate, SymbolSort
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray


@dataclass(frozen=True)
class Slot:
    """An opening in a block for exactly one token of the class."""

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
class Duration:
    """Bounds and estimate of the time that an instance lasts [s].

    Attributes:
        minimum: lower bound, more than zero.
        maximum: upper bound until the exit conditions hold; an instance without a hold also ends by then.
        expected: ``expected(binding, state, hyperparameters)``, the estimate from the state at the beginning.
    """

    minimum: float
    maximum: float
    expected: Callable[[Binding, State, Hyperparameters], float]


@dataclass(frozen=True)
class Movement:
    """The movement that the motor primitive of a block's reference trajectory describes.

    Attributes:
        slot: the slot whose token demonstrates the movement.
        moves: the varying property of that token that moves: ``position`` or ``orientation``.
        dimensions: 3 for the position itself [m], 1 for the travelled fraction of the path or of the angle.
    """

    slot: str
    moves: str
    dimensions: int


@dataclass(frozen=True)
class Measure:
    """One term of a block's performance measure (paper, Secs. II-D and III-B): a figure and its weight.

    Exactly one of `end`, `peak` and `rate` computes the figure.

    Attributes:
        name: e.g. ``"contact"``.
        unit: SI unit of the figure.
        weight: value of one `scale` of the figure in a plan; negative for a cost. Tasks may change it.
        scale: size of the figure that counts as one [unit].
        end: ``end(binding, before, after, hyperparameters)`` from the states at the beginning and the end, ``(...)``.
        peak: ``peak(binding, state)``; the largest value while the block runs counts, ``(...)``.
        rate: ``rate(binding, state, commands)``, integrated over the time that the block runs, ``(...)`` [unit/s].
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


Outcome = Callable[[Binding, State], State]
"""``outcome(binding, state)``: expected state of the tokens in the slots when the exit conditions hold; pure."""


def _rest(binding: Binding, start: State) -> ContinuousSystem:
    return _stay


def _stay(state: State, commands: Commands, dt: float) -> State:
    return state


def _measurable(literals: tuple[Literal, ...]) -> tuple[Literal, ...]:
    return tuple(literal for literal in literals if ANY not in literal.arguments)


@dataclass(frozen=True, eq=False)
class Block:
    """One type of action, or one mode of it.

    The modes of an action are its different outcomes. Each mode has its own conditions, targets and hyperparameters
    and is a block named ``"ACTION:mode"``. An edge of the network that names the action alone holds for all modes.

    Attributes:
        name: e.g. ``"ROLLING"`` or ``"REACHING:behind"``.
        slots: one or more, each for exactly one token.
        anchor: name of the slot whose token identifies an instance.
        targets: tokens and symbols that it reads but does not hold.
        entry: conditions over roles under which its tokens may be assigned.
        exit: conditions over roles under which its tokens may leave; they are also its effects.
        writes: slot to the varying properties that its continuous system changes.
        keeps: predicates whose atoms do not change, although they read a property that it writes.
        hyperparameters: parameters of its policy that are optimised.
        duration: bounds and estimate.
        hold: whether it continues after its exit conditions hold, and maintains them.
        policy: ``policy(binding, start, parameters)`` makes the feedback law of an instance; None if no token has
            basic actions.
        system: ``system(binding, start)`` makes the forward model of an instance.
        performance: measures of one execution; their weighted sum is maximised.
        taught: ``taught(primitive)``, the same block with another motor primitive (a `motion.dmp.DMP`) for its
            reference trajectory; None if it has no such trajectory.
        movement: the movement that the primitive describes, or None.
        outcome: estimate of the final state of its tokens, for schedules; None if they do not move.
        description: one line.
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
    system: SystemMaker = _rest
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
        """Role to class or sort: slots first, then targets."""
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
        """The exit conditions that have a margin; those with a wildcard only delete facts."""
        return _measurable(self.exit)

    @property
    def measured_entries(self) -> tuple[Literal, ...]:
        """The entry conditions that are measured when it starts; static facts do not change."""
        return _measurable(self.changing_entry)

    @property
    def static_entry(self) -> tuple[Literal, ...]:
        """The entry conditions that are feasibility facts."""
        return tuple(literal for literal in self.entry if literal.predicate.static)

    @property
    def changing_entry(self) -> tuple[Literal, ...]:
        """The entry conditions that other blocks set or delete."""
        return tuple(literal for literal in self.entry if not literal.predicate.static)

    @property
    def maintained_exit(self) -> tuple[Literal, ...]:
        """The exit conditions that hold only while the instance runs."""
        return tuple(literal for literal in self.exit if literal.predicate.maintained and literal.positive)

    def slot(self, name: str) -> Slot:
        """Return the slot of that name; KeyError if there is none."""
        return {slot.name: slot for slot in self.slots}[name]

    def initial_values(self, binding: Binding, state: State) -> dict[str, FloatArray]:
        """Return the initial value of every hyperparameter, clipped to its bounds."""
        return {h.name: h.initial_value(binding, state) for h in self.hyperparameters}
