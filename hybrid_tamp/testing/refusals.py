"""Errors of a domain's functions as disagreements, so that the check of a domain reports all mistakes together."""

import re
from collections.abc import Iterable, Mapping

from hybrid_tamp.errors import DomainError, ForeignCommand, Issue, ShapeError
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.predicate import ANY, Binding, Literal, Predicate, name_of
from hybrid_tamp.model.token import UnknownTarget, UnknownToken
from hybrid_tamp.testing.disagreement import Disagreements, first_role


def add_refusal(error: DomainError, blocks: Iterable[Block], binding: Binding, found: Disagreements) -> list[Block]:
    """Add a disagreement for each issue of an error that a function of the domain caused.

    Args:
        error: the error.
        blocks: the blocks of the domain. If the error names none of them, the first block is blamed.
        binding: maps the roles of the block that was rolled out to their values. Empty if no block was rolled out.
        found: collection to which the disagreements are added.

    Returns:
        The blocks that the errors concern.
    """
    every, kind = list(blocks), _kind(error)
    concerned: list[Block] = []
    if kind == "sees" and all(issue.where.startswith("predicate ") for issue in error.issues):
        kind = "reads"
    for issue in error.issues:
        owners = owners_of(issue.where, every) or every[:1]
        concerned += owners
        for block in owners[:1]:
            bound = binding if binding.keys() == block.roles.keys() else {}
            measured = f"got {issue.came}" if issue.came else "the function failed"
            declared = f"{issue.where}: {issue.wanted}"
            found.add(kind, block, bound, declared, measured, _role(issue, block, binding), issue.remedy)
    return concerned


def owners_of(where: str, blocks: Iterable[Block]) -> list[Block]:
    """Return the blocks that own a function, e.g. ``ROLLING.policy`` or ``predicate inside``."""
    found = []
    for block in blocks:
        names = {f"predicate {p.name}" for p in predicates_of(block)} | {
            f"the bound of {p.name}" for p in predicates_of(block)
        }
        if where in names or where.startswith((f"{block.name}.", f"{block.name}:")):
            found.append(block)
    return found


def predicates_of(block: Block) -> Mapping[Predicate, Literal | None]:
    """Return a mapping from each predicate of a block to its first condition, or to None without a condition.

    Conditions without wildcards come first, because their arguments name the roles.
    """
    found: dict[Predicate, Literal | None] = {}
    for literal in sorted((*block.entry, *block.invariants, *block.exit), key=lambda each: ANY in each.arguments):
        found.setdefault(literal.predicate, literal)
    for predicate in block.keeps:
        found.setdefault(predicate, None)
    return found


def _kind(error: DomainError) -> str:
    if isinstance(error, ShapeError):
        return "shape"
    if isinstance(error, ForeignCommand):
        return "commands"
    if isinstance(error.__cause__, UnknownTarget):
        return "holds"
    return "sees" if isinstance(error.__cause__, UnknownToken) else "error"


def _role(issue: Issue, block: Block, binding: Binding) -> str:
    """Return the hyperparameter or role that an issue concerns. By default, this is the anchor."""
    for hyperparameter in block.hyperparameters:
        if issue.where == f"{block.name}.{hyperparameter.name}":
            return hyperparameter.name
    words = set(re.findall(r"[^\s,;:'\"()]+", f"{issue.where} {issue.came}"))
    for role, value in binding.items():
        if name_of(value) in words:
            return role
    for predicate, literal in predicates_of(block).items():
        if predicate.name in issue.where.split() and literal is not None:
            return first_role(block, literal.arguments)
    return block.anchor
