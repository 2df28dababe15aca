"""The parts of a domain that depend on where tokens are: conditions that read poses, and slots in which tokens move."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.predicate import Literal, Parameter, Predicate, SymbolSort


@dataclass(frozen=True, eq=False)
class Tracking:
    """Tells which conditions of a domain depend on the whereabouts of which tokens.

    A static predicate depends on the whereabouts of a parameter's token if some block changes a property that the
    predicate reads, unless the block declares that it keeps the predicate.
    """

    domain: Domain

    @cached_property
    def parameters(self) -> dict[str, tuple[int, ...]]:
        """Maps the name of each static predicate to the indices of the parameters whose whereabouts matter."""
        found = {
            predicate.name: tuple(i for i, each in enumerate(predicate.parameters) if self._moves(predicate, each))
            for predicate in self.domain.static_predicates
            if predicate.rows is None and not predicate.at_start
        }
        return {name: indices for name, indices in found.items() if indices}

    def _moves(self, predicate: Predicate, parameter: Parameter) -> bool:
        return any(
            _writes(self.domain, block, slot.name, predicate, parameter)
            for block in self.domain.blocks
            if predicate not in block.keeps
            for slot in block.slots
        )

    @cached_property
    def moving_slots(self) -> dict[str, tuple[str, ...]]:
        """Maps the name of each block to the slots in which the block changes the whereabouts of a token."""
        tracked = [
            (self.domain.predicate_by_name[name], self.domain.predicate_by_name[name].parameters[index])
            for name, indices in self.parameters.items()
            for index in indices
        ]
        found = {
            block.name: tuple(
                slot.name
                for slot in block.slots
                if any(_writes(self.domain, block, slot.name, *each) for each in tracked)
            )
            for block in self.domain.blocks
        }
        return {name: slots for name, slots in found.items() if slots}

    def conditions(self, block: Block) -> Iterator[tuple[Literal, tuple[str, ...]]]:
        """Yield each entry condition that depends on whereabouts, with the roles of the tokens in question."""
        for literal in block.static_entry:
            indices = self.parameters.get(literal.predicate.name, ())
            roles = tuple(dict.fromkeys(literal.arguments[index] for index in indices))
            if roles:
                yield literal, roles

    def roles(self, block: Block) -> tuple[str, ...]:
        """Return the roles of a block whose whereabouts the block requires or changes."""
        asked = (role for _, roles in self.conditions(block) for role in roles)
        return tuple(dict.fromkeys((*asked, *self.moving_slots.get(block.name, ()))))


def _writes(domain: Domain, block: Block, slot: str, predicate: Predicate, parameter: Parameter) -> bool:
    """Return whether a block changes, for a token in a slot, a property that a predicate reads from its parameter."""
    changed = set(block.writes.get(slot, ())) & set(predicate.reads.get(parameter.name, ()))
    sort = parameter.sort
    if not changed or isinstance(sort, SymbolSort):
        return False
    return domain.relations.can_share_token(block.slot(slot).object_class, sort)
