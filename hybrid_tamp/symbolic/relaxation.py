"""Relaxation without deletes, which quickly proves that some planning problems have no plan."""

from collections import defaultdict

from hybrid_tamp.symbolic.engines.plain import lineage, without_impossible
from hybrid_tamp.symbolic.pddl.joins import Binding, FactIndex, bind_condition, join
from hybrid_tamp.symbolic.pddl.operators import Fact, Operator, PlanningProblem, ground


def may_be_solvable(problem: PlanningProblem) -> bool:
    """Return whether the goal is reachable if no fact is ever deleted. If False, the problem has no plan."""
    return reachable(problem).issuperset(problem.goal)


def reachable(problem: PlanningProblem) -> set[Fact]:
    """Return the facts that are reachable if no fact is ever deleted. The search stops when the goal is reached.

    Each new fact is matched with every precondition on the same predicate. Then the other preconditions of the same
    operator are joined with the known facts.
    """
    smaller = without_impossible(problem)
    known = FactIndex(smaller.init)
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


class _Lifted:
    """An operator with its preconditions and the possible values of its parameters."""

    def __init__(self, operator: Operator, problem: PlanningProblem) -> None:
        self.conditions = operator.precondition
        self._effects = operator.add
        things = sorted((*problem.domain.constants, *problem.objects))
        self._ranges = {
            variable: dict.fromkeys(name for name, own in things if wide in lineage(own, dict(problem.domain.types)))
            for variable, wide in operator.parameters
        }
        self._added = {argument for fact in operator.add for argument in fact[1:] if argument.startswith("?")}

    def list_added(self, condition: Fact | None, fact: Fact, known: FactIndex) -> list[Fact]:
        """Return the new facts that the operator can add. `fact` satisfies the precondition `condition`, if given."""
        bound = bind_condition(condition, fact, {}, self._ranges) if condition else {}
        if bound is None:
            return []
        found: set[Fact] = set()

        def adds_nothing(binding: Binding) -> bool:
            effects = (ground(each, binding) for each in self._effects)
            return self._added <= binding.keys() and all(each in known.facts or each in found for each in effects)

        rest = [each for each in self.conditions if each is not condition]
        for whole in join(rest, bound, known, self._ranges, adds_nothing):
            found.update(ground(each, whole) for each in self._effects)
        return sorted(found - known.facts)
