"""Sizes of boxes and slots, in units of the grid on which wires run."""

from dataclasses import dataclass
from functools import cached_property

from hybrid_tamp.model.network import SlotName
from hybrid_tamp.model.plan import split_mode
from hybrid_tamp.report.drawing.diagram import Box, Diagram

GRID = 7.0
"""Distance between two neighbouring wires [pt]."""
TITLE_SIZE, SLOT_SIZE = 11.0, 10.5
"""Font sizes of the titles of blocks and of the names of slots [pt]."""
_FEWEST_PINS = 3
"""Minimum number of wires that can end at one side of a slot. The name of the slot needs this height."""
_PADDING = 2
"""Width of a box beside its text, on both sides together."""


@dataclass(frozen=True, eq=False)
class Sizes:
    """Sizes in a diagram.

    Attributes:
        diagram: the diagram.
        width: width of all boxes.
        title: height of the title of a box.
    """

    diagram: Diagram
    width: int
    title: int

    @classmethod
    def of(cls, diagram: Diagram) -> "Sizes":
        """Return the sizes at which all names fit into the boxes."""
        boxes = (*diagram.boxes, diagram.bar)
        names = [box.block for box in boxes]
        texts = [(part, TITLE_SIZE, True) for name in names for part in split_mode(name) if part]
        texts += [(slot, SLOT_SIZE, False) for box in boxes for slot in box.slots]
        widest = max(text_width(*each) for each in texts)
        return cls(diagram, _PADDING + int(-(-widest // GRID)), 5 if any(split_mode(name)[1] for name in names) else 4)

    @cached_property
    def pins(self) -> dict[SlotName, int]:
        """Maps each slot to the number of wires that can end at one of its sides."""
        ends = [slot for wire in self.diagram.wires for slot in (*wire.sources, *wire.targets)]
        return {slot: max(_FEWEST_PINS, -(-ends.count(slot) // 2)) for slot in self.diagram.class_of}

    def tops(self, box: Box, order: tuple[str, ...]) -> dict[SlotName, int]:
        """Map each slot to the height of its first pin below the top of its box."""
        found, top = {}, self.title
        for slot in order:
            found[box.block, slot] = top
            top += self.pins[box.block, slot] + 1
        return found

    def height(self, box: Box) -> int:
        """Return the height of a box."""
        return self.title + sum(self.pins[box.block, slot] + 1 for slot in box.slots)


def text_width(text: str, size: float, bold: bool) -> float:
    """Return the width of a text in the font of the drawing [pt]."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import TextPath

    font = FontProperties(family="DejaVu Sans", weight="bold" if bold else "normal")
    return float(TextPath((0, 0), text, size=size, prop=font).get_extents().width)
