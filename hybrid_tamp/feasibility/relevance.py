"""The blocks that are relevant to a goal, regardless of the tokens, and the restriction of a task to these blocks.

The search goes backwards from the goal. A block is relevant if it changes an atom in the goal or in the entry
conditions of a relevant block. A block is also relevant if tokens may have to pass through it between relevant blocks.
If a task has a plan, the task also has a plan with relevant blocks only: instead of passing through an irrelevant
block, a token waits in its slot or moves directly to its next slot.
"""

from collections.abc import Callable, Collection, Iterable, Iterator, Set
from dataclasses import replace
from itertools import product

from hybrid_tamp.model.affordance import TOKEN, ObjectClass
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.making_way import makes_way
from hybrid_tamp.model.network import SlotName
from hybrid_tamp.model.predicate import Literal, SymbolSort
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token

Classes = tuple[type[ObjectClass], ...]
Pattern = tuple[str, tuple[Classes, ...]]
"""Pair of (predicate, possible classes of each argument). An argument that is a symbol has no classes."""


def restrict_domain(task: Task, blocks: Collection[Block], tokens: Iterable[Token]) -> Domain:
    """Return the domain restricted to the given blocks. Classes and predicates that nothing refers to are removed."""
    domain = task.domain
    mentioned = {
        literal.predicate.name for block in blocks for literal in (*block.entry, *block.exit, *block.invariants)
    }
    mentioned |= {atom.predicate for atom in task.goal}
    predicates = tuple(predicate for predicate in domain.predicates if predicate.name in mentioned)
    sorts = {sort for block in blocks for sort in block.roles.values()}
    sorts |= {parameter.sort for predicate in predicates for parameter in predicate.parameters}
    members = {sort for sort in sorts if not isinstance(sort, SymbolSort)}
    members |= {member for token in tokens for member in token.classes}
    above = {each for member in members for each in member.__mro__}
    return replace(
        domain,
        classes=tuple(each for each in domain.classes if each in above),
        predicates=predicates,
        blocks=tuple(blocks),
        network=domain.network.restrict({block.name for block in blocks}),
        sorts=(),
        disjoint=tuple(tuple(member for member in group if member in above) for group in domain.disjoint),
        reduced=True,
    )


def find_relevant_blocks(task: Task) -> tuple[Block, ...]:
    """Return the blocks that a plan for the task may need, in the domain's order. The resting block is included."""
    domain = task.domain
    kept = {domain.resting, *task.assignment.values()}
    wanted = set(_goal_patterns(task))
    more = kept
    while more:
        kept = _with_serving(domain, kept | more, wanted)
        # This step comes last because it examines only paths that avoid the relevant blocks.
        more = _on_the_way(domain, kept)
    return tuple(block for block in domain.blocks if block.name in kept)


def _goal_patterns(task: Task) -> Iterator[Pattern]:
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


def _pattern(block: Block, literal: Literal) -> Pattern:
    return (literal.predicate.name, tuple(_of_sort(block.roles.get(argument)) for argument in literal.arguments))


def _of_sort(sort: type[ObjectClass] | SymbolSort | None) -> Classes:
    return () if sort is None or isinstance(sort, SymbolSort) else (sort,)


def _with_serving(domain: Domain, kept: Set[str], wanted: Set[Pattern]) -> set[str]:
    """Return the given blocks and, recursively, all blocks that change an atom that these blocks or the goal need."""
    found, before = set(kept), set[str]()
    while found != before:
        before = set(found)
        blocks = [domain.block_by_name[name] for name in found]
        every = wanted | {_pattern(block, literal) for block in blocks for literal in block.changing_entry}
        found |= {block.name for block in domain.blocks if block.name not in found and _serves(domain, block, every)}
    return found


def _serves(domain: Domain, block: Block, wanted: Collection[Pattern]) -> bool:
    """Say whether a block may change an atom that matches one of the patterns.

    Two patterns match if, for each argument, one token can belong to the classes of both patterns. A block that only
    moves a token along a path brings the token from rest to rest, so it changes no atom.
    """
    if makes_way(block):
        return False

    def can_be_one(one: Classes, other: Classes) -> bool:
        return all(domain.relations.can_share_token(a, b) for a, b in product(one, other))

    return any(
        name == wanted_name and all(map(can_be_one, changed, classes))
        for name, changed in (_pattern(block, literal) for literal in block.exit)
        for wanted_name, classes in wanted
    )


def _on_the_way(domain: Domain, kept: Collection[str]) -> set[str]:
    """Return the blocks, other than `kept`, through which tokens may have to pass between slots of `kept`."""
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
    """Return the slots that can be reached from a slot without passing through a kept block."""
    found: set[SlotName] = set()
    waiting = [end]
    while waiting:
        new = [slot for slot in step(waiting.pop()) if slot[0] not in kept and slot not in found]
        found.update(new)
        waiting += new
    return found


def _passed_by(domain: Domain, source: SlotName, target: SlotName) -> bool:
    """Say whether a token can move from `source` directly to `target` and wait indefinitely in one of the two slots."""
    waits = any(
        block.hold and len(block.slots) == 1 for block in (domain.block_by_name[n] for n, _ in (source, target))
    )
    return waits and (source == target or domain.network.allows(source, target))


def keep_relevant(task: Task) -> Task:
    """Return the task restricted to its relevant blocks, or the task itself if all blocks are relevant.

    A token is kept if the goal or the assignment names the token, or if `TOKEN` is its only class. All other tokens are
    kept only if a relevant block has a role for one of their classes.
    """
    blocks = find_relevant_blocks(task)
    if len(blocks) == len(task.domain.blocks):
        return task
    asked = {sort for block in blocks for sort in block.roles.values() if not isinstance(sort, SymbolSort)} - {TOKEN}
    named = {name for atom in task.goal for name in atom.arguments} | set(task.assignment)

    def concerns(token: Token) -> bool:
        own = {*token.classes, *token.unknown} - {TOKEN}
        return token.name in named or not own or any(issubclass(one, sort) for one, sort in product(own, asked))

    kept = [token for token in task.tokens if concerns(token)]
    return task.restrict({token.name for token in kept}, domain=restrict_domain(task, blocks, kept))
