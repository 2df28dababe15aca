"""What a domain declares, for the checks that a domain makes of itself."""

from typing import Protocol

from hybrid_tamp.model.affordance import ClassRelations, ObjectClass
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.network import ReassignmentNetwork
from hybrid_tamp.model.predicate import Predicate, SymbolSort


class Declarations(Protocol):
    """What a domain declares, as far as it is checked."""

    @property
    def name(self) -> str:
        """Name of the domain."""

    @property
    def resting(self) -> str:
        """Name of the block that takes whatever nothing manipulates."""

    @property
    def classes(self) -> tuple[type[ObjectClass], ...]:
        """Object classes."""

    @property
    def sorts(self) -> tuple[SymbolSort, ...]:
        """Symbol sorts beyond those that predicates and targets mention."""

    @property
    def predicates(self) -> tuple[Predicate, ...]:
        """Predicates."""

    @property
    def blocks(self) -> tuple[Block, ...]:
        """Action blocks."""

    @property
    def network(self) -> ReassignmentNetwork:
        """Allowed reassignments."""

    @property
    def relations(self) -> ClassRelations:
        """Which classes may share a token."""
