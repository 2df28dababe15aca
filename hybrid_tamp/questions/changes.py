"""Single changes of a task: one more token, one more class for a token, one more edge, one fact granted, one property.

A changed task is a task as any other, and is solved as any other. What is not known of it is taken to be as good as it
takes: a token of a class of which the task has no member meets every feasibility fact that is asked of it as such.
"""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any
from typing import Literal as OneOf

import numpy as np

from hybrid_tamp.geometry.surfaces import points_of
from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.network import ReassignmentNetwork, SlotName
from hybrid_tamp.model.predicate import Atom, Literal, Predicate, Value, name_of
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray

Kind = OneOf["token", "class", "edge", "fact", "property"]

Place = tuple[float, float, float]


@dataclass(frozen=True)
class Change:
    """One change of a task.

    Attributes:
        kind: what sort of change it is.
        key: what tells it from others of its kind: the names of a class, a token, slots, an atom or a property.
        what: the change in words, as something to do.
        made: makes the changed task.
    """

    kind: Kind
    key: tuple[str, ...]
    what: str
    made: Callable[[], Task]


def more_tokens(task: Task, like: Token) -> Iterator[Change]:
    """Yield the change by one more token like one that is there: beside it, then on the other side of each thing.

    Symbols do not ask whether two things are in one place; the copy is put as far away as it is long all the same.
    """
    position = task.state[like, "position"]
    aside = position + np.array([0.0, _extent(like), 0.0])
    said = f"one more token like {like.name} ({_classes(like)})"
    yield Change("token", (like.name, ""), said, lambda: with_copy(task, like, aside))
    for other in task.assigned:
        if other is not like and set(other.classes).isdisjoint(set(like.classes) - {task_root(task)}):
            middle = task.state[other, "position"]
            across = np.array([*(2.0 * middle - position)[:2], position[2]])
            if np.linalg.norm((across - position)[:2]) > 1e-6:
                made = _across(task, like, across)
                yield Change("token", (like.name, other.name), f"{said} on the other side of {other.name}", made)


def _across(task: Task, like: Token, place: FloatArray) -> Callable[[], Task]:
    return lambda: with_copy(task, like, place)


def task_root(task: Task) -> type[ObjectClass]:
    """Return the class that every token of the task but places is a member of."""
    return task.domain.resting_block.slots[0].object_class


def with_copy(task: Task, like: Token, position: FloatArray) -> Task:
    """Return the task with one more token like one that is there, at a place; it belongs to the same agent."""
    copy = replace(like, name=free_name(task, like.name))
    state = {(copy.name, varying.name): task.state[like, varying.name] for varying in like.varying}
    agents = {agent: (*names, copy.name) if like.name in names else names for agent, names in task.agents.items()}
    return _with_token(task, copy, {**state, (copy.name, "position"): position}, like, agents)


def with_ideal(task: Task, object_class: type[ObjectClass]) -> Task:
    """Return the task with a token of a class of which it has none, which meets every fact that is asked of it."""
    ideal = replace(Token(free_name(task, object_class.name.lower()), (), {}), classes=_with_root(task, object_class))
    more = _with_token(task, ideal, {}, None, task.agents)
    return more.replaced(domain=granted(more.domain, lambda _, values: any(v is ideal for v in values)))


def _with_root(task: Task, object_class: type[ObjectClass]) -> tuple[type[ObjectClass], ...]:
    return tuple(sorted({object_class, task_root(task)}, key=lambda each: each.name))


def _with_token(
    task: Task,
    token: Token,
    given: Mapping[tuple[str, str], Any],
    like: Token | None,
    agents: Mapping[str, tuple[str, ...]],
) -> Task:
    tokens = (*task.tokens, token)
    start = task.assignment.get(like.name, task.domain.resting) if like else task.domain.resting
    state = State.of(tokens, {**_given(task), **given})
    return task.replaced(tokens=tokens, state=state, agents=agents, assignment={**task.assignment, token.name: start})


def without_token(task: Task, token: Token) -> Task:
    """Return the task without a token; goals that name it go with it."""
    tokens = tuple(each for each in task.tokens if each is not token)
    given = {key: value for key, value in _given(task).items() if key[0] != token.name}
    return task.replaced(
        tokens=tokens,
        state=State.of(tokens, given),
        goal=tuple(atom for atom in task.goal if token.name not in atom.arguments),
        agents={agent: tuple(name for name in names if name != token.name) for agent, names in task.agents.items()},
        assignment={name: block for name, block in task.assignment.items() if name != token.name},
    )


def _given(task: Task) -> dict[tuple[str, str], Any]:
    return {(token.name, each.name): task.state[token, each.name] for token in task.tokens for each in token.varying}


def free_name(task: Task, name: str) -> str:
    """Return a name like this one that no token has."""
    number = 2
    while f"{name} ({number})" in task.token_by_name:
        number += 1
    return f"{name} ({number})"


def with_token(task: Task, token: Token) -> Task:
    """Return the task with another token in place of the one of the same name; where it is stays the same."""
    tokens = tuple(token if each.name == token.name else each for each in task.tokens)
    names = {(each.name, varying.name) for each in tokens for varying in each.varying}
    state = State.of(tokens, {key: value for key, value in _given(task).items() if key in names})
    return task.replaced(tokens=tokens, state=state)


def with_class(task: Task, token: Token, object_class: type[ObjectClass]) -> Task:
    """Return the task in which a token is a member of one more class.

    What the class asks of it is as it is of the first member of the class; without one, it meets every fact that is
    asked of a member.
    """
    members = [each for each in task.values_of(object_class) if isinstance(each, Token)]
    classes = tuple(sorted({*token.classes, object_class}, key=lambda each: each.name))
    known = dict(members[0].properties) if members else {}
    changed = replace(token, classes=classes, properties={**known, **token.properties})
    more = with_token(task, changed)
    if members or set(object_class.model_fields) <= set(changed.properties):
        return more

    def asked(predicate: Predicate, values: tuple[Value, ...]) -> bool:
        return any(
            value is changed and isinstance(p.sort, type) and issubclass(object_class, p.sort)
            for value, p in zip(values, predicate.parameters, strict=True)
        )

    return more.replaced(domain=granted(more.domain, asked))


def with_edges(task: Task, more: Iterable[tuple[SlotName, SlotName]]) -> Task:
    """Return the task whose network has more edges."""
    edges = [(".".join(one), ".".join(other)) for one, other in (*task.domain.network.edges, *more)]
    return task.replaced(domain=replace(task.domain, network=ReassignmentNetwork(edges)))


def with_facts(task: Task, atoms: Iterable[Atom]) -> Task:
    """Return the task in which feasibility facts are as conditions want them, whatever their margins are."""
    domain = task.domain
    for positive in (True, False):
        wanted = {(atom.predicate, *atom.arguments) for atom in atoms if atom.positive is positive}
        if wanted:
            domain = granted(domain, _among(wanted), 1.0 if positive else -1.0, {name for name, *_ in wanted})
    return task.replaced(domain=domain)


def _among(wanted: Collection[tuple[str, ...]]) -> "Granted":
    return lambda predicate, values: (predicate.name, *map(name_of, values)) in wanted


Granted = Callable[[Predicate, tuple[Value, ...]], bool]


def granted(domain: Domain, wanted: Granted, margin: float = 1.0, names: Collection[str] = ()) -> Domain:
    """Return the domain in which feasibility facts that are wanted are so by decree.

    Of the tokens that they speak of not everything may be known: what cannot be said of them at first does not hold,
    and how long blocks last is not estimated from them.

    Args:
        domain: the domain.
        wanted: says which facts.
        margin: what they are decreed to be.
        names: the predicates that they may be of; any where there are none.
    """
    changed = {
        predicate: _granted(predicate, wanted, margin)
        for predicate in domain.predicates
        if (not names or predicate.name in names) and any(isinstance(each.sort, type) for each in predicate.parameters)
    }

    def literals(some: tuple[Literal, ...]) -> tuple[Literal, ...]:
        return tuple(replace(each, predicate=changed.get(each.predicate, each.predicate)) for each in some)

    def block(old: Block) -> Block:
        return replace(
            old,
            entry=literals(old.entry),
            exit=literals(old.exit),
            keeps=tuple(changed.get(each, each) for each in old.keeps),
            duration=replace(old.duration, expected=lambda *_: old.duration.minimum),
            hyperparameters=(),
            outcome=None,
        )

    predicates = tuple(changed.get(each, each) for each in domain.predicates)
    return replace(domain, predicates=predicates, blocks=tuple(map(block, domain.blocks)))


def _granted(predicate: Predicate, wanted: Granted, margin: float) -> Predicate:
    def decided(state: State, *values: Value) -> FloatArray:
        if not wanted(predicate, values):
            return predicate.evaluate(state, *values)
        if predicate.static:
            return np.full(state.values.shape[:-1], margin)
        try:
            return predicate.evaluate(state, *values)
        except KeyError:
            return np.full(state.values.shape[:-1], -1.0)

    return replace(predicate, margin=decided)


def _extent(token: Token) -> float:
    """Return how long a token is along its longest side [m], as far as is known."""
    return 0.1 if token.shape is None else float(np.ptp(points_of(token.shape), axis=0).max())


def _classes(token: Token) -> str:
    own = [member.name for member in token.classes if member.model_fields]
    return ", ".join(own or [member.name for member in token.classes])
