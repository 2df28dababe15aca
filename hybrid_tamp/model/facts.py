"""Computation of the symbolic state from the continuous state.

An atom holds if its margin is zero or positive. A functional predicate has at most one value. If several values have
non-negative margins, the value in the goal is chosen. If the goal has none of these values, the value with the largest
margin is chosen. Atoms of maintained predicates depend on the running instances, not on the continuous state.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np

from hybrid_tamp.model.bindings import enumerate_bindings
from hybrid_tamp.model.predicate import Atom, Literal, Parameter, Predicate, SymbolSort, Value, name_of
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token, different
from hybrid_tamp.motion.arrays import FloatArray


def static_facts(task: Task, known: "StaticFacts | None" = None) -> frozenset[Atom]:
    """Return the feasibility facts of the task, which are the true atoms of static predicates over distinct tokens.

    Args:
        task: task whose facts are computed.
        known: facts of a larger task that has all tokens of `task` in the same state. Margins in `known` are reused.
    """
    known = known or StaticFacts(task)
    found: set[Atom] = set()
    for predicate in task.domain.static_predicates:
        if predicate.rows is not None:
            found.update(Atom(predicate.name, row) for row in _rows_within(task, predicate, predicate.rows))
        else:
            found.update(known.holding(predicate, _bindings(task, predicate)))
    return frozenset(found)


def _rows_within(task: Task, predicate: Predicate, rows: Iterable[tuple[str, ...]]) -> Iterable[tuple[str, ...]]:
    """Return the rows whose tokens are all in the task, which may be a part of the task for which the rows are made."""
    tokens = [index for index, parameter in enumerate(predicate.parameters) if isinstance(parameter.sort, type)]
    return rows if not tokens else [row for row in rows if all(row[index] in task.token_by_name for index in tokens)]


def fact_margin(literal: Literal, initial: State, state: State, binding: Mapping[str, Value]) -> FloatArray:
    """Return the signed margin ``(...)`` of a feasibility condition in a later state.

    The margin uses the later values only for properties that the predicate lists in `reads`. For all other properties,
    the margin uses the initial values. A fact can thus depend on the side on which a hand started.

    Args:
        literal: condition on a static predicate.
        initial: initial state, without batch dimensions.
        state: later state, batch shape ``(...)``, in the same layout.
        binding: maps each role to its token or symbol.
    """
    predicate = literal.predicate
    values = np.array(np.broadcast_to(initial.values, state.values.shape))
    read = {
        (token.name, name): state[token, name]
        for parameter, argument in zip(predicate.parameters, literal.arguments, strict=True)
        if isinstance(token := binding.get(argument), Token) and not predicate.at_start
        for name in predicate.reads.get(parameter.name, ())
    }
    return literal.margin(State(state.layout, values).replace(read), binding)


class StaticFacts:
    """The feasibility facts of a task.

    Each margin is evaluated when it is first needed, because a task can have very many feasibility facts.
    """

    def __init__(self, task: Task) -> None:
        self._task = task
        self._known: dict[Atom, float] = {}

    def __contains__(self, atom: Atom) -> bool:
        """Return whether a positive atom is a feasibility fact of the task."""
        predicate = self._task.domain.predicate_by_name[atom.predicate]
        values = tuple(map(self._task.value, atom.arguments))
        # A row may name the same place twice, e.g. as the old and the new place of a token that does not move.
        fits = all(map(_fits, values, predicate.parameters)) and (predicate.rows is not None or different(values))
        return fits and self._margin(predicate, values, atom) >= 0

    def margin(self, literal: Literal, bound: Mapping[str, Value]) -> float:
        """Return the signed margin of a static literal in the initial state. `bound` maps each role to its value."""
        values = tuple(bound.get(argument, argument) for argument in literal.arguments)
        margin = self._margin(literal.predicate, values, next(_atoms(literal.predicate, [values])))
        return margin if literal.positive else -margin

    def holding(self, predicate: Predicate, bindings: Sequence[tuple[Value, ...]]) -> Iterator[Atom]:
        """Yield the atoms that hold for well-typed arguments. Unknown margins are evaluated in one batch."""
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
    """Return the atoms of changing and functional predicates that hold in a state.

    Args:
        task: task that has the tokens and the goal.
        state: continuous state. None means the initial state of the task.
        predicates: predicates of the atoms. None means all predicates of the domain.
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
    """Return a pair of (atom, margin) for every well-typed atom of the predicate over distinct tokens."""
    bindings = _bindings(task, predicate)
    return zip(_atoms(predicate, bindings), predicate.margins(state, bindings).tolist(), strict=True)


def _bindings(task: Task, predicate: Predicate) -> list[tuple[Value, ...]]:
    """Return all well-typed arguments of the predicate in which no token occurs twice."""
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
