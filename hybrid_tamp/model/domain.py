"""A domain: classes, predicates, blocks and their network, as one value checked when it is made."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

from hybrid_tamp.errors import DomainError
from hybrid_tamp.model.affordance import ClassRelations, ObjectClass
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.domain_checks import faults_of
from hybrid_tamp.model.network import ReassignmentNetwork
from hybrid_tamp.model.predicate import Predicate, SymbolSort
from hybrid_tamp.model.trial import TrialRecipe

Metrics = Callable[[Any, Any], Mapping[tuple[str, str], float]]
"""``metrics(task, recording)``: a domain's own measures of a finished run, (instance, name with unit) to value.

A task knows its domain, so a domain does not know the class of tasks.
"""


@dataclass(frozen=True, eq=False)
class Domain:
    """A modelled world of tasks.

    Attributes:
        name: name by which task files call it.
        classes: its object classes (the root class TOKEN is always there).
        predicates: its predicates, static ones included.
        blocks: its action blocks.
        network: allowed reassignments between their slots.
        sorts: symbol sorts beyond those that predicates and targets mention.
        disjoint: groups of classes that never share a token, pairwise.
        reduced: whether it was made from a domain that was checked; its slots may lack ways in or out.
        resting: name of the block that takes whatever nothing manipulates.
        metrics: measures of a finished run for ``result.json``, (instance, measure) to the figure; or None.
        description: one line.
        trials: how membership of a class is tried, for those classes for which the domain knows.

    Raises:
        DomainError: the declarations contradict each other; every fault with its place and remedy.
    """

    name: str
    classes: tuple[type[ObjectClass], ...]
    predicates: tuple[Predicate, ...]
    blocks: tuple[Block, ...]
    network: ReassignmentNetwork
    resting: str = "RESTING"
    metrics: Metrics | None = None
    description: str = ""
    sorts: tuple[SymbolSort, ...] = field(default=())
    disjoint: tuple[tuple[type[ObjectClass], ...], ...] = ()
    reduced: bool = False
    trials: tuple[TrialRecipe[Any], ...] = ()

    def __post_init__(self) -> None:
        faults = [] if self.reduced else faults_of(self)
        if faults:
            raise DomainError(faults)

    def __repr__(self) -> str:
        return f"Domain({self.name!r})"

    @cached_property
    def relations(self) -> ClassRelations:
        """Which classes may share a token."""
        return ClassRelations(self.disjoint)

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
        """The predicates that are decided once, before any search."""
        return tuple(predicate for predicate in self.predicates if predicate.static)

    @cached_property
    def changing_predicates(self) -> tuple[Predicate, ...]:
        """The predicates that blocks set and delete, or maintain."""
        return tuple(predicate for predicate in self.predicates if not predicate.static)

    @cached_property
    def block_by_name(self) -> Mapping[str, Block]:
        """Blocks by name."""
        return {block.name: block for block in self.blocks}

    @property
    def resting_block(self) -> Block:
        """The block that takes whatever nothing manipulates; it has one slot."""
        return self.block_by_name[self.resting]

    def with_blocks(self, blocks: Iterable[Block], predicates: Iterable[Predicate] = ()) -> "Domain":
        """Return the domain with these blocks and predicates in place of those of the same names, or besides them."""
        changed = {block.name: block for block in blocks}
        mine = tuple(changed.get(block.name, block) for block in self.blocks)
        known = {predicate.name: predicate for predicate in (*self.predicates, *predicates)}
        return replace(self, blocks=mine, predicates=tuple(known.values()))
