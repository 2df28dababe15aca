"""The legend of a drawing: the colours of classes and of marked tokens, in rows below the drawing."""

from typing import TYPE_CHECKING

from hybrid_tamp.report.drawing.layout import Layout, Point, Rectangle
from hybrid_tamp.report.drawing.palette import BOX, INK, class_colours, token_colours
from hybrid_tamp.report.drawing.pens import draw_rectangle, draw_stroke, draw_text
from hybrid_tamp.report.drawing.sizes import SLOT_SIZE, text_width

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_ROW, _SWATCH, _SPACE = 18.0, 18.0, 5.0
"""Height of a row, width of a coloured field, and distance between a field and its text [pt]."""


class Legend:
    """The classes and marked tokens of a drawing.

    Attributes:
        width: width of the page without its border, which is at least that of the longest entry [pt].
        height: height of the legend [pt].
    """

    def __init__(self, layout: Layout) -> None:
        diagram = layout.diagram
        classes, tokens = class_colours(diagram.classes), token_colours(diagram)
        groups = [[(name, classes[name]) for name in diagram.shown_classes], [*tokens.items()]]
        widths = {name: _SWATCH + _SPACE + text_width(name, SLOT_SIZE, False) for group in groups for name, _ in group}
        self.width = max(layout.width, *widths.values())
        self._entries = list[tuple[str, str, bool, Point]]()
        y = layout.height
        for group, is_token in zip(groups, (False, True), strict=True):
            x, y = 0.0, y + _ROW * bool(group)
            for name, colour in group:
                if x + widths[name] > self.width:
                    x, y = 0.0, y + _ROW
                self._entries.append((name, colour, is_token, (x, y)))
                x += widths[name] + 3 * _SPACE
        self.height = y - layout.height

    def draw(self, axes: "Axes") -> None:
        """Draw the legend."""
        for name, colour, is_token, (x, y) in self._entries:
            if is_token:
                draw_stroke(axes, ((x, y), (x + _SWATCH, y)), [colour], 3.0)
            else:
                draw_rectangle(axes, Rectangle(x, y - 6, _SWATCH, 12), 3.0, colour, BOX)
            draw_text(axes, (x + _SWATCH + _SPACE, y), name, SLOT_SIZE, INK, ha="left")
