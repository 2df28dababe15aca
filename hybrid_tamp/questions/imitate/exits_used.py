"""What an instance was for: its exit conditions are what something that begins when it ends asks for.

Where there is a choice, e.g. for which of two regions in one line a hand reached behind a thing, use was made of it.
"""

from hybrid_tamp.model.predicate import Atom, Literal
from hybrid_tamp.questions.imitate.hypotheses import Guess, Guesser, Roles

_COST = 0.2
"""What an instance costs more whose targets were for nothing that was seen."""
Starting = tuple[str, Roles, Roles]
"""Block, slots and targets of an instance that begins."""


class Purposes:
    """Tells what instances were for; remembers the conditions of each."""

    def __init__(self, guesser: Guesser) -> None:
        self.guesser = guesser
        self._atoms: dict[tuple[str, Roles, bool], frozenset[Atom]] = {}

    def cost(self, ending: tuple[Guess, ...], starting: tuple[Starting, ...]) -> float:
        """Return what it costs that something ends that chose targets, and nothing begins that asks for its exits."""
        wanted = frozenset[Atom]().union(*(self._entries(name, slots + targets) for name, slots, targets in starting))
        return _COST * sum(bool(guess.block and guess.targets) and not wanted & self._exits(guess) for guess in ending)

    def _entries(self, name: str, roles: Roles) -> frozenset[Atom]:
        return self._grounded(name, roles, True)

    def _exits(self, guess: Guess) -> frozenset[Atom]:
        return self._grounded(guess.block or "", guess.slots + guess.targets, False)

    def _grounded(self, name: str, roles: Roles, entries: bool) -> frozenset[Atom]:
        key = (name, roles, entries)
        if key not in self._atoms:
            block, binding = self.guesser.block(name), self.guesser.task.bind(dict(roles))
            literals: tuple[Literal, ...] = block.measured_entries if entries else block.measured_exits
            self._atoms[key] = frozenset(literal.ground(binding) for literal in literals)
        return self._atoms[key]
