"""Search by brute force for all single repairs of an unsolvable task, to check explanations.

The module enumerates and applies repairs, and solves the repaired tasks by an exhaustive search. It shares only the
compilation to STRIPS with the code that it checks.

"""

from collections import Counter, defaultdict, deque
from collections.abc import Callable, Collection, Iterator
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np

from hybrid_tamp.errors import InputError
from hybrid_tamp.model.affordance import TOKEN, PlaceClass
from hybrid_tamp.model.facts import static_facts
from hybrid_tamp.model.network import ReassignmentNetwork
from hybrid_tamp.model.predicate import SymbolSort
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.pddl.operators import PlanningProblem

MOST_STATES = 200_000
CHANGES = (-0.99, -0.9, -0.7, -0.5, -0.2, 0.2, 0.5, 1.0, 2.0, 4.0, 9.0, 99.0)
"""Relative changes of a property."""
Key = tuple[str, ...]


class Undecided(Exception):
    """The search reached too many states."""


def solvable(task: Task) -> bool:
    """Return whether a task has a plan, by exhaustive search.

    Raises:
        Undecided: the search reaches too many states.
    """
    return decide(compile_task(task).problem)


def decide(problem: PlanningProblem) -> bool:
    """Return whether a planning problem has a plan, by exhaustive search.

    Raises:
        Undecided: the search reaches too many states.
    """
    actions, numbers = _ground(problem)
    wanted = 0
    for fact in problem.goal:
        if fact not in numbers:
            return False
        wanted |= 1 << numbers[fact]
    first = sum(1 << numbers[fact] for fact in set(problem.init) if fact in numbers)
    watched = _watched(actions)
    seen, queue = {first}, deque([first])
    while queue:
        state = queue.popleft()
        if state & wanted == wanted:
            return True
        rest = state
        while rest:
            bit = rest & -rest
            rest ^= bit
            for needed, add, kept in watched.get(bit, ()):
                if state & needed == needed:
                    following = (state & kept) | add
                    if following not in seen:
                        seen.add(following)
                        queue.append(following)
        if len(seen) > MOST_STATES:
            raise Undecided(problem.name)
    return False


def _watched(actions: list[tuple[int, int, int]]) -> dict[int, list[tuple[int, int, int]]]:
    """Return a mapping from each condition to the actions of which it is the rarest condition."""
    bits = [[1 << n for n in range(needed.bit_length()) if needed >> n & 1] or [0] for needed, _, _ in actions]
    often = Counter(bit for each in bits for bit in each)
    found: defaultdict[int, list[tuple[int, int, int]]] = defaultdict(list)
    for each, action in zip(bits, actions, strict=True):
        found[min(each, key=lambda bit: often[bit])].append(action)
    assert 0 not in found, "an action without conditions"
    return dict(found)


def _ground(problem: PlanningProblem) -> tuple[list[tuple[int, int, int]], dict[Key, int]]:
    """Return the actions that are reachable without deletions, as bit masks, and the number of each fact's bit."""
    parents = dict(problem.domain.types)
    things = (*problem.domain.constants, *problem.objects)

    def within(kind: str, wide: str) -> bool:
        return kind == wide or (kind in parents and within(parents[kind], wide))

    of_type = {kind: {n for n, own in things if within(own, kind)} for kind in {*parents, *parents.values(), "object"}}
    facts = set(problem.init)
    rows: defaultdict[str, set[Key]] = defaultdict(set)
    for fact in facts:
        rows[fact[0]].add(fact)
    found: dict[Key, tuple[list[Key], list[Key], list[Key]]] = {}
    size = -1
    grown = {fact[0] for fact in facts}
    while size < len(facts):
        size, before, grown = len(facts), grown, set()
        for operator in problem.domain.operators:
            if not before & {fact[0] for fact in operator.precondition}:
                continue
            for bound in _bindings(operator, rows, of_type):
                name = (operator.name, *(bound[v] for v, _ in operator.parameters))
                if name not in found:
                    parts = (operator.precondition, operator.add, operator.delete)
                    ground = [[tuple(bound.get(a, a) for a in fact) for fact in part] for part in parts]
                    found[name] = (ground[0], ground[1], ground[2])
                    for fact in ground[1]:
                        grown |= {fact[0]} if fact not in facts else set()
                        facts.add(fact)
                        rows[fact[0]].add(fact)
    changing = {fact for _, add, delete in found.values() for fact in (*add, *delete)}
    numbers = {fact: number for number, fact in enumerate(sorted(changing | set(problem.goal) & facts))}
    everything = (1 << len(numbers)) - 1
    actions = set()
    for needed, add, delete in found.values():
        bits = [sum(1 << numbers[f] for f in set(part) if f in numbers) for part in (needed, add, delete)]
        actions.add((bits[0], bits[1], everything & ~bits[2]))
    return sorted(actions), numbers


def _bindings(operator: Any, rows: Any, of_type: Any) -> list[dict[str, str]]:
    types = dict(operator.parameters)
    bindings: list[dict[str, str]] = [{}]
    for condition in sorted(operator.precondition, key=lambda fact: len(rows[fact[0]])):
        more = []
        for bound in bindings:
            for row in list(rows[condition[0]]):
                new: dict[str, str] | None = dict(bound)
                for argument, value in zip(condition[1:], row[1:], strict=True):
                    assert new is not None
                    known = new.get(argument, value) if argument[0] == "?" else argument
                    if known != value or (argument[0] == "?" and value not in of_type[types[argument]]):
                        new = None
                        break
                    if argument[0] == "?":
                        new[argument] = value
                if new is not None:
                    more.append(new)
        bindings = more
    free = [v for v, _ in operator.parameters if bindings and v not in bindings[0]]
    return [
        {**bound, **dict(zip(free, values, strict=True))}
        for bound in bindings
        for values in product(*(of_type[types[v]] for v in free))
    ]


def repairs(task: Task) -> Iterator[tuple[Key, Callable[[], Task]]]:
    """Yield every single repair as a pair of (key, function that makes the repaired task)."""
    yield from _tokens(task)
    yield from _classes(task)
    yield from _edges(task)
    yield from _facts(task)
    yield from _properties(task)


def all_single_repairs(task: Task, only: Collection[Key] | None = None) -> set[Key]:
    """Return the keys of all single repairs (or of those in `only`) that make the task solvable."""
    found = set()
    base = _ground(compile_task(task).problem)
    for key, made in repairs(task):
        if key in found or (only is not None and key not in only):
            continue
        try:
            problem = compile_task(made()).problem
            # A repair that makes no further action possible cannot make a plan possible.
            if _ground(problem) != base and decide(problem):
                found.add(key)
        except InputError:
            # The domain or the encoder rejects the repaired task.
            continue
    return found


def _moved(task: Task, tokens: tuple[Token, ...], given: dict[tuple[str, str], Any]) -> State:
    old = {(t.name, v.name): task.state[t, v.name] for t in task.tokens for v in t.varying}
    names = {(t.name, v.name) for t in tokens for v in t.varying}
    return State.of(tokens, {k: v for k, v in {**old, **given}.items() if k in names})


def _tokens(task: Task) -> Iterator[tuple[Key, Callable[[], Task]]]:
    things = [token for token in task.tokens if not token.place]
    for like in things:
        here = task.state[like, "position"]
        places = [here + np.array([0.0, 0.3, 0.0])]
        places += [
            np.array([*(2 * task.state[other, "position"] - here)[:2], here[2]])
            for other in things
            if other is not like
        ]
        for place in places:
            yield ("token", like.name), lambda like=like, place=place: _copied(task, like, place)
    for sort in task.domain.classes:
        if not issubclass(sort, PlaceClass) and not task.values_of(sort):
            yield ("token", sort.name), lambda sort=sort: _with_able(task, sort)


def _copied(task: Task, like: Token, place: Any) -> Task:
    copy = replace(like, name="the copy")
    tokens = (*task.tokens, copy)
    given = {("the copy", v.name): task.state[like, v.name] for v in like.varying} | {("the copy", "position"): place}
    return task.replaced(tokens=tokens, state=_moved(task, tokens, given))


def _with_able(task: Task, sort: Any) -> Task:
    able = Token("the able", (TOKEN, sort), {})
    tokens = (*task.tokens, able)
    return _decreed(task.replaced(tokens=tokens, state=_moved(task, tokens, {})), lambda p, values: able in values)


def _classes(task: Task) -> Iterator[tuple[Key, Callable[[], Task]]]:
    for token in task.tokens:
        for sort in task.domain.classes:
            own = [member for member in token.classes if member is not TOKEN]
            if issubclass(sort, PlaceClass) or token.place or sort in own:
                continue
            if all(task.domain.relations.can_share_token(sort, one) for one in own):
                yield ("class", token.name, sort.name), lambda t=token, s=sort: _with_class(task, t, s)


def _with_class(task: Task, token: Token, sort: Any) -> Task:
    members = [each for each in task.tokens if each.is_member(sort)]
    lent = dict(members[0].properties) if members else {}
    changed = replace(token, classes=(*token.classes, sort), properties={**lent, **token.properties})
    tokens = tuple(changed if each is token else each for each in task.tokens)
    more = task.replaced(tokens=tokens, state=_moved(task, tokens, {}))
    if members or set(sort.model_fields) <= set(changed.properties):
        return more
    return _decreed(
        more,
        lambda p, values: any(v is changed and q.sort is sort for v, q in zip(values, p.parameters, strict=True)),
    )


def _edges(task: Task) -> Iterator[tuple[Key, Callable[[], Task]]]:
    slots = {(b.name, s.name): s.object_class for b in task.domain.blocks for s in b.slots}
    for one, other in product(slots, slots):
        if not task.domain.network.allows(one, other) and task.domain.relations.can_share_token(
            slots[one], slots[other]
        ):
            key = ("edge", ".".join(one), ".".join(other))
            yield key, lambda new=key[1:]: _with_edge(task, new)


def _with_edge(task: Task, new: Any) -> Task:
    edges = [(".".join(a), ".".join(b)) for a, b in task.domain.network.edges]
    return task.replaced(domain=replace(task.domain, network=ReassignmentNetwork([*edges, new])))


def _facts(task: Task) -> Iterator[tuple[Key, Callable[[], Task]]]:
    asked = {literal.predicate: literal for b in task.domain.blocks for literal in b.static_entry}
    for predicate, literal in sorted(asked.items(), key=lambda item: item[0].name):
        sorts = [parameter.sort for parameter in predicate.parameters]
        if all(isinstance(sort, SymbolSort) for sort in sorts):
            continue
        for values in product(*(task.values_of(sort) for sort in sorts)):
            names = tuple(v if isinstance(v, str) else v.name for v in values)
            if (float(predicate.evaluate(task.state, *values)) >= 0) is not literal.positive:
                atom = f"{'' if literal.positive else 'not '}{predicate.name}({', '.join(names)})"
                decree = lambda p, v, name=predicate.name, values=values: p.name == name and v == values  # noqa: E731
                yield ("fact", atom), lambda d=decree, s=literal.positive: _decreed(task, d, 1.0 if s else -1.0)


def _properties(task: Task) -> Iterator[tuple[Key, Callable[[], Task]]]:
    """Yield small and large changes of properties, if they change at least one feasibility fact."""
    facts = static_facts(task)
    for token in task.tokens:
        for name, value in token.properties.items():
            numbers = value if isinstance(value, tuple) else (value,)
            if not all(isinstance(number, float) for number in numbers):
                continue
            for place, change in product(range(len(numbers)), CHANGES):
                new = numbers[place] + change * (abs(numbers[place]) or 1.0)
                whole = tuple(new if i == place else number for i, number in enumerate(numbers))
                changed = replace(token, properties={**token.properties, name: whole if numbers is value else new})
                tokens = tuple(changed if each is token else each for each in task.tokens)
                repaired = task.replaced(tokens=tokens, state=_moved(task, tokens, {}))
                if (new > 0 or numbers[place] <= 0) and static_facts(repaired) != facts:
                    label = f"{name}.{'xyz'[place]}" if numbers is value else name
                    yield ("property", token.name, label), lambda repaired=repaired: repaired


def _decreed(task: Task, wanted: Any, margin: float = 1.0) -> Task:
    """Return the task with given feasibility facts. A fact about an unknown property or shape is false."""

    def changed(predicate: Any) -> Any:
        def decided(state: State, *values: Any) -> Any:
            if wanted(predicate, values) and predicate.static:
                return np.full(state.values.shape[:-1], margin)
            try:
                return predicate.margin(state, *values, **predicate.keywords)
            except (KeyError, AssertionError):
                return np.full(state.values.shape[:-1], -1.0)

        of_symbols = all(isinstance(p.sort, SymbolSort) for p in predicate.parameters)
        return predicate if of_symbols else replace(predicate, margin=decided, safety=None, by_name=True)

    new = {predicate: changed(predicate) for predicate in task.domain.predicates}

    def literals(some: Any) -> Any:
        return tuple(replace(each, predicate=new[each.predicate]) for each in some)

    blocks = tuple(
        replace(
            b,
            entry=literals(b.entry),
            exit=literals(b.exit),
            invariants=literals(b.invariants),
            waived=dict(zip(literals(b.waived), b.waived.values(), strict=True)),
            keeps=tuple(new[k] for k in b.keeps),
        )
        for b in task.domain.blocks
    )
    return task.replaced(domain=replace(task.domain, predicates=tuple(new.values()), blocks=blocks))
