"""The operators of the edges of the network: ``fill``, ``begin`` and ``leave`` (see `encoder`)."""

from collections.abc import Collection, Iterator
from itertools import combinations

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.predicate import Literal
from hybrid_tamp.symbolic.encoding.action_builder import ActionBuilder
from hybrid_tamp.symbolic.encoding.assignment import remainders, remembered
from hybrid_tamp.symbolic.encoding.operator_maker import Meaning, OperatorMaker
from hybrid_tamp.symbolic.pddl.naming import legal
from hybrid_tamp.symbolic.pddl.operators import Operator


class EdgeOperators(OperatorMaker):
    """Makes the operators for the edges between two blocks."""

    # -- fill ---------------------------------------------------------------------------------------------------

    def fill(self, old: Block, slot_before: str, new: Block, slot: str) -> Iterator[tuple[Operator, Meaning]]:
        """Yield the operator that reserves a token for a slot. Some edges have no such operator."""
        # The token comes from a block with one slot, or from the current block of the anchor.
        if len(old.slots) == 1 or not (old is new or slot_before == old.anchor):
            yield self._fill(old, slot_before, new, slot)

    def _fill(self, old: Block, slot_before: str, new: Block, slot: str) -> tuple[Operator, Meaning]:
        name = f"fill-{legal(new.name)}-{legal(slot)}-from-{legal(old.name)}"
        if len(old.slots) > 1:
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
        for literal in self.conditions.exit_at(new, slot):
            action.apply_literal(literal)
            self._know_earlier(action, new, slot, literal)
        kept = [action.role(target) for target in remembered(self.domain, new, slot)]
        action.add((self.vocabulary.state("in", new, slot), token, anchor, *kept))
        self._bind_targets(action, new, slot)
        self._keep_apart(action, new)
        self._start_writing(action, old, slot_before, new, slot)
        if len(old.slots) == 1 and not old.hold:
            action.add(("completed", token))
        return action.build(name), Meaning("fill", new.name, slot, (old.name, slot_before), action.roles)

    def _know_earlier(self, action: ActionBuilder, new: Block, slot: str, literal: Literal) -> None:
        """Require that the other tokens in a condition already fill their slots."""
        for other in new.others:
            if other.name in literal.arguments and other.name != slot:
                self._know_filled(action, new, other.name)

    def _know_filled(self, action: ActionBuilder, new: Block, slot: str) -> None:
        """Require that the token of a slot, which becomes a parameter, already fills the slot."""
        kept = [action.role(target) for target in remembered(self.domain, new, slot)]
        action.require((self.vocabulary.state("in", new, slot), action.role(slot), action.role(new.anchor), *kept))

    def _claim(self, action: ActionBuilder, new: Block, slot: str) -> None:
        """Advance the claim on the anchor by one slot. The first slot requires an unclaimed anchor."""
        names = [s.name for s in new.others]
        anchor, index = action.variable(new.anchor), names.index(slot)
        before = "unclaimed" if index == 0 else self.vocabulary.state("claimed", new, names[index - 1])
        action.replace((before, anchor), (self.vocabulary.state("claimed", new, slot), anchor))

    def _bind_targets(self, action: ActionBuilder, new: Block, slot: str) -> None:
        """Record the targets in the conditions of a slot, so that later fills and `begin` use the same targets."""
        anchor = action.variable(new.anchor)
        for target, first in self.conditions.bound_by(new).items():
            record = action.add if first == slot else action.require
            if target in action.bound:
                record((self.vocabulary.state("for", new, target), anchor, action.variable(target)))

    def _leave_slot(
        self, action: ActionBuilder, old: Block, slot: str, token: str, unified: dict[str, str], anchor: str
    ) -> None:
        """Remove a token from a block with one slot, or from a slot of the anchor's current block."""
        if len(old.slots) == 1:
            if self.conditions.claimable(old, slot):
                action.require(("unclaimed", token))
            self._leave_anchor(action, old, token, unified)
            return
        self._void(action, old, slot, {slot: token, old.anchor: anchor}, unified)
        full, moved = (self.vocabulary.state(kind, old, slot) for kind in ("full", "moved"))
        action.replace((full, anchor), (moved, anchor))

    # -- begin --------------------------------------------------------------------------------------------------

    def begin(self, old: Block, new: Block) -> Iterator[tuple[Operator, Meaning]]:
        """Yield operators that move the anchor to a new block, one for each set of slots that move with the anchor.

        If the anchor may read tokens in its old block that the new block changes, further operators are needed.
        """
        movable = [
            slot.name
            for slot in old.others
            if any(self.domain.network.allows((old.name, slot.name), (new.name, to.name)) for to in new.others)
        ]
        for size in range(min(len(movable), len(new.others)) + 1):
            for moved in combinations(movable, size):
                for read in self.conditions.read_before(old, new):
                    yield self._begin(old, new, moved, read)

    def _begin(self, old: Block, new: Block, moved: tuple[str, ...], read: dict[str, str]) -> tuple[Operator, Meaning]:
        # `read` maps targets of the old block to slots of the new block with the same token.
        name = "-".join(["begin", legal(new.name), "from", legal(old.name), *(f"with-{legal(s)}" for s in moved)])
        name += "".join(f"-{legal(slot)}-was-{legal(target)}" for target, slot in read.items())
        unified = self.conditions.unified(old, old.anchor, new, new.anchor) | read
        action = ActionBuilder(self.vocabulary, new, self._same(old, old.anchor, new.anchor, unified))
        action.require(("idle",))
        anchor = action.role(new.anchor)
        self._leave_anchor(action, old, anchor, unified, read)
        self._start_changing(action, new, unread=set(read.values()))
        rest = tuple(slot.name for slot in old.others if slot.name not in moved)
        for slot in old.others:
            action.consume((self.vocabulary.state("full" if slot.name in rest else "moved", old, slot.name), anchor))
        if rest:
            action.delete(("idle",))
            action.add((self.vocabulary.state("leaving", old, *rest), anchor))
        self._enter_anchor(action, old, new)
        source = (old.name, old.anchor)
        return action.build(name), Meaning("begin", new.name, new.anchor, source, action.roles, frozenset(moved))

    def _start_changing(self, action: ActionBuilder, new: Block, unread: Collection[str]) -> None:
        """Require that no instance reads a token that the block changes. Slots in `unread` need no such condition.

        Tokens other than the anchor may read the token until they fill their slots. So `fill` cannot require this.
        """
        for slot in self.conditions.read_until_begin(new):
            self._know_filled(action, new, slot)
            if slot not in unread:
                action.require(("readers", action.variable(slot), self.vocabulary.none_reading))

    def _enter_anchor(self, action: ActionBuilder, old: Block, new: Block) -> None:
        anchor = action.variable(new.anchor)
        for target in new.targets:
            action.role(target.name)
        for slot in self.conditions.bound_late(new):
            self._know_filled(action, new, slot)
        if new.others:
            claimed = self.vocabulary.state("claimed", new, new.others[-1].name)
            action.replace((claimed, anchor), ("unclaimed", anchor))
            for bound in self.conditions.bound_by(new):
                action.consume((self.vocabulary.state("for", new, bound), anchor, action.variable(bound)))
            for other in new.others:
                action.add((self.vocabulary.state("full", new, other.name), anchor))
        elif self.conditions.claimable(new, new.anchor):
            action.require(("unclaimed", anchor))
        self._enter(action, old, old.anchor, new)

    # -- leave --------------------------------------------------------------------------------------------------

    def leave(self, old: Block, slot: str, new: Block) -> Iterator[tuple[Operator, Meaning]]:
        """Yield operators that move a token out of a block after the anchor, one for each set of remaining slots."""
        for rest in remainders(old):
            if rest[0] == slot:
                yield self._leave(old, slot, new, rest)

    def _leave(self, old: Block, slot: str, new: Block, rest: tuple[str, ...]) -> tuple[Operator, Meaning]:
        later = (f"before-{legal(other)}" for other in rest[1:])
        name = "-".join(["leave", legal(old.name), legal(slot), "to", legal(new.name), *later])
        action = ActionBuilder(self.vocabulary, new, self._same(old, slot, new.anchor, {}))
        token = action.role(new.anchor)
        if self.conditions.claimable(old, slot):
            action.require(("unclaimed", token))
        anchor = action.other(old, old.anchor)
        following = (self.vocabulary.state("leaving", old, *rest[1:]), anchor) if rest[1:] else ("idle",)
        action.replace((self.vocabulary.state("leaving", old, *rest), anchor), following)
        self._void(action, old, slot, {slot: token, old.anchor: anchor}, {})
        for target in new.targets:
            action.role(target.name)
        self._enter(action, old, slot, new)
        return action.build(name), Meaning("leave", new.name, new.anchor, (old.name, slot), action.roles)
