"""Functions that return a task with one change, e.g. with an additional token or edge, or with a new property value.

A changed task is planned like any other task. If a class has no members in the task, a new member has no known
properties. Every feasibility fact about this new member is then assumed to hold.
"""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import replace
from itertools import count
from typing import Any

import numpy as np

from hybrid_tamp.geometry.surfaces import points_of
from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.change import (
    AddEdge,
    Change,
    CopyToken,
    GrantFact,
    IdealToken,
    JoinClass,
    SetFactor,
    SetProperty,
)
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.network import SlotName
from hybrid_tamp.model.predicate import Atom, Predicate, Value, name_of
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray


def apply_change(task: Task, change: Change) -> Task:
    """Return the task with one change applied."""
    match change:
        case CopyToken(like, across_from):
            return with_copy(task, like, _copy_position(task, like, across_from))
        case IdealToken(object_class):
            return with_ideal(task, object_class)
        case JoinClass(token, object_class):
            return with_class(task, token, object_class)
        case AddEdge(source, target):
            return with_edges(task, [(source, target)])
        case GrantFact(atom):
            return with_facts(task, [atom])
        case SetProperty():
            return with_token(task, change.token)
        case SetFactor(predicate, factor):
            return task.with_safety({predicate: factor})


def apply_together(task: Task, changes: Collection[Change]) -> Task:
    """Return the task with all changes applied. Several changes must all add edges, or must all grant facts."""
    if len(changes) == 1:
        (change,) = changes
        return apply_change(task, change)
    edges = [(change.source, change.target) for change in changes if isinstance(change, AddEdge)]
    atoms = [change.atom for change in changes if isinstance(change, GrantFact)]
    assert len(changes) in (len(edges), len(atoms)), "several changes must all add edges, or must all grant facts"
    return with_facts(task, atoms) if atoms else with_edges(task, edges)


def propose_copies(task: Task, like: Token) -> Iterator[CopyToken]:
    """Yield changes that copy a token to different positions.

    The first copy is beside the original without overlap. Each further copy is on the opposite side of an object.
    """
    yield CopyToken(like)
    position = task.state[like, "position"]
    for other in task.assigned:
        if other is not like and set(other.classes).isdisjoint(set(like.classes) - {task_root(task)}):
            across = _copy_position(task, like, other)
            if np.linalg.norm((across - position)[:2]) > 1e-6:
                yield CopyToken(like, other)


def _copy_position(task: Task, like: Token, across_from: Token | None) -> FloatArray:
    """Return the position of a copy in metres: beside the original, or on the opposite side of another token."""
    position = task.state[like, "position"]
    if across_from is None:
        longest = 0.1 if like.shape is None else float(np.ptp(points_of(like.shape), axis=0).max())
        return np.asarray(position + np.array([0.0, longest, 0.0]))
    return np.array([*(2.0 * task.state[across_from, "position"] - position)[:2], position[2]])


def task_root(task: Task) -> type[ObjectClass]:
    """Return the class that all tokens except places share."""
    return task.domain.resting_block.slots[0].object_class


def with_copy(task: Task, like: Token, position: FloatArray) -> Task:
    """Return the task with a copy of a token at a given position in metres. The copy belongs to the same agent."""
    copy = replace(like, name=_free_name(task, like.name))
    state = {(copy.name, varying.name): task.state[like, varying.name] for varying in like.varying}
    agents = {agent: (*names, copy.name) if like.name in names else names for agent, names in task.agents.items()}
    return _add_token(task, copy, {**state, (copy.name, "position"): position}, like, agents)


def with_ideal(task: Task, object_class: type[ObjectClass]) -> Task:
    """Return the task with a new token of a class that has no members. All feasibility facts about the token hold."""
    classes = tuple(sorted({object_class, task_root(task)}, key=lambda each: each.name))
    ideal = Token(_free_name(task, object_class.name.lower()), classes, {})
    more = _add_token(task, ideal, {}, None, task.agents)
    return more.replaced(domain=grant(more.domain, lambda _, values: any(v is ideal for v in values)))


def _add_token(
    task: Task,
    token: Token,
    given: Mapping[tuple[str, str], Any],
    like: Token | None,
    agents: Mapping[str, tuple[str, ...]],
) -> Task:
    tokens = (*task.tokens, token)
    start = task.start_block(like.name).name if like else task.domain.resting
    state = State.of(tokens, {**_given(task), **given})
    return task.replaced(tokens=tokens, state=state, agents=agents, assignment={**task.assignment, token.name: start})


def without_token(task: Task, token: Token) -> Task:
    """Return the task without a token and without the goal atoms that name the token."""
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


def _free_name(task: Task, name: str) -> str:
    numbered = (f"{name} ({number})" for number in count(2))
    return next(each for each in numbered if each not in task.token_by_name)


def with_token(task: Task, token: Token) -> Task:
    """Return the task in which a token replaces the token of the same name. The state is kept."""
    tokens = tuple(token if each.name == token.name else each for each in task.tokens)
    names = {(each.name, varying.name) for each in tokens for varying in each.varying}
    state = State.of(tokens, {key: value for key, value in _given(task).items() if key in names})
    return task.replaced(tokens=tokens, state=state)


def with_class(task: Task, token: Token, object_class: type[ObjectClass]) -> Task:
    """Return the task in which a token is also a member of another class.

    Missing properties are copied from the first member of the class. If the class has no members, the feasibility facts
    about the token as a member of the class are assumed to hold.
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

    return more.replaced(domain=grant(more.domain, asked))


def with_edges(task: Task, more: Iterable[tuple[SlotName, SlotName]]) -> Task:
    """Return the task with more edges in its network."""
    return task.replaced(domain=replace(task.domain, network=task.domain.network.extended(more)))


def with_facts(task: Task, atoms: Iterable[Atom]) -> Task:
    """Return the task in which the given feasibility facts hold, whatever their margins are."""
    domain = task.domain
    for positive in (True, False):
        wanted = {(atom.predicate, *atom.arguments) for atom in atoms if atom.positive is positive}
        if wanted:
            domain = grant(domain, _among(wanted), 1.0 if positive else -1.0, {name for name, *_ in wanted})
    return task.replaced(domain=domain)


def _among(wanted: Collection[tuple[str, ...]]) -> "Granted":
    return lambda predicate, values: (predicate.name, *map(name_of, values)) in wanted


Granted = Callable[[Predicate, tuple[Value, ...]], bool]


def grant(domain: Domain, wanted: Granted, margin: float = 1.0, names: Collection[str] = ()) -> Domain:
    """Return the domain with a fixed margin for some feasibility facts.

    The tokens in these facts may lack properties or a shape. A state predicate that needs a missing property or shape
    does not hold. The expected duration of each block is set to the minimum.

    Args:
        domain: the domain to change.
        wanted: function that returns whether the fact with the given predicate and arguments gets the margin.
        margin: the margin of these facts.
        names: names of the predicates to change. If empty, all predicates are changed.
    """
    changed = {
        predicate.name: _granted(predicate, wanted, margin)
        for predicate in domain.predicates
        if (not names or predicate.name in names) and any(isinstance(each.sort, type) for each in predicate.parameters)
    }
    granted = domain.with_predicates(changed)

    def block(old: Block) -> Block:
        return replace(
            old,
            duration=replace(old.duration, expected=lambda *_: old.duration.minimum),
            hyperparameters=(),
            outcome=None,
        )

    return replace(granted, blocks=tuple(map(block, granted.blocks)))


def _granted(predicate: Predicate, wanted: Granted, margin: float) -> Predicate:
    def decided(state: State, *values: Value) -> FloatArray:
        if not wanted(predicate, values):
            return predicate.margin(state, *values, **predicate.keywords)
        if predicate.static:
            return np.full(state.values.shape[:-1], margin)
        try:
            return predicate.margin(state, *values, **predicate.keywords)
        except (KeyError, AssertionError):  # The token lacks a property, or a shape that the function asserts.
            return np.full(state.values.shape[:-1], -1.0)

    return replace(predicate, margin=decided, by_name=True, safety=None)
