"""``leave``: a token of an ended block goes on to a block with one slot, after its anchor has left."""

from collections.abc import Iterator

from hybrid_tamp.model.block import Block
from hybrid_tamp.symbolic.encoding.action_builder import ActionBuilder
from hybrid_tamp.symbolic.encoding.passing import Meaning, Passing
from hybrid_tamp.symbolic.encoding.vocabulary import leaving, remainders, remembered
from hybrid_tamp.symbolic.pddl.naming import legal
from hybrid_tamp.symbolic.pddl.operators import Operator


class Leaving(Passing):
    """Makes the operators by which the remaining tokens leave."""

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
