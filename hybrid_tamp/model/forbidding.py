"""Bindings that may not be used again: what failed in the forward models is denied to the task planner.

A forbidden binding is a feasibility fact that fails: one more static predicate among a block's entry conditions, over
all its roles. So the planner, the law and the explanation honour it as they do any other fact.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from math import prod

import numpy as np

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.predicate import Literal, Parameter, Predicate, Value, name_of
from hybrid_tamp.model.state import FloatArray, State
from hybrid_tamp.model.task import Task

MOST_FACTS = 200_000
"""A block with more bindings is not restrained: each of them is a fact for the planner."""


@dataclass(frozen=True)
class _Permission:
    """The margin of a binding: 1, or -1 where it is forbidden."""

    forbidden: frozenset[tuple[str, ...]]

    def __call__(self, state: State, *values: Value) -> FloatArray:
        margin = -1.0 if tuple(map(name_of, values)) in self.forbidden else 1.0
        return np.full(state.values.shape[:-1], margin)


def forbid(task: Task, instance: BlockInstance) -> Task:
    """Return the same task, in which the instance's block may not be bound to the same tokens and targets again.

    Args:
        task: the task; bindings that it forbids already stay forbidden.
        instance: an instance of one of its domain's blocks, e.g. of a plan that failed in the forward models.

    Raises:
        InputError: the block has more than `MOST_FACTS` bindings.
    """
    block = task.domain.block_by_name[instance.block]
    count = prod(len(task.values_of(sort)) for sort in block.roles.values())
    if count > MOST_FACTS:
        wanted = f"a block whose bindings can be forbidden has at most {MOST_FACTS} of them"
        raise InputError([Issue(block.name, wanted, str(count), remedy="leave out tokens that are not needed")])
    forbidden = {tuple(instance.roles[role] for role in block.roles), *forbidden_bindings(task, block.name)}
    predicate = _permitted(block, frozenset(forbidden))
    entry = (*_others(block), Literal(predicate, tuple(block.roles)))
    return task.replaced(domain=task.domain.with_blocks([replace(block, entry=entry)], [predicate]))


def forbidden_bindings(task: Task, block: str) -> Iterable[tuple[str, ...]]:
    """Return the bindings of a block that the task forbids: names in the order of the block's roles."""
    permission = _permission(task.domain.predicate_by_name, block)
    return permission.forbidden if permission else frozenset()


def _permission(predicates: Mapping[str, Predicate], block: str) -> _Permission | None:
    predicate = predicates.get(_name(block))
    return predicate.margin if predicate and isinstance(predicate.margin, _Permission) else None


def _others(block: Block) -> tuple[Literal, ...]:
    """Return the entry conditions but that of an earlier call."""
    return tuple(literal for literal in block.entry if not isinstance(literal.predicate.margin, _Permission))


def _name(block: str) -> str:
    return "permitted_" + block.replace(":", "_")


def _permitted(block: Block, forbidden: frozenset[tuple[str, ...]]) -> Predicate:
    """Return the predicate that all bindings of a block but the forbidden ones meet."""
    said = _sentence(block)
    return Predicate(
        name=_name(block.name),
        parameters=tuple(Parameter(role, sort) for role, sort in block.roles.items()),
        margin=_Permission(forbidden),
        static=True,
        description=f"{said} is not forbidden",
        denial=f"{said} failed in the forward models",
    )


def _sentence(block: Block) -> str:
    """Name block and roles, e.g. ``ROLLING of {object} by {hand} to {region}``."""
    parts = [f"{block.name} of {{{block.anchor}}}"]
    for word, roles in (("by", block.others), ("to", block.targets)):
        if roles:
            parts.append(f"{word} " + " and ".join(f"{{{role.name}}}" for role in roles))
    return " ".join(parts)
