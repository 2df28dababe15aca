"""Frame conditions: which predicates a block can change, and which it keeps without a declaration.

A block keeps the atoms of a predicate if the block writes nothing that the predicate reads. Facts that a block
maintains end with the block, and facts about the initial state never change. A predicate that only invariants mention
is measured while a block runs, but is never required to begin or to end a block, so no effect on it is planned.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from hybrid_tamp.errors import Issue
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.declarations import Declarations
from hybrid_tamp.model.predicate import Predicate, SymbolSort


@dataclass(frozen=True)
class Change:
    """Properties of a slot's token that a block writes and a predicate reads.

    Attributes:
        slot: name of the slot.
        parameter: name of the parameter whose token can be in the slot.
        names: names of the properties, sorted.
        handled: whether an exit condition or an invariant of the block has the slot as this argument.
    """

    slot: str
    parameter: str
    names: tuple[str, ...]
    handled: bool


def find_frame_faults(domain: Declarations) -> Iterator[Issue]:
    """Yield a fault for each predicate that a block may change without declaring an effect or listing it in `keeps`."""
    for block in domain.blocks:
        for predicate in domain.predicates:
            # The planner tracks the movements of tokens in order to evaluate feasibility facts.
            if predicate in block.keeps or predicate.static or explain_kept(domain, block, predicate):
                continue
            for change in find_changes(domain, block, predicate):
                if not change.handled:
                    yield Issue(
                        f"{block.name}.{change.slot}",
                        f"the block must declare its effect on {predicate.name}({change.parameter}), "
                        f"because the block writes {', '.join(change.names)}",
                        remedy=f"add {predicate.name} to the exit conditions or to 'keeps'",
                    )


def explain_kept(domain: Declarations, block: Block, predicate: Predicate) -> str:
    """Return why a block keeps a predicate without a declaration, or an empty string if `keeps` must list it."""
    if predicate.maintained:
        return f"{predicate.name} is maintained, so its facts end with the block that made them true"
    if predicate.at_start:
        return f"{predicate.name} describes the initial state"
    if not any(find_changes(domain, block, predicate)):
        return f"the block writes nothing that {predicate.name} reads"
    if not predicate.static and _only_measured(domain, predicate):
        return f"no entry or exit condition mentions {predicate.name}"
    return ""


def find_changes(domain: Declarations, block: Block, predicate: Predicate) -> Iterator[Change]:
    """Yield the properties that a block writes and a predicate reads, for each slot and parameter."""
    conditions = [each for each in (*block.exit, *block.invariants) if each.predicate is predicate]
    for slot, written in block.writes.items():
        for index, parameter in enumerate(predicate.parameters):
            names = sorted(set(predicate.reads.get(parameter.name, ())) & set(written))
            if not names or isinstance(parameter.sort, SymbolSort):
                continue
            if domain.relations.can_share_token(parameter.sort, block.slot(slot).object_class):
                handled = any(each.arguments[index] == slot for each in conditions)
                yield Change(slot, parameter.name, tuple(names), handled)


def _only_measured(domain: Declarations, predicate: Predicate) -> bool:
    planned = (each for block in domain.blocks for each in (*block.entry, *block.exit))
    measured = (each for block in domain.blocks for each in block.invariants)
    return any(each.predicate is predicate for each in measured) and not any(
        each.predicate is predicate for each in planned
    )
