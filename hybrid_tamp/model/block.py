"""Action blocks: slots, targets, conditions, continuous system, policy, hyperparameters (paper, Sec. II-B).

A block has one symbolic and one continuous face and declares both in one place. Its exit conditions *are* its
effects: deletes (negative literals) before adds.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.control import Commands, ContinuousSystem, PolicyMaker, SystemMaker
from hybrid_tamp.model.measure import Measure
from hybrid_tamp.model.parameters import Hyperparameter, Hyperparameters
from hybrid_tamp.model.plan import split_mode
from hybrid_tamp.model.predicate import ANY, Binding, Literal, Predicate, SymbolSort
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray


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


def _rest(binding: Binding, start: State) -> ContinuousSystem:
    return _stay


def _stay(state: State, commands: Commands, dt: float) -> State:
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
        policy: ``policy(binding, start, parameters)`` makes the feedback law of an instance; None if no token has
            basic actions.
        system: ``system(binding, start)`` makes the forward model of an instance.
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
        return _measurable(self.changing_entry)

    @property
    def static_entry(self) -> tuple[Literal, ...]:
        """The entry conditions that are feasibility facts."""
        return tuple(literal for literal in self.entry if literal.predicate.static)

    @property
    def changing_entry(self) -> tuple[Literal, ...]:
        """The entry conditions that other blocks bring about or undo."""
        return tuple(literal for literal in self.entry if not literal.predicate.static)

    @property
    def maintained_exit(self) -> tuple[Literal, ...]:
        """The exit conditions that live as long as an instance: its hold keeps them."""
        return tuple(literal for literal in self.exit if literal.predicate.maintained and literal.positive)

    def slot(self, name: str) -> Slot:
        """Return the slot of that name; KeyError if there is none."""
        return {slot.name: slot for slot in self.slots}[name]

    def initial_values(self, binding: Binding, state: State) -> dict[str, FloatArray]:
        """Return the initial value of every hyperparameter, clipped to its bounds."""
        return {h.name: h.initial_value(binding, state) for h in self.hyperparameters}
