"""The slots that tokens can reach along edges of the network, regardless of the conditions of blocks."""

from collections.abc import Collection

import networkx as nx

from hybrid_tamp.feasibility.bindings import Bound
from hybrid_tamp.feasibility.mode_names import BLOCK
from hybrid_tamp.model.bindings import Choices
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.explanation import Reason
from hybrid_tamp.model.network import SlotName, slot_text
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token

_SHOWN = 4


class Passages:
    """The slots that each token of a task can reach along edges. A token passes only through slots of its classes."""

    def __init__(self, task: Task, through: Collection[str] | None = None) -> None:
        """Set the task and the names of the blocks that tokens may pass through. None allows all blocks."""
        self._task = task
        self._through = task.domain.block_by_name if through is None else through
        self._classes = {
            (block.name, slot.name): slot.object_class for block in task.domain.blocks for slot in block.slots
        }
        self._known: dict[tuple[object, ...], frozenset[SlotName]] = {}

    def start(self, token: Token) -> SlotName:
        """Return the slot in which a token starts."""
        block = self._task.start_block(token.name)
        return (block.name, block.slots[0].name)

    def slots(self, token: Token) -> frozenset[SlotName]:
        """Return the slots that a token can reach, including the slot in which it starts."""
        key = (token.classes, start := self.start(token))
        if key not in self._known:
            graph = self._task.domain.network.graph
            mine = graph.subgraph(s for s in graph if s[0] in self._through and token.is_member(self._classes[s]))
            self._known[key] = frozenset({start} | (nx.descendants(mine, start) if start in mine else set()))
        return self._known[key]

    def allow(self, block: Block, bound: Bound) -> bool:
        """Say whether every token that a binding assigns to a slot of a block can reach this slot."""
        return all(
            (block.name, slot.name) in self.slots(token)
            for slot in block.slots
            if isinstance(token := bound.get(slot.name), Token)
        )

    def explain_missing(self, block: Block, allowed: Choices) -> list[Reason]:
        """Return a reason for each slot of the block that cannot be reached by any of the slot's allowed tokens."""
        found = []
        for slot in block.slots:
            tokens = [token for token in allowed[slot.name] if isinstance(token, Token)]
            if tokens and not any((block.name, slot.name) in self.slots(token) for token in tokens):
                where = sorted({slot_text(place) for token in tokens for place in self.slots(token)})
                shown = ", ".join(where[:_SHOWN]) + (", ..." if len(where) > _SHOWN else "")
                names = ", ".join(sorted(token.name for token in tokens))
                message = (
                    f"the network has no path for {names} to slot {slot.name} of {BLOCK}; "
                    f"the only slots within reach are {shown}"
                )
                found.append(Reason((), block.name, "no_edge", message, lacks=(block.name, slot.name)))
        return found
