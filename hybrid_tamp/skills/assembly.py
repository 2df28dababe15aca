"""Assembly of a domain from its blocks. Classes, predicates and the network follow from the blocks."""

from collections.abc import Iterable, Iterator, Set
from typing import Any

from hybrid_tamp.model.affordance import TOKEN, ObjectClass
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.network import ReassignmentNetwork
from hybrid_tamp.model.predicate import Predicate
from hybrid_tamp.skills.resting import RESTING


def make_domain(
    name: str,
    blocks: Iterable[Block],
    edges: Iterable[tuple[str, str]] = (),
    handed: Iterable[Predicate] = (),
    **told: Any,
) -> Domain:
    """Return the domain of some blocks and RESTING.

    Args:
        name: name of the domain in task files.
        blocks: all blocks except RESTING.
        edges: further edges of the network, as pairs of ``"BLOCK.slot"``, e.g. from one movement of a hand directly to
            the next. See `derive_edges` for the other edges.
        handed: predicates whose facts end when their tokens rest, e.g. `Grip.held`, because a resting hand opens.
        **told: further arguments of `Domain`.

    Raises:
        DomainError: if the declarations contradict each other.
    """
    every = (*blocks, RESTING)
    network = ReassignmentNetwork((*derive_edges(every, handed), *edges), [block.name for block in every])
    return Domain(name, find_classes(every), find_predicates(every), every, network, **told)


def find_predicates(blocks: Iterable[Block]) -> tuple[Predicate, ...]:
    """Return the predicates of all conditions, in the order of their first mention."""
    return tuple(dict.fromkeys(literal.predicate for block in blocks for literal in block.conditions))


def find_classes(blocks: Iterable[Block]) -> tuple[type[ObjectClass], ...]:
    """Return the classes of all slots, targets and parameters, in the order of their first mention."""
    blocks = tuple(blocks)
    parameters = (parameter.sort for predicate in find_predicates(blocks) for parameter in predicate.parameters)
    sorts = (*(sort for block in blocks for sort in block.roles.values()), *parameters)
    return tuple(dict.fromkeys(each for each in sorts if isinstance(each, type) and each is not TOKEN))


def derive_edges(blocks: Iterable[Block], handed: Iterable[Predicate] = ()) -> Iterator[tuple[str, str]]:
    """Yield the edges that the conditions of the blocks imply.

    A block that requires a maintained fact gets the tokens of this fact from the block that maintains the fact, because
    the fact ends with this block. The same holds for facts of the predicates in `handed`, whose tokens never go to
    RESTING. All other tokens come from RESTING, and may go to RESTING.
    """
    blocks, handed = tuple(blocks), frozenset(handed)
    slots = [(block, slot) for block in blocks if block is not RESTING for slot in block.slots]
    for block, slot in slots:
        place = f"{block.name}.{slot.name}"
        givers = [f"{giver.name}.{role}" for giver in blocks for role in _handed(giver, block, slot.name, handed)]
        yield from ((giver, place) for giver in dict.fromkeys(givers) or ["RESTING.token"])
        if not any(made.predicate in handed and slot.name in made.arguments for made in block.exit if made.positive):
            yield place, "RESTING.token"


def _handed(giver: Block, taker: Block, slot: str, handed: Set[Predicate]) -> Iterator[str]:
    """Yield the slots of `giver` that hold the token of a fact which `taker` requires of a slot, and which ends."""
    ending = {literal.predicate for literal in taker.changing_entry if literal.predicate.maintained} | handed
    for literal in taker.changing_entry:
        if literal.positive and literal.predicate in ending and slot in literal.arguments:
            index = literal.arguments.index(slot)
            for made in giver.exit:
                same = made.positive and made.predicate is literal.predicate
                if same and made.arguments[index] in {each.name for each in giver.slots}:
                    yield made.arguments[index]
