"""Action blocks: slots, targets, conditions, continuous system, policy and hyperparameters (paper, Sec. II-B).

A block declares its symbolic and its continuous model in one place. The exit conditions of a block *are* its effects.
Positive exit conditions are add effects, and negative exit conditions are delete effects. Deletes are applied first.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import Any

from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.authored import authored
from hybrid_tamp.model.control import Hyperparameter, Hyperparameters, PolicyMaker, SystemMaker
from hybrid_tamp.model.course import SweepMaker
from hybrid_tamp.model.default_system import keep_still, make_default_system
from hybrid_tamp.model.key_pose import KeyPoses
from hybrid_tamp.model.measure import Measure
from hybrid_tamp.model.movement import Movement
from hybrid_tamp.model.plan import split_mode
from hybrid_tamp.model.predicate import ANY, Binding, Literal, Predicate, SymbolSort
from hybrid_tamp.model.shapes import check_initial_value
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray

FLOOR = "(floor)"
"""Name of the floor in contacts, which no token can have (see `ContactRules`)."""


@dataclass(frozen=True)
class Slot:
    """A slot of a block, which is filled with exactly one token of the slot's class."""

    name: str
    object_class: type[ObjectClass]


@dataclass(frozen=True)
class Target:
    """A role for a token or symbol that a block reads but does not change.

    Attributes:
        name: name of the target's role.
        sort: class of the token, or sort of the symbol.
        reads: varying properties that a running block reads from the token.
    """

    name: str
    sort: type[ObjectClass] | SymbolSort
    reads: tuple[str, ...] = ("position", "orientation")


@dataclass(frozen=True)
class Duration:
    """Bounds and an estimate for the duration of an instance, which is one execution of a block.

    Attributes:
        minimum: lower bound of the duration [s], greater than zero.
        maximum: upper bound of the time until the exit conditions hold [s]. If the block does not have `hold`, this is
            also the upper bound of the duration.
        expected: function ``expected(binding, state, hyperparameters)`` that returns the expected duration [s].
            If None, the expected duration is that of a rollout with the continuous system of the block.
    """

    minimum: float
    maximum: float
    expected: Callable[[Binding, State, Hyperparameters], float] | None = None


Outcome = Callable[[Binding, State], State]
"""Pure function ``outcome(binding, state)`` that returns the expected state at the end of an instance."""


def _measurable(literals: tuple[Literal, ...]) -> tuple[Literal, ...]:
    return tuple(literal for literal in literals if ANY not in literal.arguments)


@dataclass(frozen=True, eq=False)
class Block:
    """A type of action, or one mode of a type of action.

    An action with several possible outcomes has one mode for each outcome. Each mode is a block named ``"ACTION:mode"``
    with its own conditions, targets and hyperparameters. A network edge of the action applies to all modes.

    Attributes:
        name: name of the block, e.g. ``"ROLLING"`` or ``"REACHING:behind"``.
        slots: one or more slots of the block. Each slot is filled with exactly one token.
        anchor: name of the slot whose token identifies a running instance.
        targets: roles for tokens and symbols that the block reads but does not change.
        entry: conditions over roles that must hold when tokens enter the slots.
        preferences: further static conditions. The planner first looks for a plan in which they hold at each entry, and
            for a plan without them only if there is none or if tokens wait for each other.
        exit: conditions over roles that must hold when the tokens leave. The exit conditions are also the effects.
        invariants: conditions over roles that must hold as long as an instance runs.
        waived: entry conditions that hold throughout an instance in the forward model, but are not invariants. Maps
            each of these conditions to the reason.
        writes: maps each slot to the varying properties that the continuous system changes.
        keeps: predicates that read a written property, but whose atoms the block does not change.
        ends: maps a slot to targets. Together with the initial pose of the slot's token, these targets determine the
            final pose of the token, which `outcome` computes.
        vertical: slots whose tokens move only up and down, and do not turn.
        hyperparameters: policy parameters whose values are optimised.
        duration: bounds and an estimate for the duration of an instance.
        hold: whether an instance can continue after its exit conditions hold, in order to maintain these conditions.
        policy: function ``policy(binding, start, parameters)`` that returns a feedback law. None if there is no policy.
        system: function ``system(binding, start)`` that returns the continuous system of an instance. If None, hands
            obey their commands, and what they hold or push moves with them (see `model.default_system`).
        attached: maps the slot of a token to the slot of the hand that holds the token throughout the block. Only the
            default system uses it. It also finds by itself what fingers grip.
        allowed_contacts: pairs of two roles, or of a role and `FLOOR`, that may touch while the block runs. A pair of
            equal roles allows contact between the tokens with this role in different instances. In place of the second
            role, a condition with one wildcard stands for all tokens for which the condition holds, e.g.
            ``("object", CLEARED(ANY, "tray"))`` for whatever already lies in the tray.
        performance: performance measures of an instance. The weighted sum of the measures is maximised.
        taught: function ``taught(primitive)`` that returns a copy with another `motion.dmp.DMP`. None without one.
        movement: movement that the motor primitive represents, or None.
        path: slot whose token follows `Parameters.path`, a path of the token's position, if the plan gives one. None if
            the policy ignores paths.
        sweep: function ``sweep(binding, start, parameters)`` that returns the `Course` of an instance, i.e. the poses
            along its reference of all tokens that the block moves. If None, only a rollout tells these poses.
        straight: maps slots whose tokens always move straight to functions ``direction(binding, start)``, which return
            the unit vector ``(3,)`` of the movement. Proofs that a body blocks the movement use these directions.
        key_poses: function ``key_poses(binding, start)`` that returns poses through which every execution of an
            instance moves its tokens (see `model.key_pose`). Proofs that a body makes the instance impossible use them.
        outcome: function that returns the expected final state, for scheduling. If None, and if `duration` is not
            declared either, the final state is that of a rollout.
        description: description in one line.
    """

    name: str
    slots: tuple[Slot, ...]
    anchor: str
    duration: Duration
    targets: tuple[Target, ...] = ()
    entry: tuple[Literal, ...] = ()
    preferences: tuple[Literal, ...] = ()
    exit: tuple[Literal, ...] = ()
    invariants: tuple[Literal, ...] = ()
    waived: Mapping[Literal, str] = field(default_factory=dict)
    writes: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    keeps: tuple[Predicate, ...] = ()
    ends: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    vertical: tuple[str, ...] = ()
    hyperparameters: tuple[Hyperparameter, ...] = ()
    hold: bool = False
    policy: PolicyMaker | None = None
    system: SystemMaker | None = None
    attached: Mapping[str, str] = field(default_factory=dict)
    allowed_contacts: tuple[tuple[str, str | Literal], ...] = ()
    performance: tuple[Measure, ...] = ()
    taught: Callable[[Any], "Block"] | None = None
    movement: Movement | None = None
    path: str | None = None
    sweep: SweepMaker | None = None
    straight: Mapping[str, Callable[[Binding, State], FloatArray]] = field(default_factory=dict)
    key_poses: KeyPoses | None = None
    outcome: Outcome | None = None
    description: str = ""

    def __repr__(self) -> str:
        return f"Block({self.name!r})"

    @property
    def action(self) -> str:
        """Name of the block without the mode."""
        return split_mode(self.name)[0]

    @property
    def roles(self) -> Mapping[str, type[ObjectClass] | SymbolSort]:
        """Maps each role to its class or sort. The slots come before the targets."""
        found: dict[str, type[ObjectClass] | SymbolSort] = {s.name: s.object_class for s in self.slots}
        return found | {target.name: target.sort for target in self.targets}

    @property
    def moves(self) -> bool:
        """Whether the continuous system of the block changes the state."""
        return self.system is not None or any(self.writes.values())

    @cached_property
    def system_maker(self) -> SystemMaker:
        """The declared `system`, or the default system. Nothing moves if the block writes nothing."""
        if self.system is not None:
            return self.system
        return partial(make_default_system, self) if self.moves else keep_still

    @property
    def conditions(self) -> tuple[Literal, ...]:
        """All conditions that the block mentions."""
        return (*self.entry, *self.preferences, *self.exit, *self.invariants, *self.contact_conditions)

    @property
    def others(self) -> tuple[Slot, ...]:
        """Slots of the block except the anchor, in order."""
        return tuple(slot for slot in self.slots if slot.name != self.anchor)

    @cached_property
    def measured_exits(self) -> tuple[Literal, ...]:
        """Exit conditions without wildcards. Only conditions without wildcards have a margin."""
        return _measurable(self.exit)

    @cached_property
    def measured_entries(self) -> tuple[Literal, ...]:
        """Entry conditions whose margins are measured when an instance starts."""
        return _measurable(self.changing_entry)

    @cached_property
    def posed_entries(self) -> tuple[Literal, ...]:
        """Feasibility conditions on poses, which earlier blocks of a plan may have changed."""
        return tuple(c for c in self.static_entry if c.predicate.reads and not c.predicate.at_start)

    @property
    def predicted_entries(self) -> tuple[Literal, ...]:
        """Entry conditions that a rollout of a plan evaluates, including feasibility conditions on poses."""
        return (*self.measured_entries, *self.posed_entries)

    @property
    def static_entry(self) -> tuple[Literal, ...]:
        """Entry conditions on static predicates, which are feasibility facts."""
        return tuple(literal for literal in self.entry if literal.predicate.static)

    @property
    def changing_entry(self) -> tuple[Literal, ...]:
        """Entry conditions on predicates that are not static. Other blocks can make these conditions true or false."""
        return tuple(literal for literal in self.entry if not literal.predicate.static)

    @property
    def maintained_exit(self) -> tuple[Literal, ...]:
        """Positive exit conditions that hold only while the instance runs."""
        return tuple(literal for literal in self.exit if literal.predicate.maintained and literal.positive)

    @property
    def contact_conditions(self) -> tuple[Literal, ...]:
        """Conditions in `allowed_contacts`, each with a wildcard for the token that may be touched."""
        return tuple(other for _, other in self.allowed_contacts if isinstance(other, Literal))

    def slot(self, name: str) -> Slot:
        """Return the slot with a given name. Raise a `KeyError` if no slot has this name."""
        return {slot.name: slot for slot in self.slots}[name]

    def initial_values(self, binding: Binding, state: State) -> dict[str, FloatArray]:
        """Return a dictionary that maps each hyperparameter to its initial value, clipped to its bounds."""
        return {h.name: self.initial_value(h, binding, state) for h in self.hyperparameters}

    def initial_value(self, hyperparameter: Hyperparameter, binding: Binding, state: State) -> FloatArray:
        """Return the initial value of a hyperparameter of this block, clipped to its bounds."""
        where = f"{self.name}.{hyperparameter.name}"
        with authored(where, binding):
            value = hyperparameter.initial_value(binding, state)
            check_initial_value(where, binding, value, state, partial(hyperparameter.initial_value, binding))
        return value
