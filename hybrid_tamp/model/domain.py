"""A domain: classes, predicates, blocks and their network, as one value that is checked when it is made."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

from hybrid_tamp.errors import DomainError
from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.declarations import Declarations
from hybrid_tamp.model.domain_checks import faults_of
from hybrid_tamp.model.predicate import Predicate


@dataclass(frozen=True, eq=False)
class Domain(Declarations):
    """A modelled world of tasks.

    Attributes:
        name: name of the domain in task files.
        classes: its object classes (the root class TOKEN is always there).
        predicates: its predicates, static ones included.
        blocks: its action blocks.
        network: allowed reassignments between their slots.
        resting: name of the block of tokens that nothing manipulates.
        metrics: measures of a finished run for ``result.json``, (instance, measure) to the figure; or None.
        description: one line.
        sorts: symbol sorts beyond those that predicates and targets mention.
        disjoint: groups of classes that never share a token, pairwise.
        reduced: whether it was reduced from a checked domain; its slots may lack edges in or out.
        trials: recipes of membership trials, for the classes that have one.

    Raises:
        DomainError: the declarations contradict each other; the error has every fault with its place and remedy.
    """

    def __post_init__(self) -> None:
        faults = [] if self.reduced else faults_of(self)
        if faults:
            raise DomainError(faults)

    def __repr__(self) -> str:
        return f"Domain({self.name!r})"

    @cached_property
    def class_by_name(self) -> Mapping[str, type[ObjectClass]]:
        """Object classes by their own names."""
        return {object_class.name: object_class for object_class in self.classes}

    @cached_property
    def predicate_by_name(self) -> Mapping[str, Predicate]:
        """Predicates by name."""
        return {predicate.name: predicate for predicate in self.predicates}

    @cached_property
    def static_predicates(self) -> tuple[Predicate, ...]:
        """The predicates whose atoms are decided once, before any search."""
        return tuple(predicate for predicate in self.predicates if predicate.static)

    @cached_property
    def changing_predicates(self) -> tuple[Predicate, ...]:
        """The predicates whose atoms blocks set, delete or maintain."""
        return tuple(predicate for predicate in self.predicates if not predicate.static)

    @cached_property
    def block_by_name(self) -> Mapping[str, Block]:
        """Blocks by name."""
        return {block.name: block for block in self.blocks}

    @property
    def resting_block(self) -> Block:
        """The block of tokens that nothing manipulates; it has one slot."""
        return self.block_by_name[self.resting]

    def with_blocks(self, blocks: Iterable[Block], predicates: Iterable[Predicate] = ()) -> "Domain":
        """Return the domain with these blocks, which replace those of the same names, and these predicates."""
        changed = {block.name: block for block in blocks}
        mine = tuple(changed.get(block.name, block) for block in self.blocks)
        known = {predicate.name: predicate for predicate in (*self.predicates, *predicates)}
        return replace(self, blocks=mine, predicates=tuple(known.values()))
