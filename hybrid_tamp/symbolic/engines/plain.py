"""Planning problems in a plain form for engines that do not follow PDDL in two points.

The first point is colliding effects. An operator that deletes ``(inside ?thing ?old)`` and adds ``(inside ?thing
?new)`` changes the same fact twice if ?old equals ?new. In PDDL, the add wins. Some engines delete the fact. Other
engines reject the action, even if both effects are adds. So the plain form has an extra operator for each collision,
with one parameter for both regions and a single effect. If an engine applies the original operator instead, its state
has too few facts. Its plan is still valid, because all conditions and goals are positive.

The second point is preconditions on constants. If no operator changes the fact, some engines treat it as false. So the
plain form omits a precondition that is true, and omits an operator with a precondition that is false.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import combinations

from hybrid_tamp.model.plan import PlannedAction
from hybrid_tamp.symbolic.pddl.operators import Fact, Operator, PlanningProblem

Substitution = Mapping[str, str]
"""Maps each variable to the variable or constant that replaces it."""


@dataclass(frozen=True)
class _Case:
    """An operator for one case of the operator `origin`. `arguments` are the arguments of the original operator."""

    operator: Operator
    origin: str
    arguments: tuple[str, ...]


def without_impossible(source: PlanningProblem) -> PlanningProblem:
    """Return the problem without the operators that can never be applied, e.g. operators on boxes without any box.

    The result also omits unused predicates, their facts and unused constants. Engines would remove these items
    themselves, but would spend time on every operator, and some engines on every object.
    """
    fixed = _Fixed(source)
    domain = source.domain
    operators = tuple(operator for operator in domain.operators if fixed.allow(operator))
    facts = [fact for o in operators for part in (o.precondition, o.add, o.delete) for fact in part]
    used = {fact[0] for fact in (*facts, *source.goal)}
    init = tuple(fact for fact in source.init if fact[0] in used)
    named = {argument for fact in (*facts, *init, *source.goal) for argument in fact[1:]}
    parents = dict(domain.types)
    ranged = {name for operator in operators for _, name in operator.parameters}
    smaller = replace(
        domain,
        operators=operators,
        predicates=tuple(predicate for predicate in domain.predicates if predicate[0] in used),
        constants=tuple((c, t) for c, t in domain.constants if c in named or ranged & set(lineage(t, parents))),
    )
    return replace(source, domain=smaller, init=init)


def lineage(name: str, parents: Mapping[str, str]) -> Iterator[str]:
    """Yield a type and its ancestors."""
    yield name
    while name in parents:
        name = parents[name]
        yield name


class _Fixed:
    """The facts of predicates that no operator changes."""

    def __init__(self, source: PlanningProblem) -> None:
        domain = source.domain
        self._constants = dict(domain.constants)
        changing = {fact[0] for operator in domain.operators for fact in (*operator.add, *operator.delete)}
        self._rows: dict[str, list[Fact]] = {name: [] for name, _ in domain.predicates if name not in changing}
        for fact in source.init:
            self._rows.get(fact[0], []).append(fact)

    def settle(self, fact: Fact) -> bool:
        """Return whether a fact has only constants as arguments and the same truth value in all states."""
        return fact[0] in self._rows and all(argument in self._constants for argument in fact[1:])

    def allow(self, operator: Operator) -> bool:
        """Return whether each precondition that no operator changes matches at least one initial fact."""
        conditions = [fact for fact in operator.precondition if fact[0] in self._rows]
        return all(any(self._fits(fact, row) for row in self._rows[fact[0]]) for fact in conditions)

    def _fits(self, fact: Fact, row: Fact) -> bool:
        """Return whether the ground fact `row` is an instance of the lifted fact `fact`."""
        values = {constant: constant for constant in self._constants}
        return all(values.setdefault(argument, value) == value for argument, value in zip(fact, row, strict=True))


class PlainProblem:
    """The plain form of a planning problem, in the attribute `problem`."""

    def __init__(self, source: PlanningProblem) -> None:
        domain = source.domain
        self._parents = dict(domain.types)
        self._constants = dict(domain.constants)
        self._fixed = _Fixed(source)
        possible = [self._shorten(operator) for operator in domain.operators if self._fixed.allow(operator)]
        self._cases = {each.name: _Case(each, each.name, tuple(dict(each.parameters))) for each in possible}
        for case in tuple(self._cases.values()):
            self._separate(case)
        operators = tuple(case.operator for case in self._cases.values())
        self.problem = replace(source, domain=replace(domain, operators=operators))

    def original(self, action: PlannedAction) -> PlannedAction:
        """Return the action of the original problem that corresponds to an action of the plain problem."""
        case = self._cases[action.name]
        values = case.operator.bind(action)
        return PlannedAction(case.origin, tuple(values.get(argument, argument) for argument in case.arguments))

    def _shorten(self, operator: Operator) -> Operator:
        """Return the operator without the preconditions that always hold."""
        return replace(operator, precondition=tuple(f for f in operator.precondition if not self._fixed.settle(f)))

    def _separate(self, whole: _Case) -> None:
        """Add the cases of an operator in which effects collide, including cases with several collisions."""
        found = {whole.arguments}
        unexplored = [whole]
        while unexplored:
            case = unexplored.pop()
            for substitution in self._meetings(case.operator):
                narrower = self._narrow(case, substitution)
                if narrower.arguments not in found and self._fixed.allow(narrower.operator):
                    found.add(narrower.arguments)
                    unexplored.append(narrower)
                    shortened = self._shorten(narrower.operator)
                    self._cases[shortened.name] = replace(narrower, operator=shortened)

    def _meetings(self, operator: Operator) -> Iterator[Substitution]:
        """Yield the substitutions that make two effects of an operator change the same fact."""
        types = {**self._constants, **dict(operator.parameters)}
        for one, other in combinations(dict.fromkeys((*operator.add, *operator.delete)), 2):
            substitution = self._unify(one, other, types) if one[0] == other[0] else None
            if substitution is not None:
                yield substitution

    def _unify(self, one: Fact, other: Fact, types: Mapping[str, str]) -> Substitution | None:
        """Return the substitution that makes two facts of one predicate equal, or None if this is impossible."""
        substitution: dict[str, str] = {}
        for pair in zip(one[1:], other[1:], strict=True):
            first, second = (_value(argument, substitution) for argument in pair)
            if first == second:
                continue
            narrow, wide = (second, first) if self._is_narrower(second, first, types) else (first, second)
            if wide in self._constants or not self._is_within(types[narrow], types[wide]):
                return None
            substitution[wide] = narrow
        return {variable: _value(variable, substitution) for variable in substitution}

    def _is_narrower(self, one: str, other: str, types: Mapping[str, str]) -> bool:
        """Return whether the first argument may replace the second. A constant cannot be replaced."""
        if one in self._constants or other in self._constants:
            return one in self._constants
        return self._is_within(types[one], types[other])

    def _is_within(self, narrow: str, wide: str) -> bool:
        """Return whether `narrow` is the type `wide` or one of its descendants."""
        return wide in lineage(narrow, self._parents)

    def _narrow(self, case: _Case, substitution: Substitution) -> _Case:
        """Return the case to which a substitution is applied in addition."""
        operator = case.operator
        lists = (operator.precondition, operator.add, operator.delete)
        facts = [tuple(dict.fromkeys(_put(fact, substitution) for fact in each)) for each in lists]
        parameters = tuple(parameter for parameter in operator.parameters if parameter[0] not in substitution)
        number = sum(other.origin == case.origin for other in self._cases.values())
        name = f"{case.origin}-case-{number}"
        while name in self._cases:
            name += "x"
        return _Case(Operator(name, parameters, *facts), case.origin, _put(case.arguments, substitution))


def _put(arguments: tuple[str, ...], substitution: Substitution) -> tuple[str, ...]:
    return tuple(substitution.get(argument, argument) for argument in arguments)


def _value(argument: str, substitution: Substitution) -> str:
    """Return the final value of an argument after all substitutions."""
    while argument in substitution:
        argument = substitution[argument]
    return argument
