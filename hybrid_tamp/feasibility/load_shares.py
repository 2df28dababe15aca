"""Conditions that no choice of tokens meets: of one token, or of as many at once as a block needs.

If several tokens bear a load together, the domain declares the share of each (`Predicate.share`). Hands that squeeze an
object push against each other, so a pair bears twice what its weaker hand bears. The load is borne if each token
bears its share.
"""

from collections.abc import Iterable
from math import ceil
from typing import NamedTuple

from hybrid_tamp.feasibility.bindings import Bound, complete, find_feasible
from hybrid_tamp.feasibility.mode_names import BLOCK
from hybrid_tamp.model.bindings import Choices, enumerate_bindings
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.explanation import Reason
from hybrid_tamp.model.facts import StaticFacts
from hybrid_tamp.model.predicate import Literal, Value, name_of
from hybrid_tamp.model.task import Task

_MANY = 100

_Group = list[tuple[Literal, str]]
"""A condition that a block makes alike on several slots of one class: the literal for each slot, and the slot or ''."""


class _Candidate(NamedTuple):
    """The largest margin of a condition that one token can have, and the binding that gives it."""

    margin: float
    literal: Literal
    slot: str
    bound: Bound


def explain_unmet(
    task: Task, facts: StaticFacts, block: Block, conditions: Iterable[Literal], allowed: Choices, alike: bool = False
) -> list[Reason]:
    """Return a reason for every condition that too few tokens meet, whatever the other conditions are.

    Args:
        task: the task.
        facts: its feasibility facts.
        block: the block.
        conditions: feasibility conditions of the block.
        allowed: the values that each role may have.
        alike: whether to examine only conditions that several slots share.
    """
    found = []
    for group in _group(block, conditions):
        places = _count_places(group)
        ranked = _rank(facts, group, allowed)
        # As many tokens must meet it as there are slots.
        best = ranked[:places]
        if best and best[-1].margin < 0 and (places > 1 or not alike):
            found.append(_reason(task, block, group, best, len(ranked)))
    return found


def find_best_choice(
    facts: StaticFacts, conditions: tuple[Literal, ...], allowed: Choices
) -> tuple[Literal, Bound, float]:
    """Return the condition that fails, by how much, in the binding in which the worst condition fails least."""
    met: tuple[Literal, ...] = ()
    for literal in conditions:
        # The conditions are met together up to the one that leaves no choice.
        if not find_feasible(facts, (*met, literal), allowed):
            roles = {role: values for role, values in allowed.items() if role in literal.arguments}
            bounds = complete(find_feasible(facts, met, allowed), roles)
            margin, _, bound = max(
                (facts.margin(literal, bound), -number, bound) for number, bound in enumerate(bounds)
            )
            return literal, bound, margin
        met = (*met, literal)
    raise ValueError("all conditions can be met")


def _group(block: Block, conditions: Iterable[Literal]) -> Iterable[_Group]:
    groups: dict[object, _Group] = {}
    classes = {slot.name: slot.object_class for slot in block.slots}
    for literal in conditions:
        slot = next((role for role in literal.arguments if role in classes), "")
        rest = tuple("" if role == slot else role for role in literal.arguments)
        groups.setdefault((literal.predicate, literal.positive, rest, classes.get(slot)), []).append((literal, slot))
    return groups.values()


def _count_places(group: _Group) -> int:
    return max(1, sum(slot != "" for _, slot in group))


def _rank(facts: StaticFacts, group: _Group, allowed: Choices) -> list[_Candidate]:
    """Return the best candidate of each token that could be in one of the slots, the largest margin first."""
    best: dict[Value, _Candidate] = {}
    for literal, slot in group:
        for bound in enumerate_bindings({role: allowed[role] for role in literal.arguments if role in allowed}):
            margin, bearer = facts.margin(literal, bound), bound.get(slot, "")
            if bearer not in best or margin > best[bearer].margin:
                best[bearer] = _Candidate(margin, literal, slot, bound)
    return sorted(best.values(), key=lambda one: -one.margin)


def _reason(task: Task, block: Block, group: _Group, best: list[_Candidate], candidates: int) -> Reason:
    margin, literal, _, bound = best[-1]
    predicate, atom = literal.predicate, literal.ground(bound)
    message = f"{BLOCK} is impossible: {predicate.sentence(atom.arguments, not literal.positive)} "
    message += f"(off by {with_unit(-margin, predicate.unit)})"
    meeting = [name_of(one.bound[one.slot]) for one in best if one.margin >= 0 and one.slot]
    if meeting:
        verb = "does" if len(meeting) == 1 else "do"
        message += f"; {_count_places(group)} at once must meet it, and only {', '.join(meeting)} {verb}"
    if predicate.share is not None:
        message += f": {_describe_load(task, group, best, candidates)}"
    return Reason((), block.name, "not_feasible", message, atom, margin, predicate.unit)


def with_unit(number: float, unit: str) -> str:
    """Return a number with its unit."""
    return f"{number:.4g}" if unit == "1" else f"{number:.4g} {unit}"


def _describe_load(task: Task, group: _Group, best: list[_Candidate], candidates: int) -> str:
    """Say how large the load and the strengths are, and how many tokens would bear it if none bears its share."""
    literal, places = group[0][0], _count_places(group)
    unit = literal.predicate.unit
    shares = [_share(task, one) for one in best]
    wanted, sum_there = max(need for _, need, _ in shares), sum(has for _, _, has in shares)
    short = sum_there < places * wanted
    said = f"it takes {with_unit(wanted, unit)}"
    if places > 1:
        said += f" from each of {places}" + (f", {with_unit(places * wanted, unit)} together" if short else "")
    said += f", and the best {len(shares)} of {candidates} have " if candidates > len(shares) else ", and there is "
    said += ", ".join(f"{with_unit(has, unit)} ({name})" for name, _, has in shares)
    if places > 1 and short:
        said += f", {with_unit(sum_there, unit)} together"
    name, need, has = shares[-1]
    each = ceil(need / has) if has > 0 else _MANY
    if each >= _MANY or any(one.margin >= 0 for one in best):
        return said
    said += f"; pooled, {each * places} like {name} would bear it"
    if places > 1:
        said += f", {each} in each place"
    most = _count_most_bearers(task, literal)
    return said + (f", but no block of {task.domain.name} takes more than {most} at once" * (each * places > most))


def _share(task: Task, candidate: _Candidate) -> tuple[str, float, float]:
    """Return the name of the token that bears a share, the share, and what it can bear."""
    literal = candidate.literal
    assert literal.predicate.share is not None
    values = [candidate.bound.get(argument, argument) for argument in literal.arguments]
    need, has = literal.predicate.share(task.state, *values)
    return name_of(values[0]), float(need), float(has)


def _count_most_bearers(task: Task, literal: Literal) -> int:
    """Return the largest number of tokens that share a load in one block."""
    return max(
        sum(other.predicate is literal.predicate and other.positive for other in block.entry)
        for block in task.domain.blocks
    )
