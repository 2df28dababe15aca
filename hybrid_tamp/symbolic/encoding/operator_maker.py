"""Preconditions and effects of leaving and entering a block, for operators of all kinds."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Literal

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.network import SlotName
from hybrid_tamp.symbolic.encoding.action_builder import ActionBuilder, Same
from hybrid_tamp.symbolic.encoding.assignment import remembered
from hybrid_tamp.symbolic.encoding.conditions import Conditions
from hybrid_tamp.symbolic.encoding.vocabulary import Vocabulary


@dataclass(frozen=True)
class Meaning:
    """The meaning of an operator. Plans are decoded from the meanings of their actions.

    Attributes:
        kind: Kind of the operator: ``fill``, ``begin`` or ``leave``.
        block: Block that the token enters.
        slot: Slot that the token enters.
        source: Pair of (block, slot) that the token leaves.
        roles: Maps roles of the block to the indices of their parameters.
        along: Slots of the source block whose tokens enter the new block together with the anchor.
    """

    kind: Literal["fill", "begin", "leave"]
    block: str
    slot: str
    source: SlotName
    roles: Mapping[str, int]
    along: frozenset[str] = frozenset()


class OperatorMaker:
    """Makes the preconditions and effects of leaving and entering the blocks of one domain."""

    def __init__(self, vocabulary: Vocabulary) -> None:
        self.vocabulary = vocabulary
        self.domain = vocabulary.domain
        self.conditions = Conditions(vocabulary)

    @staticmethod
    def _same(old: Block, slot_before: str, slot: str, unified: dict[str, str]) -> Same:
        """Return a dictionary that maps roles of the new block to the classes of the matching old roles."""
        pairs = {**unified, slot_before: slot}
        return {new: old.roles[role] for role, new in pairs.items() if role in old.roles}

    # -- entering the new block

    def _enter(self, action: ActionBuilder, old: Block, slot_before: str, new: Block) -> None:
        """Add the preconditions and effects of an anchor that enters a block."""
        for literal in self.conditions.entry_at_begin(new):
            action.require_literal(literal)
        anchor = action.variable(new.anchor)
        kept = [action.variable(target) for target in remembered(self.domain, new, new.anchor)]
        action.add((self.vocabulary.state("in", new), anchor, *kept))
        for literal in self.conditions.exit_at(new, new.anchor):
            action.apply_literal(literal)
        for target in self.conditions.locked(new):
            action.require(("settled", action.variable(target.name)))
            action.count_readers(action.variable(target.name), +1)
        self._keep_apart(action, new)
        self._start_writing(action, old, slot_before, new, new.anchor)
        if not new.hold and (old.hold or slot_before != old.anchor):
            action.consume(("completed", anchor))
        elif new.hold and not old.hold and slot_before == old.anchor:
            action.add(("completed", anchor))

    def _keep_apart(self, action: ActionBuilder, new: Block) -> None:
        for one, other in self.conditions.to_keep_apart(new, action.bound):
            action.require(("distinct", action.variable(one), action.variable(other)))

    def _start_writing(self, action: ActionBuilder, old: Block, slot_before: str, new: Block, slot: str) -> None:
        """If the block changes the token of the slot, require that no instance reads the token. Update `settled`."""
        token = action.variable(slot)
        if not self.conditions.readable(new, slot):
            return
        if self.conditions.changes(new, slot) and slot not in self.conditions.read_until_begin(new):
            action.require(("readers", token, self.vocabulary.none_reading))
        if self.conditions.disturbs(new, slot):
            action.delete(("settled", token))
        elif self.conditions.disturbs(old, slot_before):
            action.add(("settled", token))

    # -- leaving the old block

    def _leave_anchor(
        self, action: ActionBuilder, old: Block, anchor: str, unified: dict[str, str], last: Collection[str] = ()
    ) -> None:
        """Remove an anchor from its block. The targets in `last` must have no other readers."""
        self._void(action, old, old.anchor, {old.anchor: anchor}, unified)
        for target in self.conditions.locked(old):
            action.count_readers(action.other(old, target.name, unified), -1, target.name in last)

    def _void(
        self, action: ActionBuilder, old: Block, slot: str, variables: dict[str, str], unified: dict[str, str]
    ) -> None:
        """Delete the facts that place a token in the old block or that the old block maintains for the token."""
        # `variables` maps the slot and the anchor to their variables.
        memory = [action.other(old, target, unified) for target in remembered(self.domain, old, slot)]
        place = self.vocabulary.state("in", old, *(() if slot == old.anchor else (slot,)))
        action.consume((place, *variables.values(), *memory))
        for literal in self.conditions.maintained_by(old, slot):
            known = [
                variables.get(a) or (action.other(old, a, unified) if a in old.roles else self.vocabulary.symbol(a))
                for a in literal.arguments
            ]
            action.delete((self.vocabulary.predicate(literal.predicate.name), *known))
