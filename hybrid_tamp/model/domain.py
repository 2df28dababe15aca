"""Domains, which consist of classes, predicates, blocks and a reassignment network.

The declarations of a domain are checked when the domain is created.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from hybrid_tamp.errors import DomainError
from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.authored import authored
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.declarations import Declarations
from hybrid_tamp.model.domain_checks import faults_of
from hybrid_tamp.model.predicate import Predicate
from hybrid_tamp.model.safety import use_predicates, with_factors
from hybrid_tamp.model.token import Token

_POSE = {"position", "orientation"}


@dataclass(frozen=True, eq=False)
class Domain(Declarations):
    """The classes, predicates and blocks with which tasks are described.

    Attributes:
        name: name of the domain in task files.
        classes: object classes of the domain. The root class TOKEN is added automatically.
        predicates: predicates of the domain, including static predicates.
        blocks: action blocks of the domain.
        network: allowed reassignments between the slots of the blocks.
        resting: name of the block for tokens that no other block manipulates.
        metrics: function that returns further metrics of a finished run for ``result.json``. The function can be None.
        bounds: maps metrics to pairs of (least, greatest) value. A run outside these bounds does not succeed.
        description: description in one line.
        sorts: additional symbol sorts, which no predicate or target mentions.
        disjoint: groups of pairwise disjoint classes. A token can be a member of at most one class of a group.
        reduced: whether the domain is only a part of a checked domain. If so, slots without edges are allowed.
        trials: recipes for trials that test class membership, at most one recipe for each class.

    Raises:
        DomainError: if the declarations contradict each other. The error lists every fault with its place and remedy.
    """

    def __post_init__(self) -> None:
        faults = [] if self.reduced else faults_of(self)
        if faults:
            raise DomainError(faults)

    def __repr__(self) -> str:
        return f"Domain({self.name!r})"

    @cached_property
    def class_by_name(self) -> Mapping[str, type[ObjectClass]]:
        """Maps each name to its object class."""
        return {object_class.name: object_class for object_class in self.classes}

    @cached_property
    def predicate_by_name(self) -> Mapping[str, Predicate]:
        """Maps each name to its predicate."""
        return {predicate.name: predicate for predicate in self.predicates}

    @cached_property
    def static_predicates(self) -> tuple[Predicate, ...]:
        """Predicates whose atoms are feasibility facts, which are computed once before the search."""
        return tuple(predicate for predicate in self.predicates if predicate.static)

    @cached_property
    def changing_predicates(self) -> tuple[Predicate, ...]:
        """Predicates whose atoms can change because blocks add, delete or maintain the atoms."""
        return tuple(predicate for predicate in self.predicates if not predicate.static)

    @cached_property
    def block_by_name(self) -> Mapping[str, Block]:
        """Maps each name to its block."""
        return {block.name: block for block in self.blocks}

    @property
    def _with_safety(self) -> dict[str, Predicate]:
        return {predicate.name: predicate for predicate in self.predicates if predicate.safety is not None}

    @property
    def safety(self) -> dict[str, float]:
        """Maps the name of each predicate with a safety factor to the factor."""
        return {each.name: each.safety.factor for each in self.predicates if each.safety is not None}

    @property
    def resting_block(self) -> Block:
        """Block with one slot, for tokens that no other block manipulates."""
        return self.block_by_name[self.resting]

    def moving_slots(self, token: Token) -> tuple[tuple[Block, str], ...]:
        """Return the slots that can contain a token while it moves, each with its block."""
        return tuple(
            (block, slot.name)
            for block in self.blocks
            for slot in block.slots
            if _POSE & set(block.writes.get(slot.name, ())) and token.is_member(slot.object_class)
        )

    def measure(self, task: Any, recording: Any) -> dict[tuple[str, str], float]:
        """Return the domain's metrics of a finished run of a task. Keys are pairs of (instance, metric with unit)."""
        with authored(f"the metrics of {self.name}", {}):
            return dict(self.metrics(task, recording)) if self.metrics else {}

    def with_blocks(self, blocks: Iterable[Block], predicates: Iterable[Predicate] = ()) -> "Domain":
        """Return the domain with replaced blocks and added predicates. A block replaces the block of the same name."""
        changed = {block.name: use_predicates(block, self._with_safety) for block in blocks}
        mine = tuple(changed.get(block.name, block) for block in self.blocks)
        known = {predicate.name: predicate for predicate in (*self.predicates, *predicates)}
        return replace(self, blocks=mine, predicates=tuple(known.values()))

    def with_safety(self, factors: Mapping[str, float]) -> "Domain":
        """Return the domain with other safety factors. `factors` maps names of predicates to factors of at least 1."""
        return self.with_predicates(with_factors(self.predicate_by_name, factors))

    def with_predicates(self, changed: Mapping[str, Predicate]) -> "Domain":
        """Return the domain with replaced predicates, also in its blocks. `changed` maps names to new predicates."""
        if not changed:
            return self
        predicates = tuple(changed.get(each.name, each) for each in self.predicates)
        blocks = tuple(use_predicates(block, changed) for block in self.blocks)
        return replace(self, predicates=predicates, blocks=blocks)
