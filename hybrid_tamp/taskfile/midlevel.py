"""Read the weights of measures and the bounds of hyperparameters in a task file, and apply them to the domain.

``BLOCK`` in ``BLOCK.name`` is a block with its mode, or an action with all its modes. An entry for a mode takes
precedence over an entry for the action.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import islice
from typing import Any, Literal

import numpy as np

from hybrid_tamp.model.authored import authored
from hybrid_tamp.model.bindings import enumerate_bindings
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.control import Hyperparameter
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.taskfile.places import Faults, KeyPath, shown
from hybrid_tamp.taskfile.wording import advise_radians

MOST_BINDINGS = 10_000
"""Maximum number of bindings that are checked for a block."""
MOST_SHOWN = 5
"""Maximum number of bounds that a message shows."""

Declared = Literal["weights", "hyperparameters"]
_WORDS: Mapping[Declared, str] = {"weights": "measure", "hyperparameters": "hyperparameter"}


@dataclass(frozen=True)
class _Constant:
    """Initial value of a hyperparameter whose value is set in the task file."""

    value: float

    def __call__(self, binding: Binding, state: State) -> FloatArray:
        return np.full(state.values.shape[:-1], self.value)


def read_midlevel(data: dict[str, Any], faults: Faults, domain: Domain | None) -> Domain | None:
    """Return the domain with the weights and bounds of the task file, and record faults."""
    if domain is None:
        return None
    weights = _said(data, "weights", faults, domain)
    ranges = _said(data, "hyperparameters", faults, domain)
    changed = [_changed(block, weights, ranges, faults) for block in domain.blocks]
    new = [block for block in changed if block not in domain.blocks]
    return domain.with_blocks(new) if new and faults.sound(("midlevel",)) else domain


def check_bindings(task: Task, data: dict[str, Any], faults: Faults) -> None:
    """Record a fault if no tokens satisfy a hyperparameter's bounds, e.g. a grasp beyond the end of every handle."""
    for (block, name), (path, _) in _said(data, "hyperparameters", faults, task.domain).items():
        own = next(each for each in task.domain.block_by_name[block].hyperparameters if each.name == name)
        if own.within is None:
            continue
        ranges = []
        for binding in islice(enumerate_bindings(task.choices(task.domain.block_by_name[block])), MOST_BINDINGS):
            with authored(f"{block}.{name}", binding):
                ranges.append(own.within(binding))
        if ranges and all(high < own.lower or low > own.upper for low, high in ranges):
            allowed = ", ".join(list(dict.fromkeys(f"{low:g} to {high:g}" for low, high in ranges))[:MOST_SHOWN])
            wanted = f"{path[-1]} must be within the bounds of at least one token of the task: {allowed}"
            faults.at(path, wanted, f"{own.lower:g} to {own.upper:g}")


def names_of(domain: Domain, kind: Declared) -> dict[str, list[tuple[Block, str]]]:
    """Return a mapping from each valid ``BLOCK.name`` to the pairs of (block, name) for which the key stands."""
    found: dict[str, list[tuple[Block, str]]] = {}
    for block in domain.blocks:
        for each in block.performance if kind == "weights" else block.hyperparameters:
            for owner in dict.fromkeys((block.name, block.action)):
                found.setdefault(f"{owner}.{each.name}", []).append((block, each.name))
    return found


_Said = dict[tuple[str, str], tuple[KeyPath, Any]]
"""Maps (block, hyperparameter or measure) to (path in the file, value in the file)."""


def _said(data: dict[str, Any], kind: Declared, faults: Faults, domain: Domain) -> _Said:
    section = data.get("midlevel")
    given = section.get(kind) if isinstance(section, dict) else None
    entries = given if isinstance(given, dict) else {}
    known = names_of(domain, kind)
    found: _Said = {}
    # Entries for actions are read first, so that entries for modes replace them.
    for key in sorted(entries, key=lambda key: ":" in key):
        path: KeyPath = ("midlevel", kind, key)
        if key not in known:
            wanted = f"must be 'BLOCK.name' with a {_WORDS[kind]} of the domain {domain.name}"
            remedy = "" if known else f"no block of {domain.name} has a {_WORDS[kind]}"
            faults.at(path, wanted, shown(key), list(known), remedy, key=True)
        elif faults.sound(path):
            found |= {(block.name, name): (path, entries[key]) for block, name in known[key]}
    return found


def _changed(block: Block, weights: _Said, ranges: _Said, faults: Faults) -> Block:
    """Return the block with the weights and bounds of the file, or the same block if nothing changes."""
    measures = tuple(
        replace(each, weight=float(weights[block.name, each.name][1])) if (block.name, each.name) in weights else each
        for each in block.performance
    )
    hyperparameters = tuple(
        _narrowed(each, *ranges[block.name, each.name], faults) if (block.name, each.name) in ranges else each
        for each in block.hyperparameters
    )
    if measures == block.performance and hyperparameters == block.hyperparameters:
        return block
    return replace(block, performance=measures, hyperparameters=hyperparameters)


def _narrowed(own: Hyperparameter, path: KeyPath, said: Any, faults: Faults) -> Hyperparameter:
    """Return a hyperparameter with the bounds and default of the task, or fixed at a number."""
    if not isinstance(said, dict):
        number = float(said)
        _check_within(number, own, f"the fixed value of {path[-1]}", path, faults)
        return replace(own, lower=number, upper=number, initial=_Constant(number))
    given = {key: float(value) for key, value in said.items() if value is not None}
    for key in ("lower", "upper"):
        if key in given:
            _check_within(given[key], own, f"{key} of {path[-1]}", (*path, key), faults)
    narrow = replace(own, lower=given.get("lower", own.lower), upper=given.get("upper", own.upper))
    if not faults.sound(path):
        return own
    if narrow.lower > narrow.upper:
        came = f"{narrow.lower:g} and {narrow.upper:g}"
        faults.at(path, f"lower must not exceed upper in {path[-1]}", came, remedy="exchange the bounds")
    elif "default" in given:
        _check_within(given["default"], narrow, f"the default of {path[-1]}", (*path, "default"), faults)
        return replace(narrow, initial=_Constant(given["default"]))
    return narrow


def _check_within(value: float, bounds: Hyperparameter, what: str, path: KeyPath, faults: Faults) -> None:
    if not bounds.lower <= value <= bounds.upper:
        unit = "" if bounds.unit == "1" else f" [{bounds.unit}]"
        wanted = f"{what} must be between {bounds.lower:g} and {bounds.upper:g}{unit}"
        faults.at(path, wanted, faults.shown(path, value), remedy=advise_radians(bounds.unit, value))
