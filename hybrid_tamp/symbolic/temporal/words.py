"""PDDL names of the temporal encoder's own fluents and constants, and conversion of predicates to fluents."""

from dataclasses import dataclass
from functools import cached_property

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.predicate import Predicate
from hybrid_tamp.symbolic.encoding.assignment import keeper
from hybrid_tamp.symbolic.encoding.conditions import Conditions
from hybrid_tamp.symbolic.encoding.vocabulary import Vocabulary
from hybrid_tamp.symbolic.pddl.naming import Naming
from hybrid_tamp.symbolic.pddl.operators import Fact
from hybrid_tamp.symbolic.temporal.problem import Value

NOBODY = "nobody"


@dataclass(frozen=True, eq=False)
class Words:
    """The PDDL names of the temporal encoder's own fluents and constants."""

    vocabulary: Vocabulary

    @cached_property
    def _names(self) -> Naming[tuple[str, ...]]:
        domain = self.vocabulary.domain
        own = (NOBODY, "slot", "place", "passes", "partner", "let-go", "crew", "readers", "completed")
        words: dict[tuple[str, ...], str] = {(name,): name for name in own}
        words |= {("reads", f"{number}"): f"reads {number}" for number in range(self.locks)}
        words |= {("slot", b.name, slot.name): f"{b.name} {slot.name}" for b in domain.blocks for slot in b.slots}
        words |= {("lasts", block.name): f"lasts {block.name}" for block in domain.blocks}
        kept = [predicate for predicate in domain.predicates if predicate.maintained]
        words |= {("no", p.name, q.name): f"no {q.name} of {p.name}" for p in kept for q in p.parameters}
        return Naming(words, taken=self.vocabulary.names.all | {"distinct"})

    def __call__(self, *word: str) -> str:
        """Return the PDDL name of a fluent or constant of the encoder."""
        return self._names.pddl(word)

    def reads(self, number: int) -> str:
        """Return the fluent whose value is the locked target with this number."""
        return self("reads", f"{number}")

    def sources(self, block: Block, slot: str, along: bool) -> list[tuple[Block, str]]:
        """Return pairs of (block, slot) from which a token can enter a slot.

        Args:
            block: Block that the token enters.
            slot: Slot that the token enters.
            along: Whether the token comes from the same instance as the anchor.
        """
        domain, found = self.vocabulary.domain, []
        for name, before in domain.network.sources((block.name, slot)):
            old = domain.block_by_name[name]
            together = (
                slot != block.anchor
                and before != old.anchor
                and domain.network.allows((name, old.anchor), (block.name, block.anchor))
            )
            # If a condition requires that the old anchor is the new anchor, the token cannot come separately.
            bound = self.conditions.unified(old, before, block, slot).get(old.anchor) == block.anchor
            if (along and together) or (not along and not (together and bound)):
                found.append((old, before))
        return found

    @property
    def all(self) -> frozenset[str]:
        """All PDDL names of the temporal encoding."""
        return self._names.all

    def slot(self, block: Block, slot: str) -> str:
        """Return the PDDL constant for a slot."""
        return self("slot", block.name, slot)

    @cached_property
    def locks(self) -> int:
        """The largest number of locked targets of any block."""
        return max((len(self.conditions.locked(block)) for block in self.vocabulary.domain.blocks), default=0)

    @cached_property
    def conditions(self) -> Conditions:
        """The assignment of the conditions of the domain's blocks to operators."""
        return Conditions(self.vocabulary)

    def key(self, predicate: Predicate) -> tuple[int, ...]:
        """Return the indices of the arguments that are parameters of a predicate's fluent, not its value."""
        everything = tuple(range(len(predicate.parameters)))
        if predicate.maintained:
            kept = {
                literal.arguments.index(keeper(block, literal.arguments))
                for block in self.vocabulary.domain.blocks
                for literal in block.exit
                if literal.predicate is predicate and literal.positive
            }
            return tuple(kept) if len(kept) == 1 else everything
        return tuple(i for i in everything if i != predicate.functional_index)

    def none(self, predicate: Predicate) -> tuple[str, ...]:
        """Return the value 'none' of a predicate's fluent, which means that the fluent has no value."""
        if not predicate.maintained:
            return (self.vocabulary.no_value(predicate),)
        rest = [q for i, q in enumerate(predicate.parameters) if i not in self.key(predicate)]
        return tuple(self("no", predicate.name, parameter.name) for parameter in rest)

    def stated(self, predicate: Predicate, name: str, arguments: tuple[str, ...]) -> tuple[Fact, Value]:
        """Convert an atom to a pair of (fluent, value)."""
        key = self.key(predicate)
        values = tuple(a for i, a in enumerate(arguments) if i not in key)
        return (name, *(arguments[i] for i in key)), values or True
