"""Relevance: the blocks that a goal may need, whatever tokens there are, and the part of a task that is about them.

Backwards from the goal, a block is relevant if it changes something that the goal, or the entry of a relevant block,
asks for; and if tokens may have to pass through it on their way between relevant blocks. A task that has a plan has one
of relevant blocks alone: whoever would pass through another one stays where it was, or goes on at once.
"""

from collections.abc import Callable, Collection, Iterable, Iterator, Set
from itertools import product

from hybrid_tamp.feasibility.domain_part import domain_part
from hybrid_tamp.model.affordance import TOKEN, ObjectClass
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.network import SlotName
from hybrid_tamp.model.predicate import Literal, SymbolSort
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token

Classes = tuple[type[ObjectClass], ...]
Ask = tuple[str, tuple[Classes, ...]]
"""A predicate and, for each of its arguments, the classes of what stands there; none for a symbol."""


def relevant_blocks(task: Task) -> tuple[Block, ...]:
    """Return the blocks that a plan of the task may need, in the domain's order; resting is among them."""
    domain = task.domain
    kept = {domain.resting, *task.assignment.values()}
    asks = set(_asked_by_goal(task))
    more = kept
    while more:
        kept = _with_serving(domain, kept | more, asks)
        # Only then: what is relevant already need not be passed through.
        more = _on_the_way(domain, kept)
    return tuple(block for block in domain.blocks if block.name in kept)


def _asked_by_goal(task: Task) -> Iterator[Ask]:
    for atom in task.goal:
        parameters = task.domain.predicate_by_name[atom.predicate].parameters
        yield (
            atom.predicate,
            tuple(
                (*token.classes, *token.unknown)
                if (token := task.token_by_name.get(name))
                else _of_sort(parameter.sort)
                for name, parameter in zip(atom.arguments, parameters, strict=True)
            ),
        )


def _asked_by_block(block: Block) -> Iterator[Ask]:
    # Conditions that something is not so are feasibility conditions, which nothing changes.
    return (_ask(block, literal) for literal in block.changing_entry)


def _ask(block: Block, literal: Literal) -> Ask:
    roles = block.roles
    return (literal.predicate.name, tuple(_of_sort(roles.get(argument)) for argument in literal.arguments))


def _of_sort(sort: type[ObjectClass] | SymbolSort | None) -> Classes:
    return () if sort is None or isinstance(sort, SymbolSort) else (sort,)


def _with_serving(domain: Domain, kept: Set[str], asks: Set[Ask]) -> set[str]:
    """Return some blocks and those that serve what is asked for, by the goal and by the blocks themselves."""
    found, before = set(kept), set[str]()
    while found != before:
        before = set(found)
        every = asks | {ask for name in found for ask in _asked_by_block(domain.block_by_name[name])}
        found |= {block.name for block in domain.blocks if block.name not in found and _serves(domain, block, every)}
    return found


def _serves(domain: Domain, block: Block, asks: Collection[Ask]) -> bool:
    """Say whether a block may change what is asked for."""
    return any(
        name == ask_name and all(_can_be_one(domain, one, other) for one, other in zip(changed, classes, strict=True))
        for name, changed in (_ask(block, literal) for literal in block.exit)
        for ask_name, classes in asks
    )


def _can_be_one(domain: Domain, one: Classes, other: Classes) -> bool:
    """Say whether a token of some classes may stand where one of others is asked for; of symbols that is not asked."""
    return all(domain.relations.can_share_token(a, b) for a, b in product(one, other))


def _on_the_way(domain: Domain, kept: Collection[str]) -> set[str]:
    """Return the further blocks through which tokens may have to pass between slots of some blocks."""
    graph = domain.network.graph
    ends = [slot for slot in graph if slot[0] in kept]
    after = {slot: _reached(graph.successors, slot, kept) for slot in ends}
    before = {slot: _reached(graph.predecessors, slot, kept) for slot in ends}
    return {
        name
        for source, target in product(ends, ends)
        if not _passed_by(domain, source, target)
        for name, _ in after[source] & before[target]
    }


def _reached(step: Callable[[SlotName], Iterable[SlotName]], end: SlotName, kept: Collection[str]) -> set[SlotName]:
    """Return the slots to which steps lead from a slot without passing one of the blocks that are kept."""
    found: set[SlotName] = set()
    waiting = [end]
    while waiting:
        new = [slot for slot in step(waiting.pop()) if slot[0] not in kept and slot not in found]
        found.update(new)
        waiting += new
    return found


def _passed_by(domain: Domain, source: SlotName, target: SlotName) -> bool:
    """Say whether a token can go from one slot to the other directly and wait in one of them as long as it has to."""
    waits = any(
        block.hold and len(block.slots) == 1 for block in (domain.block_by_name[n] for n, _ in (source, target))
    )
    return waits and (source == target or domain.network.allows(source, target))


def relevant_part(task: Task) -> Task:
    """Return what is left of the task with relevant blocks alone; the task itself if all are.

    Tokens of other classes alone than these blocks ask for are left out; those of no class of their own stay.
    """
    blocks = relevant_blocks(task)
    if len(blocks) == len(task.domain.blocks):
        return task
    asked = {sort for block in blocks for sort in block.roles.values() if not isinstance(sort, SymbolSort)} - {TOKEN}
    named = {name for atom in task.goal for name in atom.arguments} | set(task.assignment)

    def concerns(token: Token) -> bool:
        own = {*token.classes, *token.unknown} - {TOKEN}
        return token.name in named or not own or any(issubclass(one, sort) for one, sort in product(own, asked))

    kept = [token for token in task.tokens if concerns(token)]
    return task.restrict({token.name for token in kept}, domain=domain_part(task, blocks, kept))
