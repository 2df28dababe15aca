"""Composition of blocks in series into one block.

Deletes are applied before adds, and a fact holds until a block deletes the fact. At least one block of a series has all
roles of the series, so the series has no more parameters than its largest block. No token has two roles.
"""

from collections.abc import Iterable, Mapping

from hybrid_tamp.model.affordance import TOKEN, is_place
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.predicate import ANY, Literal, SymbolSort
from hybrid_tamp.symbolic.chaining.series import Link, Series, Sort, key
from hybrid_tamp.symbolic.pddl.naming import unused


def begin_series(block: Block, taken: Iterable[str] = ()) -> Series:
    """Return a series of one block.

    Args:
        block: First block of the series.
        taken: Names that no role may have. These are the symbols in the conditions of later blocks.
    """
    roles: dict[str, str] = {}
    for role in block.roles:
        roles[role] = unused(role, {*taken, *roles.values()})
    link = Link(block, roles)
    sorts = {roles[role]: sort for role, sort in block.roles.items()}
    held = [literal for literal in link.entry if _lasting(literal) and not _undone(literal, link.exit, sorts)]
    known = (*held, *(literal for literal in link.exit if literal.positive))
    return Series((link,), sorts, link.entry, link.exit, tuple(dict.fromkeys(known)))


def _lasting(literal: Literal) -> bool:
    """Return whether an entry condition still holds after the block unless an effect deletes the condition."""
    return literal.positive and literal.predicate.measured


def extend_series(series: Series, block: Block, slots: Mapping[str, str], taken: Iterable[str] = ()) -> Series | None:
    """Return the series with one more block, or None if the block cannot be appended.

    The series must achieve the changing entry conditions of the next block. A new feasibility condition of the next
    block becomes an entry condition of the series. This is allowed only if no earlier block has a hold. Otherwise,
    plans would be lost in which the tokens stay in the earlier block and cannot enter the next block.

    Args:
        series: Series to extend.
        block: Next block.
        slots: Maps each slot of the next block to a slot of the last block of the series.
        taken: Names that no role may have.
    """
    roles = _determined(series, block, {slot: series.last.roles[before] for slot, before in slots.items()})
    fresh = [target.name for target in block.targets if target.name not in roles]
    if fresh and not set(series.sorts) <= set(roles.values()):
        return None  # The composed block would have too many parameters. Two separate blocks are planned faster.
    for target in fresh:
        roles[target] = unused(target, {*taken, *series.sorts, *roles.values()})
    link = Link(block, roles)
    sorts = _narrowed(series, link, fresh)
    asked = [literal for literal in link.entry if literal not in series.known]
    new = [literal for literal in asked if literal not in series.entry]
    if sorts is None or _twice(link) or not all(literal.predicate.static for literal in asked):
        return None
    if (new or sorts != series.sorts) and any(earlier.block.hold for earlier in series.links):
        return None
    exits = _composed(series, link, sorts)
    if exits is None:
        return None
    known = [literal for literal in series.known if _lasting(literal) and not _undone(literal, link.exit, sorts)]
    known += [literal for literal in link.exit if literal.positive]
    return Series((*series.links, link), sorts, (*series.entry, *new), exits, tuple(dict.fromkeys(known)), series)


def _twice(link: Link) -> bool:
    """Return whether one token would fill two roles of the block."""
    tokens = [role for own, role in link.roles.items() if not isinstance(link.block.roles[own], SymbolSort)]
    return len(set(tokens)) < len(tokens)


def _determined(series: Series, block: Block, roles: Mapping[str, str]) -> dict[str, str]:
    """Return the given roles, extended by each target that a known fact determines (see `_pins`)."""
    found = dict(roles)
    targets = {target.name for target in block.targets}
    progress = True
    while progress:
        progress = False
        for wanted in block.entry:
            open_roles = [a for a in wanted.arguments if a in targets and a not in found]
            if not open_roles or not wanted.positive or not _pins(wanted, open_roles):
                continue
            facts = [fact for fact in series.known if _agrees(fact, wanted, found, open_roles)]
            if len(facts) == 1:
                pairs = zip(wanted.arguments, facts[0].arguments, strict=True)
                found.update({mine: theirs for mine, theirs in pairs if mine in open_roles})
                progress = True
    return found


def _pins(wanted: Literal, open_roles: list[str]) -> bool:
    """Return whether a fact that matches `wanted` determines the open roles. For most predicates, several may match."""
    index = wanted.predicate.functional_index
    return wanted.predicate.maintained or (index is not None and open_roles == [wanted.arguments[index]])


def _agrees(fact: Literal, wanted: Literal, roles: Mapping[str, str], open_roles: list[str]) -> bool:
    return fact.predicate is wanted.predicate and all(
        mine in open_roles or roles.get(mine, mine) == theirs
        for mine, theirs in zip(wanted.arguments, fact.arguments, strict=True)
    )


def _narrowed(series: Series, link: Link, fresh: Iterable[str]) -> dict[str, Sort] | None:
    """Return the classes of the roles, narrowed as the link requires, or None if two classes are not nested."""
    sorts = {**series.sorts, **{link.roles[target]: link.block.roles[target] for target in fresh}}
    for own, role in link.roles.items():
        asked = link.block.roles[own]
        if role not in sorts:
            continue  # The role is a symbol.
        if within(asked, sorts[role]):
            sorts[role] = asked
        elif not within(sorts[role], asked):
            return None
    return sorts


def within(one: Sort, other: Sort) -> bool:
    """Return whether every member of one class or sort is a member of the other."""
    if isinstance(one, SymbolSort) or isinstance(other, SymbolSort):
        return one is other
    return issubclass(one, other) or (other is TOKEN and not is_place(one))


def _composed(series: Series, link: Link, sorts: Mapping[str, Sort]) -> tuple[Literal, ...] | None:
    """Return the exit conditions of the extended series, or None if these depend on whether two symbols are equal."""
    kept: list[Literal] = []
    for literal in series.exit:
        if literal.predicate.maintained:
            continue  # A maintained fact ends when its tokens leave.
        later = [each for each in link.exit if each.predicate is literal.predicate and _meets(each, literal, sorts)]
        functional = literal.predicate.functional_index is not None
        if any(key(each) != key(literal) and (functional or each.positive != literal.positive) for each in later):
            return None
        if not any(key(each) == key(literal) for each in later):
            kept.append(literal)
    return tuple(dict.fromkeys((*kept, *link.exit)))


def _undone(fact: Literal, exits: Iterable[Literal], sorts: Mapping[str, Sort]) -> bool:
    """Return whether one of the exit conditions may delete the fact."""
    return any(
        each.predicate is fact.predicate
        and (not each.positive or each.predicate.functional_index is not None)
        and _meets(each, fact, sorts)
        for each in exits
    )


def _meets(one: Literal, other: Literal, sorts: Mapping[str, Sort]) -> bool:
    """Return whether two literals of a series may have equal arguments, except for the functional argument."""
    return all(
        mine == theirs or ANY in (mine, theirs) or _may_be(mine, theirs, sorts)
        for mine, theirs in zip(key(one), key(other), strict=True)
    )


def _may_be(one: str, other: str, sorts: Mapping[str, Sort]) -> bool:
    """Return whether two different arguments may be the same symbol. Two roles never share a token."""
    return any(isinstance(sorts.get(argument), SymbolSort) for argument in (one, other))
