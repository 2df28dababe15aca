"""The symbolic state, computed from the continuous state.

A predicate holds if its margin is zero or positive. A functional predicate has at most one value: if several values
have such margins, the value in the goal, else the value with the largest margin. Atoms of maintained predicates do not
follow from the continuous state, because they belong to running instances.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence

from hybrid_tamp.model.bindings import enumerate_bindings
from hybrid_tamp.model.predicate import Atom, Literal, Parameter, Predicate, SymbolSort, Value, name_of
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token, different


def static_facts(task: Task, known: "StaticFacts | None" = None) -> frozenset[Atom]:
    """Return the feasibility facts of the task: atoms of static predicates over different tokens.

    Args:
        task: the task.
        known: the facts of a larger task that has these tokens in the same state; some may be decided already.
    """
    known = known or StaticFacts(task)
    found: set[Atom] = set()
    for predicate in task.domain.static_predicates:
        if predicate.rows is not None:
            found.update(Atom(predicate.name, row) for row in predicate.rows)
        else:
            found.update(known.holding(predicate, _bindings(task, predicate)))
    return frozenset(found)


class StaticFacts:
    """The feasibility facts of a task, each margin evaluated when it is first needed: there may be very many."""

    def __init__(self, task: Task) -> None:
        self._task = task
        self._known: dict[Atom, float] = {}

    def __contains__(self, atom: Atom) -> bool:
        """Say whether the positive atom is one of `static_facts`."""
        predicate = self._task.domain.predicate_by_name[atom.predicate]
        values = tuple(map(self._task.value, atom.arguments))
        fits = all(map(_fits, values, predicate.parameters)) and different(values)
        return fits and self._margin(predicate, values, atom) >= 0

    def margin(self, literal: Literal, bound: Mapping[str, Value]) -> float:
        """Return the signed margin of a static literal whose roles are bound, in the initial state."""
        values = tuple(bound.get(argument, argument) for argument in literal.arguments)
        margin = self._margin(literal.predicate, values, next(_atoms(literal.predicate, [values])))
        return margin if literal.positive else -margin

    def holding(self, predicate: Predicate, bindings: Sequence[tuple[Value, ...]]) -> Iterator[Atom]:
        """Yield the facts among well-typed bindings; margins that are not known yet are evaluated at once."""
        atoms = list(_atoms(predicate, bindings))
        unknown = [place for place, atom in enumerate(atoms) if atom not in self._known]
        margins = predicate.margins(self._task.state, [bindings[place] for place in unknown])
        self._known |= {atoms[place]: float(margin) for place, margin in zip(unknown, margins, strict=True)}
        return (atom for atom in atoms if self._known[atom] >= 0)

    def _margin(self, predicate: Predicate, values: tuple[Value, ...], atom: Atom) -> float:
        if atom not in self._known:
            self._known[atom] = float(predicate.evaluate(self._task.state, *values))
        return self._known[atom]


def _fits(value: Value, parameter: Parameter) -> bool:
    if isinstance(parameter.sort, SymbolSort):
        return value in parameter.sort.symbols
    return isinstance(value, Token) and value.is_member(parameter.sort)


def facts(task: Task, state: State | None = None, predicates: Iterable[Predicate] | None = None) -> frozenset[Atom]:
    """Return the atoms of changing predicates that hold.

    Args:
        task: the task.
        state: the state; the initial state by default.
        predicates: the predicates; all predicates of the domain by default.
    """
    state = task.state if state is None else state
    found: set[Atom] = set()
    for predicate in task.domain.predicates if predicates is None else predicates:
        if not predicate.measured:
            continue
        holding = [(atom, margin) for atom, margin in margins(task, state, predicate) if margin >= 0]
        index = predicate.functional_index
        if index is None:
            found.update(atom for atom, _ in holding)
        else:
            found.update(_one_value_each(task, holding, index))
    return frozenset(found)


def margins(task: Task, state: State, predicate: Predicate) -> Iterable[tuple[Atom, float]]:
    """Return every well-typed atom of the predicate over different tokens, with its margin."""
    bindings = _bindings(task, predicate)
    return zip(_atoms(predicate, bindings), predicate.margins(state, bindings).tolist(), strict=True)


def _bindings(task: Task, predicate: Predicate) -> list[tuple[Value, ...]]:
    """Return every well-typed binding of the predicate's arguments to different tokens."""
    sorts = {parameter.name: task.values_of(parameter.sort) for parameter in predicate.parameters}
    return [tuple(bound.values()) for bound in enumerate_bindings(sorts)]


def _atoms(predicate: Predicate, bindings: Iterable[tuple[Value, ...]]) -> Iterator[Atom]:
    return (Atom(predicate.name, tuple(map(name_of, values))) for values in bindings)


def _one_value_each(task: Task, holding: list[tuple[Atom, float]], index: int) -> Iterable[Atom]:
    wanted = set(task.goal)
    best: dict[tuple[str, ...], tuple[bool, float, Atom]] = {}
    for atom, margin in holding:
        key = atom.arguments[:index] + atom.arguments[index + 1 :]
        candidate = (atom in wanted, margin, atom)
        if key not in best or candidate > best[key]:
            best[key] = candidate
    return (atom for _, _, atom in best.values())
