"""The compiler's own predicates about tokens in slots, readers of tokens and unfinished reassignments.

A kind, a block, and slots or targets of the block identify each predicate. All of these form the PDDL name.
"""

from collections.abc import Iterator

from hybrid_tamp.model.affordance import TOKEN, ObjectClass
from hybrid_tamp.model.block import Block, Target
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.predicate import SymbolSort

State = tuple[str, ...]
"""Key of a compiler predicate: its kind, the name of its block, and the names of the block's slots or targets."""

COUNT = "how many"
"""Type of the constants that stand for numbers of readers."""
ROOT = "object"
"""Root of all types, including places."""

Sort = type[ObjectClass] | SymbolSort | str
"""Class, sort or type of a parameter. A string is `COUNT` or `ROOT`."""


def assignment_predicates(domain: Domain) -> Iterator[tuple[State, tuple[tuple[str, Sort], ...]]]:
    """Yield each compiler predicate as a pair of (key, typed parameters)."""
    yield ("idle",), ()
    for name in ("settled", "unclaimed", "completed"):
        yield (name,), (("token", TOKEN),)
    yield ("readers",), (("token", TOKEN), ("count", COUNT))
    yield ("next",), (("count", COUNT), ("more", COUNT))
    yield ("distinct",), (("one", ROOT), ("other", ROOT))
    for block in domain.blocks:
        yield from _block_predicates(domain, block)


def _block_predicates(domain: Domain, block: Block) -> Iterator[tuple[State, tuple[tuple[str, Sort], ...]]]:
    anchor = ("anchor", block.roles[block.anchor])

    def targets(slot: str) -> Iterator[tuple[str, Sort]]:
        return ((target, block.roles[target]) for target in remembered(domain, block, slot))

    yield ("in", block.name), (anchor, *targets(block.anchor))
    for slot in block.others:
        yield ("in", block.name, slot.name), (("token", slot.object_class), anchor, *targets(slot.name))
        for kind in ("claimed", "full", "moved"):
            yield (kind, block.name, slot.name), (anchor,)
    for target in block.targets if block.others else ():
        yield ("for", block.name, target.name), (anchor, ("target", target.sort))
    for rest in remainders(block):
        yield ("leaving", block.name, *rest), (anchor,)


def remainders(block: Block) -> tuple[tuple[str, ...], ...]:
    """Return all non-empty sets of slots without the anchor. Their tokens may remain after the anchor leaves."""
    names = [slot.name for slot in block.others]
    sets: list[tuple[str, ...]] = [()]
    for name in names:
        sets += [(*chosen, name) for chosen in sets]
    return tuple(chosen for chosen in sets if chosen)


def locked_targets(domain: Domain, block: Block) -> tuple[Target, ...]:
    """Return the targets with a property that some block may change while this block reads the property."""

    def written(target: Target) -> bool:
        return any(
            set(block.writes.get(slot.name, ())) & set(target.reads)
            and not isinstance(target.sort, SymbolSort)
            and domain.relations.can_share_token(slot.object_class, target.sort)
            for block in domain.blocks
            for slot in block.slots
        )

    return tuple(target for target in block.targets if written(target))


def remembered(domain: Domain, block: Block, slot: str) -> tuple[str, ...]:
    """Return the targets that an operator must know when the token in a slot leaves.

    When the anchor leaves, the operator releases the locked targets. When any token leaves, the operator deletes the
    maintained exit conditions of the token's slot (see `keeper`).
    """
    locked = {t.name for t in locked_targets(domain, block)} if slot == block.anchor else set()
    targets = {t.name for t in block.targets}
    for literal in block.maintained_exit:
        if keeper(block, literal.arguments) == slot:
            locked |= targets & set(literal.arguments)
    return tuple(t.name for t in block.targets if t.name in locked)


def keeper(block: Block, arguments: tuple[str, ...]) -> str:
    """Return the last slot, other than the anchor, that a condition mentions, or the anchor if there is none."""
    others = [slot.name for slot in block.others if slot.name in arguments]
    return others[-1] if others else block.anchor
