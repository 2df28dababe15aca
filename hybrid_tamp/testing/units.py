"""Checks of declared units, and of bounds that are implausible for their units."""

import math
import re
from collections.abc import Iterator, Sequence

from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.predicate import Predicate
from hybrid_tamp.model.task import Task
from hybrid_tamp.testing.disagreement import Disagreements, first_role
from hybrid_tamp.testing.refusals import predicates_of

_LENGTHS, _ANGLES = ("mm", "cm", "dm", "km", "um", "inch", "in", "ft"), ("deg", "degree", "degrees", "°", "rev", "rpm")
_OTHERS = ("ms", "us", "min", "h", "hour", "g", "mg", "t", "mN", "kN", "kgf", "bar")
_FOREIGN = frozenset((*_LENGTHS, *_ANGLES, *_OTHERS))
"""Units that are no SI units, or SI units with a prefix."""
LARGEST = {"rad": 4.0 * math.pi, "rad/s": 100.0, "m": 20.0, "m/s": 20.0}
"""Largest plausible magnitudes of hyperparameters and properties. In degrees or millimetres, most bounds are larger."""


def check_units(task: Task, blocks: Sequence[Block], found: Disagreements) -> None:
    """Report units that are no SI units, and bounds that are implausible for their units."""
    seen: set[Predicate] = set()
    for block in blocks:
        for name, unit in _named_units(block):
            if is_foreign(unit):
                found.add("unit", block, {}, f"the unit of {name} must be an SI unit", f"got {unit}", name)
        for predicate, literal in predicates_of(block).items():
            if is_foreign(predicate.unit) and predicate not in seen and literal is not None:
                declared, role = (
                    f"the unit of {predicate.name} must be an SI unit",
                    first_role(block, literal.arguments),
                )
                found.add("unit", block, {}, declared, f"got {predicate.unit}", role)
            seen.add(predicate)
        for role, sort in block.roles.items():
            if isinstance(sort, type):
                _check_class(task, block, role, sort, found)


def is_foreign(unit: str) -> bool:
    """Return whether a unit contains a part that is no SI unit without prefix, e.g. ``mm`` or ``deg/s``."""
    return not _FOREIGN.isdisjoint(re.split(r"[\s/*^()0-9²³·-]+", unit))


def _named_units(block: Block) -> Iterator[tuple[str, str]]:
    yield from ((each.name, each.unit) for each in block.hyperparameters)
    yield from ((each.name, each.unit) for each in block.performance)


def _check_class(task: Task, block: Block, role: str, sort: type[ObjectClass], found: Disagreements) -> None:
    """Check the units of a class's declarations, and angles of the class's tokens that are probably in degrees."""
    named = {each.name: each.unit for each in sort.varying} | {each.name: each.unit for each in sort.basic_actions}
    for name, field in sort.model_fields.items():
        extra = field.json_schema_extra
        named[name] = str(extra.get("unit", "1")) if isinstance(extra, dict) else "1"
    for name, unit in named.items():
        if is_foreign(unit):
            found.add("unit", block, {}, f"the unit of {name} of {sort.name} must be an SI unit", f"got {unit}", role)
        for token in task.tokens:
            value = token.properties.get(name) if token.is_member(sort) else None
            if unit in ("rad", "m") and isinstance(value, float) and abs(value) > LARGEST[unit]:
                declared = f"the property {name} of {sort.name} is plausible for the unit {unit}"
                found.add("unit", block, {}, declared, f"got {value:g} {unit} for {token.name}", role)
