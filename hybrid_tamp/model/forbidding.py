"""Forbidden bindings, which failed in the forward models. The task planner must not use these bindings again.

A block with forbidden bindings gets an additional static predicate as an entry condition. The predicate fails for the
forbidden bindings. The planner, the law checker and the explanations treat the predicate like any other feasibility
fact. Every permitted binding is a fact in the planning problem. To reduce the number of facts, the predicate has no
parameter for a symbol that follows from the other arguments.
"""

from dataclasses import dataclass, replace
from math import prod

import numpy as np

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.kind import Kind
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.predicate import Literal, Parameter, Predicate, Value, name_of
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray

MOST_FACTS = 200_000
"""Largest number of bindings of a block with forbidden bindings. Each permitted binding is a fact."""


@dataclass(frozen=True)
class _Permission:
    """A margin that is -1 for forbidden bindings and 1 for all other bindings."""

    forbidden: frozenset[tuple[str, ...]]

    def __call__(self, state: State, *values: Value) -> FloatArray:
        margin = -1.0 if tuple(map(name_of, values)) in self.forbidden else 1.0
        return np.full(state.values.shape[:-1], margin)


def forbid(task: Task, instance: BlockInstance) -> Task:
    """Return the task with one more forbidden binding.

    Args:
        task: task to change. Forbidden bindings of the task remain forbidden.
        instance: block instance whose binding is forbidden, e.g. from a plan that failed in the forward models.

    Raises:
        InputError: if the block has more than `MOST_FACTS` bindings.
    """
    block = task.domain.block_by_name[instance.block]
    roles = deciding_roles(block)
    count = prod(len(task.values_of(block.roles[role])) for role in roles)
    if count > MOST_FACTS:
        wanted = f"to forbid a binding, the block must have at most {MOST_FACTS} bindings"
        raise InputError([Issue(block.name, wanted, str(count), remedy="remove tokens that the task does not need")])
    forbidden = {tuple(instance.roles[role] for role in roles), *forbidden_bindings(task, block.name)}
    predicate = _permitted(block, roles, frozenset(forbidden))
    entry = (*_declared(block), Literal(predicate, roles))
    return task.replaced(domain=task.domain.with_blocks([replace(block, entry=entry)], [predicate]))


def forbidden_bindings(task: Task, block: str) -> frozenset[tuple[str, ...]]:
    """Return the forbidden bindings of a block as tuples of names, in the order of `deciding_roles`."""
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


def _permitted(block: Block, roles: tuple[str, ...], forbidden: frozenset[tuple[str, ...]]) -> Predicate:
    """Return the predicate that holds for all bindings of a block except the forbidden ones."""
    said = _sentence(block, roles)
    return Predicate(
        name="permitted_" + block.name.replace(":", "_"),
        parameters=tuple(Parameter(role, block.roles[role]) for role in roles),
        margin=_Permission(forbidden),
        kind=Kind.STATIC,
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
