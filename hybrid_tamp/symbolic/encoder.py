"""Encoder: block declarations to lifted STRIPS operators, slot by slot, generic over domains.

Three kinds of operator, one for each edge of the network:

* ``fill-C-s-from-B``: a token is reserved for slot s of the next instance of C, whose anchor is given. Slots are
  filled in their order; the anchor is claimed meanwhile. In time the token stays where it is until `begin`.
* ``begin-C-from-B``: the anchor leaves B and C begins; for blocks with one slot this is all there is. C's exit
  conditions become facts at once; `completed` and `settled` keep others from using them before C has ended.
* ``leave-B-r-to-C``: when the anchor has left B, the tokens of B's other slots leave too, before anything else.

What makes it true to the law: `readers` counts the running instances that read a token, and a block that changes the
token needs the count zero; `settled` says that the block a token is in does not change it; `idle` keeps the
reassignments of one instant together. Instances are identified by (block, anchor), so facts over pairs suffice.
Limits: one block with several slots begins at an instant, and an anchor does not pass from a block with several slots
to the same block.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.network import SlotName
from hybrid_tamp.symbolic.action_builder import ActionBuilder, Same
from hybrid_tamp.symbolic.conditions import Conditions
from hybrid_tamp.symbolic.naming import legal
from hybrid_tamp.symbolic.operators import Operator, PlanningDomain
from hybrid_tamp.symbolic.vocabulary import Vocabulary, leaving, remainders, remembered


@dataclass(frozen=True)
class Meaning:
    """What an operator does, for decoding plans.

    Attributes:
        kind: ``fill``, ``begin`` or ``leave``.
        block: the block that the token goes to.
        slot: the slot that it goes to.
        source: (block, slot) that it comes from.
        roles: roles of the block that are parameters, with their indices.
        old_roles: roles of the source block that are further parameters, with their indices.
    """

    kind: str
    block: str
    slot: str
    source: SlotName
    roles: Mapping[str, int]
    old_roles: Mapping[str, int]


@dataclass(frozen=True, eq=False)
class EncodedDomain:
    """The planning domain of a domain, with the meaning of each operator by its name."""

    vocabulary: Vocabulary
    planning: PlanningDomain
    meanings: dict[str, Meaning]


def encode_domain(domain: Domain) -> EncodedDomain:
    """Compile a domain's blocks and network; the result depends on nothing else."""
    vocabulary = Vocabulary(domain)
    built = list(_Encoder(vocabulary).operators())
    planning = PlanningDomain(
        name=legal(domain.name),
        types=vocabulary.types,
        constants=vocabulary.constants,
        predicates=_used(vocabulary, [operator for operator, _ in built]),
        operators=tuple(operator for operator, _ in built),
        comments=vocabulary.names.changed,
    )
    return EncodedDomain(vocabulary, planning, {operator.name: meaning for operator, meaning in built})


def _used(vocabulary: Vocabulary, operators: list[Operator]) -> tuple[tuple[str, tuple[tuple[str, str], ...]], ...]:
    """Return the user's predicates and those of the compiler's own that an operator mentions."""
    mentioned = {fact[0] for o in operators for facts in (o.precondition, o.add, o.delete) for fact in facts}
    own = {name for name, _ in vocabulary.own_predicates}
    return tuple((name, types) for name, types in vocabulary.predicates if name in mentioned or name not in own)


class _Encoder:
    def __init__(self, vocabulary: Vocabulary) -> None:
        self.vocabulary = vocabulary
        self.domain = vocabulary.domain
        self.conditions = Conditions(vocabulary)

    def operators(self) -> Iterator[tuple[Operator, Meaning]]:
        for source, target in self.domain.network.edges:
            old, new = (self.domain.block_by_name[end[0]] for end in (source, target))
            if len(new.slots) == 1:
                if source[1] == old.anchor:
                    yield from self.begin(old, new)
                else:
                    yield from self.leave(old, source[1], new)
            elif target[1] != new.anchor:
                yield from self.fill(old, source[1], new, target[1])
            elif source[1] == old.anchor and old is not new:
                yield from self.begin(old, new)

    # -- fill ---------------------------------------------------------------------------------------------------

    def fill(self, old: Block, slot_before: str, new: Block, slot: str) -> Iterator[tuple[Operator, Meaning]]:
        """A token is reserved for a slot: from a block with one slot, or from the anchor's own current block."""
        name = f"fill-{legal(new.name)}-{legal(slot)}-from-{legal(old.name)}"
        if len(old.slots) > 1:
            if old is new or slot_before == old.anchor:
                return
            name += f"-{legal(slot_before)}"
        unified = self.conditions.unified(old, slot_before, new, slot)
        action = ActionBuilder(self.vocabulary, name, new, self._same(old, slot_before, slot, unified))
        action.require(("idle",))
        token, anchor = action.role(slot), action.role(new.anchor)
        self._leave_slot(action, old, slot_before, token, unified, anchor)
        self._claim(action, new, slot)
        for literal in self.conditions.entry_at_fill(new, slot):
            action.require_literal(literal)
        for literal in self.conditions.exit_at_fill(new, slot):
            action.apply_literal(literal)
        kept = [action.role(target) for target in remembered(self.domain, new, slot)]
        action.add((f"in-{legal(new.name)}-{legal(slot)}", token, anchor, *kept))
        self._bind_targets(action, new, slot)
        self._start_writing(action, old, slot_before, new, slot)
        if len(old.slots) == 1 and not old.hold:
            action.add(("completed", token))
        yield action.build(), self._meaning("fill", action, new, slot, old, slot_before)

    @staticmethod
    def _meaning(kind: str, action: ActionBuilder, new: Block, slot: str, old: Block, slot_before: str) -> Meaning:
        return Meaning(kind, new.name, slot, (old.name, slot_before), action.roles, action.old_roles)

    def _claim(self, action: ActionBuilder, new: Block, slot: str) -> None:
        """Move the anchor's claim on: unclaimed, then claimed up to each slot in turn."""
        names = [s.name for s in new.others]
        anchor, index = action.variable(new.anchor), names.index(slot)
        before = ("unclaimed", anchor) if index == 0 else (self._claimed(new, names[index - 1]), anchor)
        action.replace(before, (self._claimed(new, slot), anchor))

    @staticmethod
    def _claimed(block: Block, slot: str) -> str:
        return f"claimed-{legal(block.name)}-{legal(slot)}"

    def _bind_targets(self, action: ActionBuilder, new: Block, slot: str) -> None:
        """Note the targets that this slot's conditions mention, for `begin` and later slots to agree with."""
        anchor = action.variable(new.anchor)
        for target, first in self.conditions.bound_by(new).items():
            if target not in action.bound:
                continue
            witness = (f"for-{legal(new.name)}-{legal(target)}", anchor, action.variable(target))
            if first == slot:
                action.add(witness)
            else:
                action.require(witness)

    # -- begin --------------------------------------------------------------------------------------------------

    def begin(self, old: Block, new: Block) -> Iterator[tuple[Operator, Meaning]]:
        """The anchor passes to a new block; one operator for every set of tokens that go with it."""
        movable = [
            slot.name
            for slot in old.others
            if any(self.domain.network.allows((old.name, slot.name), (new.name, to.name)) for to in new.others)
        ]
        for size in range(len(movable) + 1):
            for moved in combinations(movable, size):
                if len(moved) <= len(new.others):
                    yield self._begin(old, new, moved)

    def _begin(self, old: Block, new: Block, moved: tuple[str, ...]) -> tuple[Operator, Meaning]:
        name = "-".join(["begin", legal(new.name), "from", legal(old.name), *(f"with-{legal(s)}" for s in moved)])
        unified = self.conditions.unified(old, old.anchor, new, new.anchor)
        action = ActionBuilder(self.vocabulary, name, new, self._same(old, old.anchor, new.anchor, unified))
        action.require(("idle",))
        anchor = action.role(new.anchor)
        self._leave_anchor(action, old, anchor, unified)
        rest = tuple(slot.name for slot in old.others if slot.name not in moved)
        for slot in old.others:
            action.consume((f"{'full' if slot.name in rest else 'moved'}-{legal(old.name)}-{legal(slot.name)}", anchor))
        if rest:
            action.delete(("idle",))
            action.add((leaving(old, rest), anchor))
        self._enter_anchor(action, old, new)
        return action.build(), self._meaning("begin", action, new, new.anchor, old, old.anchor)

    def _enter_anchor(self, action: ActionBuilder, old: Block, new: Block) -> None:
        anchor = action.variable(new.anchor)
        for target in new.targets:
            action.role(target.name)
        if new.others:
            action.replace((self._claimed(new, new.others[-1].name), anchor), ("unclaimed", anchor))
            for bound in self.conditions.bound_by(new):
                action.consume((f"for-{legal(new.name)}-{legal(bound)}", anchor, action.variable(bound)))
            for slot in new.others:
                action.add((f"full-{legal(new.name)}-{legal(slot.name)}", anchor))
        elif self.conditions.claimable(new, new.anchor):
            action.require(("unclaimed", anchor))
        for literal in self.conditions.entry_at_begin(new):
            action.require_literal(literal)
        self._enter(action, old, old.anchor, new)

    def _enter(self, action: ActionBuilder, old: Block, slot_before: str, new: Block) -> None:
        """What the anchor's entering does in every kind of operator: facts, effects, locks."""
        anchor = action.variable(new.anchor)
        kept = [action.variable(target) for target in remembered(self.domain, new, new.anchor)]
        action.add((f"in-{legal(new.name)}", anchor, *kept))
        for literal in self.conditions.exit_at_begin(new):
            action.apply_literal(literal)
        for target in self.conditions.locked(new):
            action.require(("settled", action.variable(target.name)))
            action.count_readers(action.variable(target.name), +1)
        for one, other in self.conditions.to_keep_apart(new, action.bound):
            action.require(("distinct", action.variable(one), action.variable(other)))
        self._start_writing(action, old, slot_before, new, new.anchor)
        if not new.hold and (old.hold or slot_before != old.anchor):
            action.consume(("completed", anchor))
        elif new.hold and not old.hold and slot_before == old.anchor:
            action.add(("completed", anchor))

    def _start_writing(self, action: ActionBuilder, old: Block, slot_before: str, new: Block, slot: str) -> None:
        """A block that changes a token needs it unread, and unsettles it until it is held or left alone again."""
        if not self.conditions.readable(new, slot):
            return
        token = action.variable(slot)
        if self.conditions.changes(new, slot):
            action.require(("readers", token, self.conditions.none))
        if self.conditions.disturbs(new, slot):
            action.delete(("settled", token))
        elif self.conditions.disturbs(old, slot_before):
            action.add(("settled", token))

    # -- leave --------------------------------------------------------------------------------------------------

    def leave(self, old: Block, slot: str, new: Block) -> Iterator[tuple[Operator, Meaning]]:
        """A token of an ended block goes on to a block with one slot, after its anchor has left."""
        for rest in remainders(old):
            if rest[0] == slot:
                yield self._leave(old, slot, new, rest)

    def _leave(self, old: Block, slot: str, new: Block, rest: tuple[str, ...]) -> tuple[Operator, Meaning]:
        parts = ["leave", legal(old.name), legal(slot), "to", legal(new.name)]
        name = "-".join(parts + [f"before-{legal(other)}" for other in rest[1:]])
        action = ActionBuilder(self.vocabulary, name, new, self._same(old, slot, new.anchor, {}))
        token = action.role(new.anchor)
        if self.conditions.claimable(old, slot):
            action.require(("unclaimed", token))
        anchor = action.other(old, old.anchor)
        following = (leaving(old, rest[1:]), anchor) if rest[1:] else ("idle",)
        action.replace((leaving(old, rest), anchor), following)
        memory = [action.other(old, target) for target in remembered(self.domain, old, slot)]
        action.consume((f"in-{legal(old.name)}-{legal(slot)}", token, anchor, *memory))
        self._void(action, old, slot, {slot: token, old.anchor: anchor}, {})
        for target in new.targets:
            action.role(target.name)
        for literal in self.conditions.entry_at_begin(new):
            action.require_literal(literal)
        self._enter(action, old, slot, new)
        return action.build(), self._meaning("leave", action, new, new.anchor, old, slot)

    @staticmethod
    def _same(old: Block, slot_before: str, slot: str, unified: dict[str, str]) -> Same:
        """Return the classes that roles of the new block have in the old one."""
        pairs = {**unified, slot_before: slot}
        return {new: old.roles[role] for role, new in pairs.items() if role in old.roles}

    # -- leaving the old block ------------------------------------------------------------------------------------

    def _leave_anchor(self, action: ActionBuilder, old: Block, anchor: str, unified: dict[str, str]) -> None:
        memory = [action.other(old, target, unified) for target in remembered(self.domain, old, old.anchor)]
        action.consume((f"in-{legal(old.name)}", anchor, *memory))
        self._void(action, old, old.anchor, {old.anchor: anchor}, unified)
        for target in self.conditions.locked(old):
            action.count_readers(action.other(old, target.name, unified), -1)

    def _leave_slot(
        self, action: ActionBuilder, old: Block, slot: str, token: str, unified: dict[str, str], anchor: str
    ) -> None:
        """Take a token out of a block with one slot, or out of a slot of the anchor's current block."""
        if len(old.slots) == 1:
            if self.conditions.claimable(old, slot):
                action.require(("unclaimed", token))
            self._leave_anchor(action, old, token, unified)
            return
        memory = [action.other(old, target, unified) for target in remembered(self.domain, old, slot)]
        action.consume((f"in-{legal(old.name)}-{legal(slot)}", token, anchor, *memory))
        self._void(action, old, slot, {slot: token, old.anchor: anchor}, unified)
        ending = f"{legal(old.name)}-{legal(slot)}"
        action.replace((f"full-{ending}", anchor), (f"moved-{ending}", anchor))

    def _void(
        self, action: ActionBuilder, old: Block, slot: str, variables: dict[str, str], unified: dict[str, str]
    ) -> None:
        """Delete what the hold of the old block maintained about the token that leaves."""
        for literal in self.conditions.maintained_by(old, slot):
            known = [
                variables[argument]
                if argument in variables
                else (action.other(old, argument, unified) if argument in old.roles else self.vocabulary.word(argument))
                for argument in literal.arguments
            ]
            action.delete((self.vocabulary.word(literal.predicate.name), *known))
