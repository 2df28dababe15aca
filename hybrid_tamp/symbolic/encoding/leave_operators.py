"""``leave``: a token of an ended block goes on to a block with one slot, after its anchor has left."""

from collections.abc import Iterator

from hybrid_tamp.model.block import Block
from hybrid_tamp.symbolic.encoding.action_builder import ActionBuilder
from hybrid_tamp.symbolic.encoding.assignment import remainders, remembered
from hybrid_tamp.symbolic.encoding.operator_maker import Meaning, OperatorMaker
from hybrid_tamp.symbolic.pddl.naming import legal
from hybrid_tamp.symbolic.pddl.operators import Operator


class LeaveOperators(OperatorMaker):
    """Makes the operators by which the remaining tokens leave."""

    def leave(self, old: Block, slot: str, new: Block) -> Iterator[tuple[Operator, Meaning]]:
        """A token of an ended block goes on to a block with one slot, after its anchor has left."""
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
        memory = [action.other(old, target) for target in remembered(self.domain, old, slot)]
        action.consume((self.vocabulary.state("in", old, slot), token, anchor, *memory))
        self._void(action, old, slot, {slot: token, old.anchor: anchor}, {})
        for target in new.targets:
            action.role(target.name)
        for literal in self.conditions.entry_at_begin(new):
            action.require_literal(literal)
        self._enter(action, old, slot, new)
        return action.build(name), Meaning("leave", new.name, new.anchor, (old.name, slot), action.roles)
