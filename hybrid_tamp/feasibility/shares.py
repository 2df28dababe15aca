"""Conditions that no choice of tokens meets: of one token, or of as many at once as a block needs.

A load that several tokens bear together is declared as each one's share of it (`Predicate.share`): hands that squeeze
a thing push against each other, so that a pair bears twice what its weaker hand bears, and pooling is fulfilled share
by share.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from math import ceil

from hybrid_tamp.feasibility.bindings import Bound, Margins, completed, feasible
from hybrid_tamp.feasibility.reasons import BLOCK, reason_of
from hybrid_tamp.model.bindings import Choices, enumerate_bindings
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.explanation import Reason
from hybrid_tamp.model.predicate import Literal, Value, name_of
from hybrid_tamp.model.task import Task

_MANY = 100


@dataclass(frozen=True)
class _Shared:
    """One condition on several slots of one class, which different tokens must meet; or on a single one.

    Attributes:
        literals: the condition for each of the slots.
        slots: those slots; empty if the condition is on no slot.
    """

    literals: tuple[Literal, ...]
    slots: tuple[str, ...]


def failing(
    margins: Margins, block: Block, literals: Iterable[Literal], allowed: Choices, *, alike: bool = False
) -> list[Reason]:
    """Return a reason for every condition that too few tokens meet, whatever the other conditions are.

    Args:
        margins: the margins of the task's facts.
        block: the block.
        literals: its feasibility conditions.
        allowed: what each role may be.
        alike: whether only those count that are asked alike of several slots.
    """
    found = []
    for shared in _grouped(block, literals):
        if alike and len(shared.slots) < 2:
            continue
        ranked = _ranked(margins, shared, allowed)
        # As many tokens must meet it as there are slots.
        best = ranked[: max(1, len(shared.slots))]
        if best and best[-1][0] < 0:
            found.append(_reason(margins, block, shared, best, len(ranked)))
    return found


def best_choice(margins: Margins, literals: tuple[Literal, ...], allowed: Choices) -> tuple[Literal, Bound, float]:
    """Return the condition that fails, by how much, in the binding in which the worst condition fails least."""
    met: tuple[Literal, ...] = ()
    for literal in literals:
        # The conditions are met together up to the one that leaves no choice.
        if not feasible(margins, (*met, literal), allowed):
            roles = {role: values for role, values in allowed.items() if role in literal.arguments}
            bounds = completed(feasible(margins, met, allowed), roles)
            margin, _, bound = max((margins.of(literal, bound), -number, bound) for number, bound in enumerate(bounds))
            return literal, bound, margin
        met = (*met, literal)
    raise ValueError("all conditions can be met")


def _grouped(block: Block, literals: Iterable[Literal]) -> Iterator[_Shared]:
    """Put together what is asked alike of several slots of one class."""
    groups: dict[object, list[tuple[Literal, str]]] = {}
    classes = {slot.name: slot.object_class for slot in block.slots}
    for literal in literals:
        slot = next((role for role in literal.arguments if role in classes), "")
        rest = tuple("" if role == slot else role for role in literal.arguments)
        groups.setdefault((literal.predicate, literal.positive, rest, classes.get(slot)), []).append((literal, slot))
    for members in groups.values():
        yield _Shared(tuple(one for one, _ in members), tuple(slot for _, slot in members if slot))


def _ranked(margins: Margins, shared: _Shared, allowed: Choices) -> list[tuple[float, Bound]]:
    """Return the best margin of each token that could be in one of the slots, the largest first."""
    best: dict[Value, tuple[float, Bound]] = {}
    for literal, slot in zip(shared.literals, shared.slots or ("",) * len(shared.literals), strict=False):
        choices = {role: allowed[role] for role in literal.arguments if role in allowed}
        for bound in enumerate_bindings(choices):
            margin, bearer = margins.of(literal, bound), bound.get(slot, "")
            if bearer not in best or margin > best[bearer][0]:
                best[bearer] = (margin, bound)
    return sorted(best.values(), key=lambda one: -one[0])


def _reason(
    margins: Margins, block: Block, shared: _Shared, ranked: list[tuple[float, Bound]], candidates: int
) -> Reason:
    margin, bound = ranked[-1]
    *_, literal = _literals(shared, ranked)
    predicate, atom = literal.predicate, literal.ground(bound)
    message = f"{BLOCK} is impossible: {predicate.sentence(atom.arguments, not literal.positive)} "
    message += f"(off by {amount(-margin, predicate.unit)})"
    meeting = [
        name_of(one[slot])
        for (met, one), slot in ((each, _slot(shared, each[1])) for each in ranked)
        if met >= 0 and slot in one
    ]
    if meeting:
        message += f"; {len(shared.slots)} at once must meet it, and only {', '.join(meeting)} does"
    if predicate.share is not None:
        message += f": {_pooled(margins.task, shared, ranked, candidates)}"
    return reason_of(block, "not_feasible", message, atom, margin, predicate.unit)


def amount(number: float, unit: str) -> str:
    """Return a number with its unit."""
    return f"{number:.4g}" if unit == "1" else f"{number:.4g} {unit}"


def _pooled(task: Task, shared: _Shared, ranked: list[tuple[float, Bound]], candidates: int) -> str:
    """Say what is wanted and what is there and, where no token bears its share, how many would do together."""
    literal, places = shared.literals[0], max(1, len(shared.slots))
    unit = literal.predicate.unit
    shares = [_share(task, one, bound) for one, (_, bound) in zip(_literals(shared, ranked), ranked, strict=True)]
    wanted, sum_there = max(need for _, need, _ in shares), sum(has for _, _, has in shares)
    short = sum_there < places * wanted
    said = f"it takes {amount(wanted, unit)}"
    if places > 1:
        said += f" from each of {places}" + (f", {amount(places * wanted, unit)} together" if short else "")
    said += f", and the best {len(shares)} of {candidates} have " if candidates > len(shares) else ", and there is "
    said += ", ".join(f"{amount(has, unit)} ({name})" for name, _, has in shares)
    if places > 1 and short:
        said += f", {amount(sum_there, unit)} together"
    name, need, has = shares[-1]
    each = ceil(need / has) if has > 0 else _MANY
    if each >= _MANY or any(margin >= 0 for margin, _ in ranked):
        return said
    most = _most_at_once(task, literal)
    if places > 1:
        said += f"; pooled, {each * places} like {name} would bear it, {each} in each place"
    else:
        said += f"; pooled, {each} like {name} would bear it"
    return said + (f", but no block of {task.domain.name} takes more than {most} at once" * (each * places > most))


def _literals(shared: _Shared, ranked: list[tuple[float, Bound]]) -> Iterator[Literal]:
    for _, bound in ranked:
        # Arguments that are no roles are symbols, so the slot tells which literal it is.
        yield next(one for one in shared.literals if not shared.slots or _slot(shared, bound) in one.arguments)


def _slot(shared: _Shared, bound: Bound) -> str:
    return next((slot for slot in shared.slots if slot in bound), "")


def _share(task: Task, literal: Literal, bound: Bound) -> tuple[str, float, float]:
    """Return who bears a share, the share and what they can bear."""
    assert literal.predicate.share is not None
    values = [bound.get(argument, argument) for argument in literal.arguments]
    need, has = literal.predicate.share(task.state, *values)
    return name_of(values[0]), float(need), float(has)


def _most_at_once(task: Task, literal: Literal) -> int:
    """Return in how many slots of one block the tokens share a load at most."""
    return max(
        sum(other.predicate is literal.predicate and other.positive for other in block.entry)
        for block in task.domain.blocks
    )
