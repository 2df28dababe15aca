"""``fill``: a token is reserved for a slot of the next instance of a block with several."""

from collections.abc import Iterator

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.predicate import Literal
from hybrid_tamp.symbolic.encoding.action_builder import ActionBuilder
from hybrid_tamp.symbolic.encoding.assignment import remembered
from hybrid_tamp.symbolic.encoding.operator_maker import Meaning, OperatorMaker
from hybrid_tamp.symbolic.pddl.naming import legal
from hybrid_tamp.symbolic.pddl.operators import Operator


class FillOperators(OperatorMaker):
    """Makes the operators that reserve tokens."""

    def fill(self, old: Block, slot_before: str, new: Block, slot: str) -> Iterator[tuple[Operator, Meaning]]:
        """A token is reserved for a slot: from a block with one slot, or from the anchor's own current block."""
        name = f"fill-{legal(new.name)}-{legal(slot)}-from-{legal(old.name)}"
        if len(old.slots) > 1:
            if old is new or slot_before == old.anchor:
                return
            name += f"-{legal(slot_before)}"
        unified = self.conditions.unified(old, slot_before, new, slot)
        action = ActionBuilder(self.vocabulary, new, self._same(old, slot_before, slot, unified))
        action.require(("idle",))
        token, anchor = action.role(slot), action.role(new.anchor)
        self._leave_slot(action, old, slot_before, token, unified, anchor)
        self._claim(action, new, slot)
        for literal in self.conditions.entry_at_fill(new, slot):
            action.require_literal(literal)
            self._know_earlier(action, new, slot, literal)
        for literal in self.conditions.exit_at_fill(new, slot):
            action.apply_literal(literal)
            self._know_earlier(action, new, slot, literal)
        kept = [action.role(target) for target in remembered(self.domain, new, slot)]
        action.add((self.vocabulary.state("in", new, slot), token, anchor, *kept))
        self._bind_targets(action, new, slot)
        self._start_writing(action, old, slot_before, new, slot)
        if len(old.slots) == 1 and not old.hold:
            action.add(("completed", token))
        yield action.build(name), Meaning("fill", new.name, slot, (old.name, slot_before), action.roles)

    def _know_earlier(self, action: ActionBuilder, new: Block, slot: str, literal: Literal) -> None:
        """Require that tokens of which a condition speaks are those in the slots that were filled before."""
        for other in new.others:
            if other.name in literal.arguments and other.name != slot:
                kept = [action.role(target) for target in remembered(self.domain, new, other.name)]
                fluent = self.vocabulary.state("in", new, other.name)
                action.require((fluent, action.role(other.name), action.role(new.anchor), *kept))

    def _claim(self, action: ActionBuilder, new: Block, slot: str) -> None:
        """Move the anchor's claim on: unclaimed, then claimed up to each slot in turn."""
        names = [s.name for s in new.others]
        anchor, index = action.variable(new.anchor), names.index(slot)
        before = "unclaimed" if index == 0 else self.vocabulary.state("claimed", new, names[index - 1])
        action.replace((before, anchor), (self.vocabulary.state("claimed", new, slot), anchor))

    def _bind_targets(self, action: ActionBuilder, new: Block, slot: str) -> None:
        """Note the targets that this slot's conditions mention, for `begin` and later slots to agree with."""
        anchor = action.variable(new.anchor)
        for target, first in self.conditions.bound_by(new).items():
            if target not in action.bound:
                continue
            witness = (self.vocabulary.state("for", new, target), anchor, action.variable(target))
            if first == slot:
                action.add(witness)
            else:
                action.require(witness)

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
        action.consume((self.vocabulary.state("in", old, slot), token, anchor, *memory))
        self._void(action, old, slot, {slot: token, old.anchor: anchor}, unified)
        full, moved = (self.vocabulary.state(kind, old, slot) for kind in ("full", "moved"))
        action.replace((full, anchor), (moved, anchor))
