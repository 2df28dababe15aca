"""The part of a domain with some of its blocks, and with nothing that these do not mention."""

from collections.abc import Collection, Iterable, Iterator
from dataclasses import replace

from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.predicate import Predicate, SymbolSort
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token


def domain_part(task: Task, blocks: Collection[Block], tokens: Iterable[Token]) -> Domain:
    """Return the part of the domain with these blocks, and with what they and these tokens and the goal mention."""
    domain = task.domain
    mentioned = {literal.predicate.name for block in blocks for literal in (*block.entry, *block.exit)}
    mentioned |= {atom.predicate for atom in task.goal}
    predicates = tuple(predicate for predicate in domain.predicates if predicate.name in mentioned)
    classes = set(_classes(blocks, predicates, tokens))
    above = {each for member in classes for each in member.__mro__}
    return replace(
        domain,
        classes=tuple(each for each in domain.classes if each in classes),
        predicates=predicates,
        blocks=tuple(blocks),
        network=domain.network.restrict({block.name for block in blocks}),
        sorts=(),
        disjoint=tuple(tuple(member for member in group if member in above) for group in domain.disjoint),
        reduced=True,
    )


def _classes(
    blocks: Collection[Block], predicates: Iterable[Predicate], tokens: Iterable[Token]
) -> Iterator[type[ObjectClass]]:
    """Yield the classes that are mentioned, and those above them."""
    sorts = [sort for block in blocks for sort in block.roles.values()]
    sorts += [parameter.sort for predicate in predicates for parameter in predicate.parameters]
    mentioned = [sort for sort in sorts if not isinstance(sort, SymbolSort)]
    mentioned += [member for token in tokens for member in token.classes]
    for each in dict.fromkeys(mentioned):
        yield from (above for above in each.__mro__ if issubclass(above, ObjectClass))
