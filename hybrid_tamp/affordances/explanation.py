"""Why a task has no plan, read from its declarations: each reason is true and can be checked by hand.

For every goal atom that does not hold, the blocks that could bring it about are examined: a slot that no token can
fill, a token short, or a feasibility fact that fails for every choice of the remaining tokens, with its margin.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.facts import facts, static_facts
from hybrid_tamp.model.predicate import Atom, Literal, Value
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token


@dataclass(frozen=True)
class Reason:
    """One reason why a goal atom cannot be reached.

    Attributes:
        goal: the goal atom.
        block: the block that would bring it about, or empty.
        kind: ``no_block``, ``no_token``, ``too_few_tokens``, ``not_feasible`` or ``out_of_reach``.
        message: the reason in words.
        atom: the failing condition, or empty.
        margin: its margin, or None.
        unit: unit of the margin.
    """

    goal: str
    block: str
    kind: str
    message: str
    atom: str = ""
    margin: float | None = None
    unit: str = ""


def explain(task: Task) -> list[Reason]:
    """Return reasons why the goal cannot be reached; an empty list if none is visible in the declarations."""
    holding = facts(task) | static_facts(task)
    return [reason for atom in task.goal if atom not in holding for reason in _reasons(task, atom)]


def _reasons(task: Task, goal: Atom) -> Iterator[Reason]:
    achievers = [
        (block, literal)
        for block in task.domain.blocks
        for literal in block.exit
        if literal.positive and literal.predicate.name == goal.predicate
    ]
    if not achievers:
        yield Reason(str(goal), "", "no_block", f"no block of {task.domain.name} brings about {goal.predicate}")
    for block, literal in achievers:
        fixed = {argument: task.value(name) for argument, name in zip(literal.arguments, goal.arguments, strict=True)}
        yield from _for_block(task, goal, block, fixed)


def _for_block(task: Task, goal: Atom, block: Block, fixed: dict[str, Value]) -> Iterator[Reason]:
    for role, value in fixed.items():
        sort = block.roles.get(role)
        if isinstance(value, Token) and sort is not None and value not in task.values_of(sort):
            message = f"{value.name} is not a member of {sort.name}, which {role} of {block.name} needs"
            yield Reason(str(goal), block.name, "no_token", message)
            return
    missing = list(_missing(task, goal, block))
    yield from missing
    if not missing:
        yield from _infeasible(task, goal, block, fixed)


def _missing(task: Task, goal: Atom, block: Block) -> Iterator[Reason]:
    """Slots of one class need as many different tokens; what cannot be filled is named."""
    by_class: dict[str, list[str]] = {}
    for slot in block.slots:
        by_class.setdefault(slot.object_class.name, []).append(slot.name)
    for slot in block.slots:
        wanted = by_class[slot.object_class.name]
        have = len(task.values_of(slot.object_class))
        if slot.name == wanted[-1] and have < len(wanted):
            short = len(wanted) - have
            message = (
                f"slot {slot.name} of {block.name} can be filled by no token: {block.name} needs {len(wanted)} of "
                f"class {slot.object_class.name}, the task has {have}; {short} more would do"
            )
            yield Reason(str(goal), block.name, "too_few_tokens" if have else "no_token", message)


def _infeasible(task: Task, goal: Atom, block: Block, fixed: dict[str, Value]) -> Iterator[Reason]:
    """Feasibility facts that hold for no choice of tokens; the best choice's margin is given."""
    bindings = [b for b in task.bindings(block) if all(b.get(role) == value for role, value in fixed.items())]
    for literal in block.entry:
        if not literal.predicate.static or not bindings:
            continue
        best, binding = max(
            ((float(literal.margin(task.state, b)), b) for b in bindings), key=lambda candidate: candidate[0]
        )
        if best < 0:
            yield _reason(goal, block, literal, best, binding)


def _reason(goal: Atom, block: Block, literal: Literal, margin: float, binding: dict[str, Value]) -> Reason:
    atom = literal.ground(binding)
    message = f"{block.name} cannot: {literal.predicate.sentence(atom.arguments, not literal.positive)}"
    unit = "" if literal.predicate.unit == "1" else f" {literal.predicate.unit}"
    message += f" ({atom.predicate} fails by {-margin:.3g}{unit})"
    return Reason(str(goal), block.name, "not_feasible", message, str(atom), margin, literal.predicate.unit)
