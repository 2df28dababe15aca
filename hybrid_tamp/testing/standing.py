"""Entry conditions that hold throughout every rollout of a block, although they are not declared as invariants."""

from collections.abc import Iterable

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.predicate import Literal
from hybrid_tamp.testing.disagreement import Disagreements, first_role, with_unit
from hybrid_tamp.testing.rollouts import Rollouts


class StandingConditions:
    """The least margins of entry conditions over all rollouts of each block."""

    def __init__(self, blocks: Iterable[Block]) -> None:
        self._blocks = tuple(blocks)
        self._least: dict[tuple[str, Literal], float] = {}
        self._rollouts = {block.name: 0 for block in self._blocks}

    def note(self, rolled: Rollouts) -> None:
        """Note the margins of rollouts of a block. Only rows that reached their exit conditions count."""
        if not rolled.rows:
            return
        self._rollouts[rolled.block.name] += len(rolled.rows)
        for literal in _candidates(rolled.block):
            key = (rolled.block.name, literal)
            self._least[key] = min(self._least.get(key, float("inf")), rolled.least(literal))

    def report(self, found: Disagreements) -> None:
        """Add each entry condition that held throughout all rollouts, but is neither an invariant nor waived."""
        for block in self._blocks:
            for literal in _candidates(block):
                least = self._least.get((block.name, literal), -1.0)
                if least >= 0:
                    declared = f"the entry condition {literal.text} is neither an invariant nor waived"
                    count, margin = self._rollouts[block.name], with_unit(least, literal.predicate)
                    measured = f"the condition holds throughout {count} rollouts, with a least margin of {margin}"
                    role = first_role(block, literal.arguments)
                    found.add("invariant", block, {}, declared, measured, role)


def _candidates(block: Block) -> list[Literal]:
    """Return the entry conditions that could be invariants, but are neither invariants nor waived.

    Feasibility facts cannot be invariants. A maintained condition cannot be an invariant either, because the condition
    holds only until the instance that added its atom ends.
    """
    declared = {*block.invariants, *block.waived}
    changing = (literal for literal in block.measured_entries if not literal.predicate.maintained)
    return [literal for literal in changing if literal not in declared]
