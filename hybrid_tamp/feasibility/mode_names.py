"""Merging of equal reasons for several modes of an action into one reason."""

from collections.abc import Iterable
from dataclasses import replace

from hybrid_tamp.model.explanation import Reason
from hybrid_tamp.model.plan import split_mode
from hybrid_tamp.model.predicate import Atom

BLOCK = "\N{OBJECT REPLACEMENT CHARACTER}"
"""Placeholder for the block's name in a message. `merge_reasons` replaces the placeholder."""


def merge_reasons(goal: Atom, reasons: Iterable[Reason]) -> list[Reason]:
    """Return the reasons for a goal without duplicates. A reason that applies to several modes names all of them."""
    groups: dict[Reason, list[str]] = {}
    for reason in reasons:
        action, mode = split_mode(reason.block)
        modes = groups.setdefault(replace(reason, goal=(goal,), block=action), [])
        if mode and mode not in modes:
            modes.append(mode)
    return [_name_block(reason, modes) for reason, modes in groups.items()]


def _name_block(reason: Reason, modes: list[str]) -> Reason:
    name = f"{reason.block}:{modes[0]}" if len(modes) == 1 else reason.block
    label = f"{name} ({', '.join(modes)})" if len(modes) > 1 else name
    return replace(reason, block=name, message=reason.message.replace(BLOCK, label))
