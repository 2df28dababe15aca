"""The declarations of a domain, before `model.domain_checks` has checked them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from hybrid_tamp.model.affordance import ClassRelations, ObjectClass
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.network import ReassignmentNetwork
from hybrid_tamp.model.predicate import Predicate, SymbolSort
from hybrid_tamp.model.trial import TrialRecipe

Metrics = Callable[[Any, Any], Mapping[tuple[str, str], float]]
"""Function ``metrics(task, recording)`` that maps each pair of (instance, metric with unit) to its value."""


@dataclass(frozen=True, eq=False)
class Declarations:
    """The unchecked declarations of a domain. See `Domain` for the attributes."""

    name: str
    classes: tuple[type[ObjectClass], ...]
    predicates: tuple[Predicate, ...]
    blocks: tuple[Block, ...]
    network: ReassignmentNetwork
    resting: str = "RESTING"
    metrics: Metrics | None = None
    bounds: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    description: str = ""
    sorts: tuple[SymbolSort, ...] = ()
    disjoint: tuple[tuple[type[ObjectClass], ...], ...] = ()
    reduced: bool = False
    trials: tuple[TrialRecipe[Any], ...] = ()

    @cached_property
    def relations(self) -> ClassRelations:
        """Rules that determine whether two classes can have a common member."""
        return ClassRelations(self.disjoint)
