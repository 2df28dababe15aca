"""``begin``: the anchor passes to a new block, which begins; for a block with one slot this is all there is."""

from collections.abc import Iterator
from itertools import combinations

from hybrid_tamp.model.block import Block
from hybrid_tamp.symbolic.encoding.action_builder import ActionBuilder
from hybrid_tamp.symbolic.encoding.operator_maker import Meaning, OperatorMaker
from hybrid_tamp.symbolic.pddl.naming import legal
from hybrid_tamp.symbolic.pddl.operators import Operator


class BeginOperators(OperatorMaker):
    """Makes the operators by which blocks begin."""

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
        action = ActionBuilder(self.vocabulary, new, self._same(old, old.anchor, new.anchor, unified))
        action.require(("idle",))
        anchor = action.role(new.anchor)
        self._leave_anchor(action, old, anchor, unified)
        rest = tuple(slot.name for slot in old.others if slot.name not in moved)
        for slot in old.others:
            action.consume((self.vocabulary.state("full" if slot.name in rest else "moved", old, slot.name), anchor))
        if rest:
            action.delete(("idle",))
            action.add((self.vocabulary.state("leaving", old, *rest), anchor))
        self._enter_anchor(action, old, new)
        source = (old.name, old.anchor)
        return action.build(name), Meaning("begin", new.name, new.anchor, source, action.roles, frozenset(moved))

    def _enter_anchor(self, action: ActionBuilder, old: Block, new: Block) -> None:
        anchor = action.variable(new.anchor)
        for target in new.targets:
            action.role(target.name)
        if new.others:
            claimed = self.vocabulary.state("claimed", new, new.others[-1].name)
            action.replace((claimed, anchor), ("unclaimed", anchor))
            for bound in self.conditions.bound_by(new):
                action.consume((self.vocabulary.state("for", new, bound), anchor, action.variable(bound)))
            for slot in new.others:
                action.add((self.vocabulary.state("full", new, slot.name), anchor))
        elif self.conditions.claimable(new, new.anchor):
            action.require(("unclaimed", anchor))
        for literal in self.conditions.entry_at_begin(new):
            action.require_literal(literal)
        self._enter(action, old, old.anchor, new)
