"""Whether the exit conditions of an instance are used: something that begins when it ends asks for them.

If there is a choice, e.g. for which of two regions in one line a hand reached behind an object, the used one is right.
"""

from hybrid_tamp.model.predicate import Atom, Literal
from hybrid_tamp.questions.imitate.hypotheses import Hypotheses, Hypothesis, Roles

_COST = 0.2
"""Additional cost of an instance whose targets nothing uses."""

Starting = tuple[str, Roles, Roles]
"""Block, slots and targets of an instance that begins."""


class ExitUse:
    """Compares exit conditions with entry conditions; remembers those of each instance."""

    def __init__(self, hypotheses: Hypotheses) -> None:
        self.hypotheses = hypotheses
        self._atoms: dict[tuple[str, Roles, bool], frozenset[Atom]] = {}

    def cost(self, ending: tuple[Hypothesis, ...], starting: tuple[Starting, ...]) -> float:
        """Return the cost of ending instances with targets whose exit conditions no beginning instance asks for."""
        wanted = frozenset[Atom]().union(*(self._entries(name, slots + targets) for name, slots, targets in starting))
        return _COST * sum(
            bool(hypothesis.block and hypothesis.targets) and not wanted & self._exits(hypothesis)
            for hypothesis in ending
        )

    def _entries(self, name: str, roles: Roles) -> frozenset[Atom]:
        return self._grounded(name, roles, True)

    def _exits(self, hypothesis: Hypothesis) -> frozenset[Atom]:
        return self._grounded(hypothesis.block or "", hypothesis.slots + hypothesis.targets, False)

    def _grounded(self, name: str, roles: Roles, entries: bool) -> frozenset[Atom]:
        key = (name, roles, entries)
        if key not in self._atoms:
            block, binding = self.hypotheses.block(name), self.hypotheses.task.bind(dict(roles))
            literals: tuple[Literal, ...] = block.measured_entries if entries else block.measured_exits
            self._atoms[key] = frozenset(literal.ground(binding) for literal in literals)
        return self._atoms[key]
