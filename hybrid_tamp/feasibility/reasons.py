"""Reasons in words, and the same reason of several modes of an action said once."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.plan import split_mode


@dataclass(frozen=True)
class Reason:
    """One reason why a goal atom cannot be reached.

    Attributes:
        goal: the goal atom, or several.
        block: the block that would bring it about, or empty; the action's name where it is about several modes.
        kind: ``no_block``, ``no_token``, ``too_few_tokens``, ``no_edge``, ``not_feasible`` or ``together``.
        message: the reason in words.
        atom: the failing condition, or empty.
        margin: its margin, or None.
        unit: unit of the margin.
        lacks: what there is too little of: the name of a class, or the slot ``"BLOCK.slot"`` to which no edge leads.
    """

    goal: str
    block: str
    kind: str
    message: str
    atom: str = ""
    margin: float | None = None
    unit: str = ""
    lacks: str = ""


TOGETHER = "together"
"""The kind of reason that says only that there is none of another kind."""

BLOCK = "\N{OBJECT REPLACEMENT CHARACTER}"
"""Stands in a message for the block's name until it is known for which modes the message holds."""


def about(
    block: Block,
    kind: str,
    message: str,
    atom: str = "",
    margin: float | None = None,
    unit: str = "",
    lacks: str = "",
) -> Reason:
    """Return a reason of a block for a goal not named yet; in the message `BLOCK` stands for its name."""
    return Reason("", block.name, kind, message, atom, margin, unit, lacks)


def merged(goal: str, reasons: Iterable[Reason]) -> list[Reason]:
    """Return the reasons for a goal, each once: what is the same for several modes of an action names them all."""
    groups: dict[Reason, list[str]] = {}
    for reason in reasons:
        action, mode = split_mode(reason.block)
        modes = groups.setdefault(replace(reason, goal=goal, block=action), [])
        if mode and mode not in modes:
            modes.append(mode)
    return [_named(reason, modes) for reason, modes in groups.items()]


def _named(reason: Reason, modes: list[str]) -> Reason:
    name = f"{reason.block}:{modes[0]}" if len(modes) == 1 else reason.block
    label = f"{name} ({', '.join(modes)})" if len(modes) > 1 else name
    return replace(reason, block=name, message=reason.message.replace(BLOCK, label))
