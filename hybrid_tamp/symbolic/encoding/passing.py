"""What operators of every kind do where a token passes from one block to another: it leaves, it enters.

Each kind of operator has a module of its own: `filling`, `beginning`, `leaving`.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.network import SlotName
from hybrid_tamp.symbolic.encoding.action_builder import ActionBuilder, Same
from hybrid_tamp.symbolic.encoding.conditions import Conditions
from hybrid_tamp.symbolic.encoding.vocabulary import Vocabulary, remembered
from hybrid_tamp.symbolic.pddl.naming import legal


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


class Passing:
    """Leaving and entering blocks, for one domain."""

    def __init__(self, vocabulary: Vocabulary) -> None:
        self.vocabulary = vocabulary
        self.domain = vocabulary.domain
        self.conditions = Conditions(vocabulary)

    @staticmethod
    def _meaning(kind: str, action: ActionBuilder, new: Block, slot: str, old: Block, slot_before: str) -> Meaning:
        return Meaning(kind, new.name, slot, (old.name, slot_before), action.roles, action.old_roles)

    @staticmethod
    def _same(old: Block, slot_before: str, slot: str, unified: dict[str, str]) -> Same:
        """Return the classes that roles of the new block have in the old one."""
        pairs = {**unified, slot_before: slot}
        return {new: old.roles[role] for role, new in pairs.items() if role in old.roles}

    @staticmethod
    def _claimed(block: Block, slot: str) -> str:
        return f"claimed-{legal(block.name)}-{legal(slot)}"

    # -- entering the new block

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

    # -- leaving the old block

    def _leave_anchor(self, action: ActionBuilder, old: Block, anchor: str, unified: dict[str, str]) -> None:
        memory = [action.other(old, target, unified) for target in remembered(self.domain, old, old.anchor)]
        action.consume((f"in-{legal(old.name)}", anchor, *memory))
        self._void(action, old, old.anchor, {old.anchor: anchor}, unified)
        for target in self.conditions.locked(old):
            action.count_readers(action.other(old, target.name, unified), -1)

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
