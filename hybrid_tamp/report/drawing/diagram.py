"""The content of a drawing of a reassignment network: boxes with slots, and the wires between the slots."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

from hybrid_tamp.model.affordance import TOKEN
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.network import SlotName
from hybrid_tamp.report.drawing.wires import Edge, Wire, join_edges


@dataclass(frozen=True)
class Box:
    """A block of the diagram.

    Attributes:
        block: name of the block.
        slots: names of the block's slots, in the order of the declaration.
    """

    block: str
    slots: tuple[str, ...]


@dataclass(frozen=True)
class Mark:
    """The path of a token through the network.

    Attributes:
        token: name of the token.
        slots: slots of the token in a plan, in the order of time.
        steps: steps of the plan during which the token is in each slot, as pairs of (first, last).
    """

    token: str
    slots: tuple[SlotName, ...]
    steps: tuple[tuple[int, int], ...]

    @property
    def edges(self) -> tuple[Edge, ...]:
        """Edges along which the token passes, in the order of time."""
        return tuple(pairwise(self.slots))


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
        marks: paths of tokens that are marked.
    """

    title: str
    boxes: tuple[Box, ...]
    bar: Box
    wires: tuple[Wire, ...]
    class_of: dict[SlotName, str]
    classes: tuple[str, ...]
    marks: tuple[Mark, ...] = ()

    @cached_property
    def bar_slots(self) -> frozenset[SlotName]:
        """Slots of the bar."""
        return frozenset((self.bar.block, slot) for slot in self.bar.slots)

    @property
    def shown_classes(self) -> tuple[str, ...]:
        """Names of the classes that slots of the diagram have, in the order of the domain."""
        shown = set(self.class_of.values())
        return tuple(name for name in self.classes if name in shown)

    @cached_property
    def passed(self) -> dict[Edge, tuple[str, ...]]:
        """Maps each edge on a marked path to the names of the tokens that pass."""
        edges = sorted({edge for mark in self.marks for edge in mark.edges})
        return {edge: tuple(mark.token for mark in self.marks if edge in mark.edges) for edge in edges}

    @cached_property
    def busy(self) -> dict[str, tuple[int, ...]]:
        """Maps each block on a marked path to the steps of the plan during which tokens are in the block."""
        found: dict[str, set[int]] = {}
        for mark in self.marks:
            for (block, _), (first, last) in zip(mark.slots, mark.steps, strict=True):
                found.setdefault(block, set()).update(range(first, last + 1))
        return {block: tuple(sorted(steps)) for block, steps in found.items()}

    def wire_class(self, wire: Wire) -> str | None:
        """Return the class of the tokens in a wire, or None if the slots at its ends have different classes."""
        ends = {self.class_of[slot] for slot in (*wire.sources, *wire.targets) if slot not in self.bar_slots}
        return ends.pop() if len(ends) == 1 else None


def make_diagram(domain: Domain, marks: Iterable[Mark] = ()) -> Diagram:
    """Return the diagram of a domain's network, with the paths of a plan's tokens."""
    class_of = {(block.name, slot.name): slot.object_class.name for block in domain.blocks for slot in block.slots}

    def label(slot: SlotName, other: SlotName) -> str:
        # Tokens of all classes rest in one slot. Each class has wires of its own, so that a wire has one colour.
        return class_of[other] if slot[0] == domain.resting else ""

    boxes = {block.name: Box(block.name, tuple(slot.name for slot in block.slots)) for block in domain.blocks}
    bar = boxes.pop(domain.resting)
    classes = (*(each.name for each in domain.classes if each is not TOKEN), TOKEN.name)
    edges = set(domain.network.edges)
    mutual = sorted((one, other) for one, other in edges if one[0] == bar.block != other[0] and (other, one) in edges)
    # Each line to the bar is separate, so lines in both directions save more than joined lines.
    wires = [Wire((one,), (other,), both_ways=True) for one, other in mutual]
    wires += join_edges(edges.difference(*(wire.edges for wire in wires)), label)
    return Diagram(domain.name, tuple(boxes.values()), bar, tuple(wires), class_of, classes, tuple(marks))
