"""The content of a drawing of a reassignment network: boxes with slots, and the wires between the slots."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

from hybrid_tamp.model.affordance import TOKEN
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.network import SlotName
from hybrid_tamp.report.drawing.wires import Wire, join_edges


@dataclass(frozen=True)
class Box:
    """A block of the diagram.

    Attributes:
        block: name of the block.
        slots: names of the block's slots, in the order of the declaration.
    """

    block: str
    slots: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Diagram:
    """The blocks and wires of a network.

    Attributes:
        title: name of the domain.
        boxes: all blocks except the resting block.
        bar: the resting block. It is drawn as a bar, because most blocks exchange tokens with it.
        wires: wires that together represent every edge exactly once.
        class_of: maps each slot to the name of its class.
        classes: names of the classes of the whole domain, which determine the colours.
    """

    title: str
    boxes: tuple[Box, ...]
    bar: Box
    wires: tuple[Wire, ...]
    class_of: dict[SlotName, str]
    classes: tuple[str, ...]

    @cached_property
    def bar_slots(self) -> frozenset[SlotName]:
        """Slots of the bar."""
        return frozenset((self.bar.block, slot) for slot in self.bar.slots)

    @property
    def shown_classes(self) -> tuple[str, ...]:
        """Names of the classes that slots of the diagram have, in the order of the domain."""
        shown = set(self.class_of.values())
        return tuple(name for name in self.classes if name in shown)

    def wire_class(self, wire: Wire) -> str | None:
        """Return the class of the tokens in a wire, or None if the slots at its ends have different classes."""
        ends = {self.class_of[slot] for slot in (*wire.sources, *wire.targets) if slot not in self.bar_slots}
        return ends.pop() if len(ends) == 1 else None


def make_diagram(domain: Domain, blocks: Iterable[str] | None = None) -> Diagram:
    """Return the diagram of a domain's network.

    Args:
        domain: the whole domain, so that a class has the same colour in all drawings.
        blocks: names of the blocks to draw; by default all blocks. The resting block is always drawn.
    """
    kept = set(domain.block_by_name if blocks is None else blocks) | {domain.resting}
    shown = [block for block in domain.blocks if block.name in kept]
    class_of = {(block.name, slot.name): slot.object_class.name for block in shown for slot in block.slots}

    def label(slot: SlotName, other: SlotName) -> str:
        # Tokens of all classes rest in one slot. Each class has wires of its own, so that a wire has one colour.
        return class_of[other] if slot[0] == domain.resting else ""

    boxes = {block.name: Box(block.name, tuple(slot.name for slot in block.slots)) for block in shown}
    bar = boxes.pop(domain.resting)
    classes = tuple(each.name for each in domain.classes if each is not TOKEN)
    network = domain.network.restrict(kept)
    return Diagram(
        domain.name, tuple(boxes.values()), bar, join_edges(network.edges, label), class_of, (*classes, TOKEN.name)
    )
