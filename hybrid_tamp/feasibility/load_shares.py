"""Reasons why a block is impossible because too few tokens meet a feasibility condition.

A block may require the same condition of several tokens at once. If these tokens bear a load together, the domain
declares the share of each token (`Predicate.share`), and each token must bear its own share. For example, two hands
that squeeze an object push against each other, so together they bear twice the load of the weaker hand.
"""

from collections.abc import Iterable
from math import ceil
from typing import NamedTuple

from hybrid_tamp.feasibility.bindings import Bound, complete, find_feasible
from hybrid_tamp.feasibility.mode_names import BLOCK
from hybrid_tamp.feasibility.safety_figures import describe_shortfall, evaluate_share, with_unit
from hybrid_tamp.model.bindings import Choices, enumerate_bindings
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.explanation import Reason
from hybrid_tamp.model.facts import StaticFacts
from hybrid_tamp.model.predicate import Literal, Value, name_of
from hybrid_tamp.model.safety import with_factor
from hybrid_tamp.model.task import Task

_MANY = 100

_Group = list[tuple[Literal, str]]
"""Pairs of (literal, slot) that state the same condition for slots of one class. The slot '' means no slot."""


class _Candidate(NamedTuple):
    """A token's largest margin of a condition, and the binding with this margin."""

    margin: float
    literal: Literal
    slot: str
    bound: Bound


def explain_unmet(
    task: Task, facts: StaticFacts, block: Block, conditions: Iterable[Literal], allowed: Choices, alike: bool = False
) -> list[Reason]:
    """Return a reason for every condition that too few tokens meet, regardless of the other conditions.

    Args:
        task: the task.
        facts: feasibility facts of the task.
        block: the block.
        conditions: feasibility conditions of the block.
        allowed: maps each role to the values that it may have.
        alike: whether to ignore conditions that apply to a single slot.
    """
    found = []
    for group in _group(block, conditions):
        places = _count_places(group)
        ranked = _rank(facts, group, allowed)
        # One token per slot must meet the condition.
        best = ranked[:places]
        if best and best[-1].margin < 0 and (places > 1 or not alike):
            found.append(_reason(task, block, group, best, len(ranked)))
    return found


def find_best_choice(
    facts: StaticFacts, conditions: tuple[Literal, ...], allowed: Choices
) -> tuple[Literal, Bound, float]:
    """Return the first condition that contradicts the preceding conditions, with its best binding and margin.

    The best binding meets the preceding conditions and has the largest margin of the contradicting condition.
    """
    met: tuple[Literal, ...] = ()
    for literal in conditions:
        # The conditions in `met` can be met together.
        if not find_feasible(facts, (*met, literal), allowed):
            roles = {role: values for role, values in allowed.items() if role in literal.arguments}
            bounds = complete(find_feasible(facts, met, allowed), roles)
            margin, _, bound = max(
                (facts.margin(literal, bound), -number, bound) for number, bound in enumerate(bounds)
            )
            return literal, bound, margin
        met = (*met, literal)
    raise ValueError("expected conditions that cannot all be met at once")


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
    """Return the best candidate of each token that could fill a slot of the group, in order of decreasing margin."""
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
    message += f"({_describe_margin(task, literal, bound, margin)})"
    meeting = [name_of(one.bound[one.slot]) for one in best if one.margin >= 0 and one.slot]
    if meeting:
        verb = "does" if len(meeting) == 1 else "do"
        message += f"; {_count_places(group)} tokens must meet this condition, but only {', '.join(meeting)} {verb}"
    if predicate.share is not None:
        message += f": {_describe_load(task, group, best, candidates)}"
    return Reason((), block.name, "not_feasible", message, atom, margin, predicate.unit)


def _describe_margin(task: Task, literal: Literal, bound: Bound, margin: float) -> str:
    if literal.predicate.share is not None:  # The description of the load has both figures.
        return f"off by {with_unit(-margin, literal.predicate.unit)}"
    values = tuple(bound.get(argument, argument) for argument in literal.arguments)
    return describe_shortfall(task, literal.predicate, values, margin)


def _describe_load(task: Task, group: _Group, best: list[_Candidate], candidates: int) -> str:
    """Describe the load and what each token can bear. If no token can bear its share, say how many would suffice."""
    literal, places = group[0][0], _count_places(group)
    unit = literal.predicate.unit
    shares = [_share(task, one) for one in best]
    wanted, sum_there = max(need for _, need, _ in shares), sum(has for _, _, has in shares)
    short = places > 1 and sum_there < places * wanted
    said = f"each of {places} tokens must bear " if places > 1 else "the token must bear "
    said += with_unit(wanted, unit) + (f" ({with_unit(places * wanted, unit)} in total)" if short else "")
    best_of = f"the best {len(shares)} of {candidates} tokens" if candidates > len(shares) else "the tokens"
    said += f", but {best_of} can bear " + ", ".join(f"{with_unit(has, unit)} ({name})" for name, _, has in shares)
    if short:
        said += f" and {with_unit(sum_there, unit)} in total"
    safety = literal.predicate.safety
    if safety is not None and safety.factor > 1.0:
        figures = [_share(task, one, 1.0)[-1] for one in best]
        without = [sum(figures)] if short else list(dict.fromkeys(figures))
        said += (
            f" with safety factor {safety.factor:g}, {' and '.join(with_unit(has, unit) for has in without)} without "
            "the factor"
        )
    name, need, has = shares[-1]
    each = ceil(need / has) if has > 0 else _MANY
    if each >= _MANY or any(one.margin >= 0 for one in best):
        return said
    said += f"; {each * places} tokens like {name} could bear the load"
    if places > 1:
        said += f", {each} for each share"
    most = _count_most_bearers(task, literal)
    return said + (f", but no block of {task.domain.name} uses more than {most} of them" * (each * places > most))


def _share(task: Task, candidate: _Candidate, factor: float | None = None) -> tuple[str, float, float]:
    """Return a triple of (name of the bearing token, its share of the load, load that the token can bear).

    Args:
        task: the task.
        candidate: the token with its best binding.
        factor: safety factor that replaces the factor of the task, or None.
    """
    literal = candidate.literal
    predicate = literal.predicate if factor is None else with_factor(literal.predicate, factor)
    values = [candidate.bound.get(argument, argument) for argument in literal.arguments]
    need, has = evaluate_share(predicate, task.state, values)
    return name_of(values[0]), float(need), float(has)


def _count_most_bearers(task: Task, literal: Literal) -> int:
    """Return the largest number of tokens that share a load in one block of the domain."""
    return max(
        sum(other.predicate is literal.predicate and other.positive for other in block.entry)
        for block in task.domain.blocks
    )
