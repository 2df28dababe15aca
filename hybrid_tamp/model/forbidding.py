"""Forbidden bindings, which failed in the forward models. The task planner must not use these bindings again.

A block with forbidden bindings gets an additional static predicate as an entry condition. The predicate fails for the
forbidden bindings. The planner, the law checker and the explanations treat the predicate like any other feasibility
fact. Every permitted binding is a fact in the planning problem. To reduce the number of facts, the predicate has no
parameter for a symbol that follows from the other arguments.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import prod

import numpy as np

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.kind import Kind
from hybrid_tamp.model.margins import ROUNDING
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.predicate import Atom, Literal, Parameter, Predicate, Value, name_of
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray

SAME_POSE = 0.01
"""Largest difference of a coordinate [m] or of a component of a quaternion between equal poses."""
_POSE = ("position", "orientation")
MOST_FACTS = 200_000
"""Largest number of bindings of a block with forbidden bindings. Each permitted binding is a fact."""


@dataclass(frozen=True, eq=False)
class _Region:
    """The positions of a token at which an atom holds that says that the token is in a place.

    Attributes:
        token: name of the token.
        predicate: predicate of the atom.
        values: the token and the place.
        world: state with the position of the place.
    """

    token: str
    predicate: Predicate
    values: tuple[Token, ...]
    world: State

    def depth(self, state: State) -> float:
        """Return the margin of the atom for the position of the token in a state [m]."""
        moved = self.world.replace({(self.token, "position"): state[self.token, "position"]})
        return float(self.predicate.evaluate(moved, *self.values))


@dataclass(frozen=True)
class _Forbidden:
    """A forbidden binding as a tuple of names, and the poses in which it failed.

    Attributes:
        names: tokens and symbols of the binding, in the order of `deciding_roles`.
        poses: triples of (token, property, values). Without poses, the binding is forbidden in all states.
        region: place in which the binding fails at every position of a token, or None.
    """

    names: tuple[str, ...]
    poses: tuple[tuple[str, str, tuple[float, ...]], ...] = ()
    region: _Region | None = None

    def applies(self, state: State, radius: float = 0.0) -> bool:
        """Return whether all tokens are where the binding failed, even if they are shifted by at most a radius [m]."""
        if self.region is None:
            return radius == 0.0 and self._same(state)
        return self._same(state) and self.region.depth(state) >= radius - ROUNDING

    def _same(self, state: State) -> bool:
        return all(
            bool((np.abs(state[token, name] - np.array(value)) <= SAME_POSE).all()) for token, name, value in self.poses
        )


@dataclass(frozen=True)
class _Permission:
    """A margin that is -1 for a forbidden binding if its tokens have the forbidden poses, and 1 otherwise."""

    forbidden: frozenset[_Forbidden]

    def __call__(self, state: State, *values: Value) -> FloatArray:
        return self.bound(state, 0.0, *values)

    def bound(self, state: State, radius: float, *values: Value) -> FloatArray:
        """Return an upper bound of the margin after horizontal shifts of the tokens by at most `radius` [m]."""
        shape = state.values.shape[:-1]
        names = tuple(map(name_of, values))
        mine = [each for each in self.forbidden if each.names == names]
        single = [State(state.layout, row) for row in state.values.reshape(-1, state.layout.size)] if mine else []
        held = [any(each.applies(one, radius) for each in mine) for one in single] or [False]
        return np.where(np.resize(held, shape), -1.0, 1.0)


def forbid(
    task: Task,
    instance: BlockInstance,
    state: State | None = None,
    roles_that_move: Sequence[str] = (),
    wherever: Atom | None = None,
) -> Task:
    """Return the task with one more forbidden binding.

    Args:
        task: task to change. Forbidden bindings of the task remain forbidden.
        instance: block instance whose binding is forbidden, e.g. from a plan that failed in the forward models.
        state: state in which the instance began. None forbids the binding in all states.
        roles_that_move: roles of tokens. The binding is forbidden only for the poses of these tokens in `state`, and
            remains permitted if one of the tokens is elsewhere.
        wherever: atom that says that one of these tokens is in a place. The binding is forbidden at every position of
            the token in the place, with the orientation of the token in `state`.

    Raises:
        InputError: if the block has more than `MOST_FACTS` bindings.
    """
    block = task.domain.block_by_name[instance.block]
    roles = deciding_roles(block)
    count = prod(len(task.values_of(block.roles[role])) for role in roles)
    if count > MOST_FACTS:
        wanted = f"to forbid a binding, the block must have at most {MOST_FACTS} bindings"
        raise InputError([Issue(block.name, wanted, str(count), remedy="remove tokens that the task does not need")])
    names = tuple(instance.roles[role] for role in roles)
    moving = [role for role in roles_that_move if role in roles] if state is not None else []
    poses = tuple(
        (token, name, tuple(map(float, state[token, name])))
        for token in (instance.roles[role] for role in moving)
        for name in _POSE
        if state is not None and (token, name) in state.layout.slices
        if wherever is None or name != "position" or token not in wherever.arguments
    )
    found = _Forbidden(names, poses, None if wherever is None else _region(task, wherever))
    predicate = _permitted(block, roles, _forbidden(task, block.name) | {found}, moving)
    entry = (*_declared(block), Literal(predicate, roles))
    return task.replaced(domain=task.domain.with_blocks([replace(block, entry=entry)], [predicate]))


def _region(task: Task, wherever: Atom) -> _Region:
    values = tuple(task.token_by_name[name] for name in wherever.arguments)
    token = next(each.name for each in values if not each.place)
    return _Region(token, task.domain.predicate_by_name[wherever.predicate], values, task.state)


def forbidden_bindings(task: Task, block: str) -> frozenset[tuple[str, ...]]:
    """Return the forbidden bindings of a block as tuples of names, in the order of `deciding_roles`."""
    return frozenset(each.names for each in _forbidden(task, block))


def _forbidden(task: Task, block: str) -> frozenset[_Forbidden]:
    permissions = [each.predicate.margin for each in task.domain.block_by_name[block].entry]
    return frozenset().union(*(each.forbidden for each in permissions if isinstance(each, _Permission)))


def deciding_roles(block: Block) -> tuple[str, ...]:
    """Return the roles of a block. A symbol role is omitted if an entry condition determines it from other roles."""
    kept = list(block.roles)
    for literal in _declared(block):
        twice = len(set(literal.arguments)) < len(literal.arguments)
        if literal.positive and literal.predicate.rows is not None and not twice:
            rows = [dict(zip(literal.arguments, row, strict=True)) for row in literal.predicate.rows]
            # An argument that is not a role is a symbol, which must be equal to the symbol in the row.
            rows = [row for row in rows if all(name in (row[name], *block.roles) for name in row)]
            for role in reversed(literal.arguments):
                others = [name for name in literal.arguments if name in kept and name != role]
                if role in kept and len({tuple(row[name] for name in others) for row in rows}) == len(rows):
                    kept.remove(role)
    return tuple(kept)


def _declared(block: Block) -> tuple[Literal, ...]:
    """Return the entry conditions without the condition that `forbid` added."""
    return tuple(literal for literal in block.entry if not isinstance(literal.predicate.margin, _Permission))


def _permitted(
    block: Block, roles: tuple[str, ...], forbidden: frozenset[_Forbidden], moving: Sequence[str]
) -> Predicate:
    """Return the predicate that holds for all bindings of a block except the forbidden ones."""
    said, permission = _sentence(block, roles), _Permission(forbidden)
    return Predicate(
        name="permitted_" + block.name.replace(":", "_"),
        parameters=tuple(Parameter(role, block.roles[role]) for role in roles),
        margin=permission,
        bound=permission.bound,
        kind=Kind.STATIC,
        reads={role: _POSE for role in moving},
        by_name=True,
        description=f"{said} is not forbidden",
        denial=f"{said} failed in the forward models",
    )


def _sentence(block: Block, roles: tuple[str, ...]) -> str:
    """Return a phrase for a block with its roles, e.g. ``ROLLING of {object} by {hand} to {region}``."""
    others = [slot.name for slot in block.others]
    targets = [target.name for target in block.targets if target.name in roles]
    phrases = [f"{block.name} of {{{block.anchor}}}"]
    for word, names in (("by", others), ("to", targets)):
        if names:
            phrases.append(f"{word} " + " and ".join(f"{{{name}}}" for name in names))
    return " ".join(phrases)
