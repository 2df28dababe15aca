"""Entry conditions that never hold, or that no block establishes."""

from collections.abc import Sequence

from hybrid_tamp.model.bindings import enumerate_bindings
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.predicate import Literal
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.testing.disagreement import Disagreements, first_role, with_unit


def report_closed(task: Task, block: Block, states: Sequence[State], found: Disagreements) -> None:
    """Report a block whose entry conditions and invariants did not hold in any state that was reached.

    The conditions that never hold for any tokens are reported one by one. If there are none, the conditions held only
    at different times or for different tokens. A condition that fails for all tokens although tokens start in the block
    has probably the wrong sign.

    Args:
        task: task that has the tokens.
        block: block that was never rolled out.
        states: states that were reached.
        found: collection to which the disagreements are added.
    """
    never = "did not hold in any state that was reached"
    starting = {task.start_block(token.name) for token in task.assigned}
    alone = False
    for literal in dict.fromkeys((*block.entry, *block.invariants)):
        best = _largest(task, block, literal, states)
        if best is not None and best < 0:
            measured = f"the condition {never}; the largest margin is {with_unit(best, literal.predicate)}"
            declared, kind = f"the entry condition {literal.text} can hold", "entry"
            if block in starting:
                declared, kind = f"the entry condition {literal.text} holds for tokens that start in this block", "sign"
            found.add(kind, block, {}, declared, measured, first_role(block, literal.arguments))
            alone = True
    if not alone:
        measured = f"taken together, the conditions {never} ({len(states)} states)"
        found.add("entry", block, {}, "the entry conditions can hold", measured)


def _largest(task: Task, block: Block, literal: Literal, states: Sequence[State]) -> float | None:
    """Return the largest margin of a condition over all states and tokens, or None if no tokens fit."""
    choices = {role: values for role, values in task.choices(block).items() if role in literal.arguments}
    states = states[:1] if literal.predicate.at_start else states
    margins = [float(literal.margin(state, bound)) for bound in enumerate_bindings(choices) for state in states]
    return max(margins, default=None)


def report_unestablished(task: Task, blocks: Sequence[Block], found: Disagreements) -> None:
    """Report each entry condition on a maintained predicate that no block establishes.

    A maintained condition holds only after a block that has the condition as an exit condition. The initial state does
    not establish the condition, even if its margin is positive.
    """
    established = {literal.predicate for block in blocks for literal in block.exit if literal.positive}
    for block in blocks:
        for literal in block.changing_entry:
            if literal.positive and literal.predicate.maintained and literal.predicate not in established:
                declared = f"a block establishes the entry condition {literal.text}"
                measured = f"none of {len(blocks)} blocks has {literal.predicate.name} as an exit condition"
                found.add("entry", block, {}, declared, measured, first_role(block, literal.arguments))
