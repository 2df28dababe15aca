"""What can be reached in a planning problem if nothing is ever deleted: a quick test that can only prove 'no'."""

from collections import defaultdict
from collections.abc import Iterator
from itertools import product

from hybrid_tamp.symbolic.engines.plain import lineage, without_impossible
from hybrid_tamp.symbolic.pddl.operators import Fact, Operator, PlanningProblem, ground

Binding = dict[str, str]


def may_be_solvable(problem: PlanningProblem) -> bool:
    """Say whether the goal can be reached if nothing is ever deleted; if it cannot, there is no plan."""
    return reachable(problem).issuperset(problem.goal)


def reachable(problem: PlanningProblem) -> set[Fact]:
    """Return every fact that can be brought about if nothing is ever deleted, up to the goal if that is among them.

    Each new fact is put in place of every condition that it may meet, and the operator's other conditions are joined,
    the one with the fewest facts first.
    """
    smaller = without_impossible(problem)
    known = _Known(smaller.init)
    changing = {fact[0] for operator in smaller.domain.operators for fact in operator.add}
    waiting: defaultdict[str, list[tuple[_Lifted, Fact]]] = defaultdict(list)
    fresh = [fact for fact in smaller.init if fact[0] in changing]
    for operator in (_Lifted(each, smaller) for each in smaller.domain.operators):
        conditions = [fact for fact in operator.conditions if fact[0] in changing]
        for fact in conditions:
            waiting[fact[0]].append((operator, fact))
        if not conditions:
            fresh += [fact for fact in operator.list_added(None, (), known) if known.add(fact)]
    wanted = set(problem.goal)
    while fresh and not known.facts.issuperset(wanted):
        fact = fresh.pop()
        for operator, condition in waiting[fact[0]]:
            fresh += [more for more in operator.list_added(condition, fact, known) if known.add(more)]
    return known.facts


class _Known:
    """Facts, found by their predicate and one argument.

    Attributes:
        facts: all of them.
    """

    def __init__(self, facts: tuple[Fact, ...]) -> None:
        self.facts: set[Fact] = set()
        self._rows: defaultdict[str, list[Fact]] = defaultdict(list)
        self._by_argument: defaultdict[tuple[str, int, str], list[Fact]] = defaultdict(list)
        for fact in facts:
            self.add(fact)

    def add(self, fact: Fact) -> bool:
        """Take a fact in, and say whether it is new."""
        if fact in self.facts:
            return False
        self.facts.add(fact)
        self._rows[fact[0]].append(fact)
        for place, argument in enumerate(fact[1:], start=1):
            self._by_argument[fact[0], place, argument].append(fact)
        return True

    def rows(self, fact: Fact) -> list[Fact]:
        """Return the facts that may be instances of a fact with variables, by its predicate or a known argument."""
        known = [
            self._by_argument[fact[0], place, argument]
            for place, argument in enumerate(fact[1:], start=1)
            if argument[0] != "?"
        ]
        return min((self._rows[fact[0]], *known), key=len)


class _Lifted:
    """An operator and what its parameters may be.

    Attributes:
        conditions: its conditions.
    """

    def __init__(self, operator: Operator, problem: PlanningProblem) -> None:
        self.conditions = operator.precondition
        self._operator = operator
        things = (*problem.domain.constants, *problem.objects)
        self._fitting = {
            variable: frozenset(name for name, own in things if wide in lineage(own, dict(problem.domain.types)))
            for variable, wide in operator.parameters
        }
        self._added = {argument for fact in operator.add for argument in fact[1:] if argument[0] == "?"}

    def list_added(self, condition: Fact | None, fact: Fact, known: _Known) -> list[Fact]:
        """Return what is new of what the operator adds where a fact meets one of its conditions."""
        bound = self._match(condition, fact, {}) if condition else {}
        if bound is None:
            return []
        rest = [each for each in self.conditions if each is not condition]
        found: set[Fact] = set()
        for whole in self._join(bound, rest, known, found):
            found.update(ground(each, whole) for each in self._operator.add)
        return sorted(found - known.facts)

    def _join(self, bound: Binding, conditions: list[Fact], known: _Known, found: set[Fact]) -> Iterator[Binding]:
        """Yield the bindings with which all conditions hold, but for such as add nothing new."""
        if self._added <= bound.keys():
            effects = {ground(each, bound) for each in self._operator.add}
            if all(effect in known.facts or effect in found for effect in effects):
                return
        if not conditions:
            yield from self._complete(bound)
            return
        rows, chosen = min(
            ((known.rows(ground(each, bound)), each) for each in conditions), key=lambda one: len(one[0])
        )
        rest = [each for each in conditions if each is not chosen]
        for row in tuple(rows):
            more = self._match(chosen, row, bound)
            if more is not None:
                yield from self._join(more, rest, known, found)

    def _match(self, condition: Fact, row: Fact, bound: Binding) -> Binding | None:
        """Return the binding, extended so that a condition becomes a fact, or None."""
        more = dict(bound)
        for argument, value in zip(condition[1:], row[1:], strict=True):
            if argument[0] != "?":
                if argument != value:
                    return None
            elif more.setdefault(argument, value) != value or value not in self._fitting[argument]:
                return None
        return more

    def _complete(self, bound: Binding) -> Iterator[Binding]:
        free = [variable for variable in self._fitting if variable not in bound]
        for values in product(*(sorted(self._fitting[variable]) for variable in free)):
            yield bound | dict(zip(free, values, strict=True))
