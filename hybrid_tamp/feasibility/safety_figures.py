"""Feasibility facts that fail only because of a safety factor, and messages about these facts.

The messages state each figure with and without the safety factor.
"""

from collections.abc import Iterable, Iterator, Sequence
from math import degrees

from hybrid_tamp.model.authored import authored
from hybrid_tamp.model.facts import margins
from hybrid_tamp.model.predicate import Atom, Predicate, Value
from hybrid_tamp.model.safety import with_factor
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task


def with_unit(number: float, unit: str) -> str:
    """Return a number with its unit as text. Angles are in degrees."""
    if unit == "rad":
        return f"{degrees(number):.3g} degrees"
    return f"{number:.4g}" if unit == "1" else f"{number:.4g} {unit}"


def evaluate_share(predicate: Predicate, state: State, values: Sequence[Value]) -> tuple[float, float]:
    """Return the share of the load that the first value must bear, and the load that the first value can bear.

    Both loads are in the predicate's unit.

    Raises:
        DomainError: the function `share` of the predicate raised an exception.
    """
    assert predicate.share is not None, "the predicate must have a share"
    roles = {each.name: value for each, value in zip(predicate.parameters, values, strict=True)}
    with authored(f"predicate {predicate.name}", roles):
        need, has = predicate.share(state, *values, **predicate.keywords)
    return need, has


def find_blocked(task: Task) -> list[Atom]:
    """Return the atoms that fail with the safety factors of a task but hold without safety factors."""
    found: list[Atom] = []
    for predicate in task.domain.predicates:
        if predicate.safety is not None and predicate.safety.factor > 1.0:
            bounds = margins(task, task.state, with_factor(predicate, 1.0))
            strict = margins(task, task.state, predicate)
            found += [atom for (atom, margin), (_, bound) in zip(strict, bounds, strict=True) if margin < 0 <= bound]
    return found


def describe_shortfall(task: Task, predicate: Predicate, values: tuple[Value, ...], margin: float) -> str:
    """Return a text with the amount by which a fact fails, with and without the safety factor of the predicate.

    If the predicate has a detail, the text states the detail instead of the amount. If the predicate has a distance,
    the text states the distance and its limit. The text also says whether the fact is a limit of the blocks.
    """
    limit = "; a limit of the available actions, not of physics" if predicate.competence else ""
    off = f"off by {with_unit(abs(margin), predicate.unit)}"
    roles = {each.name: value for each, value in zip(predicate.parameters, values, strict=True)}
    if predicate.detail is not None:
        with authored(f"the detail of {predicate.name}", roles):
            off = predicate.detail(task.state, *values)
    if predicate.distance is not None:
        with authored(f"the distance of {predicate.name}", roles):
            distance = float(predicate.distance(task.state, *values))
        most = with_unit(distance + margin, predicate.unit)
        off = f"{with_unit(distance, predicate.unit)}, but at most {most} are possible"
    if predicate.safety is None or predicate.safety.factor == 1.0:
        return off + limit
    bound = float(with_factor(predicate, 1.0).evaluate(task.state, *values))
    spare = f"{with_unit(abs(bound), predicate.unit)} to spare"
    without = f"off by {with_unit(-bound, predicate.unit)}" if bound < 0 else spare
    return f"{off} with safety factor {predicate.safety.factor:g}, {without} without the factor{limit}"


def describe_blocked(task: Task, atoms: Iterable[Atom]) -> str:
    """Return a sentence for each group of facts that fail only because of a safety factor.

    Facts about tokens that bear a load together are one group.
    """
    groups: dict[tuple[str, ...], list[Atom]] = {}
    for atom in sorted(set(atoms)):
        shared = task.domain.predicate_by_name[atom.predicate].share is not None
        groups.setdefault((atom.predicate, *atom.arguments[shared:]), []).append(atom)
    return " ".join(f"{sentence}." for group in groups.values() for sentence in _describe(task, group))


def _describe(task: Task, group: list[Atom]) -> Iterator[str]:
    predicate = task.domain.predicate_by_name[group[0].predicate]
    assert predicate.safety is not None, "the predicate must have a safety factor"
    values = [tuple(map(task.value, atom.arguments)) for atom in group]
    named = " and ".join(atom.text for atom in group)
    if predicate.share is None:
        for atom, each in zip(group, values, strict=True):
            margin = float(predicate.evaluate(task.state, *each))
            yield f"{atom.text} is {describe_shortfall(task, predicate, each, margin)}"
        return
    bound = with_factor(predicate, 1.0)
    shares = [evaluate_share(predicate, task.state, each) for each in values]
    without = [evaluate_share(bound, task.state, each) for each in values]
    need, has, most = (sum(figures) for figures in (*zip(*shares, strict=True), [has for _, has in without]))
    bearers = " and ".join(atom.arguments[0] for atom in group)
    verb = "bear" if len(group) > 1 else "bears"
    unit = predicate.unit
    yield (
        f"{named}: {with_unit(need, unit)} needed; {bearers} {verb} {with_unit(has, unit)} with safety factor "
        f"{predicate.safety.factor:g}, {with_unit(most, unit)} without the factor"
    )
