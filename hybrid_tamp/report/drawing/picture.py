"""Draw the layout of a network as SVG or PNG."""

from io import BytesIO
from typing import TYPE_CHECKING, Literal

from hybrid_tamp.model.plan import split_mode
from hybrid_tamp.report.drawing.layout import DrawnWire, Layout, Rectangle
from hybrid_tamp.report.drawing.legend import Legend
from hybrid_tamp.report.drawing.palette import (
    BOX,
    INK,
    MODE,
    PAGE,
    TITLE,
    class_colours,
    paler,
    token_colours,
    wire_colour,
)
from hybrid_tamp.report.drawing.pens import draw_dot, draw_head, draw_rectangle, draw_stroke, draw_text
from hybrid_tamp.report.drawing.sizes import SLOT_SIZE, TITLE_SIZE
from hybrid_tamp.report.drawing.strokes import before, entered_ends, junctions, strokes, token_strokes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_BORDER, _POINTS = 22.0, 72.0
"""Width of the border of the page [pt], and points per inch."""
_RESOLUTION = 180
"""Resolution of a PNG [px/inch]."""
_LINE, _PATH, _GAP = 1.6, 3.2, 3.0
"""Widths of lines, of the paths of tokens, and of the gap in a line that another line crosses [pt]."""


def draw_layout(layout: Layout, kind: Literal["svg", "png"]) -> bytes:
    """Return a picture of a layout. Equal layouts give equal bytes."""
    import matplotlib
    from matplotlib.figure import Figure

    legend = Legend(layout)
    width, height = legend.width + 2 * _BORDER, layout.height + 2 * _BORDER + legend.height
    # The salt makes the names inside an SVG repeatable. Outlines of letters look the same with all fonts.
    with matplotlib.rc_context({"svg.hashsalt": "hybrid-tamp", "svg.fonttype": "path", "font.family": "DejaVu Sans"}):
        figure = Figure(figsize=(width / _POINTS, height / _POINTS), facecolor=PAGE)
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        axes.set(xlim=(-_BORDER, width - _BORDER), ylim=(height - _BORDER, -_BORDER))
        axes.set_axis_off()
        for wire in layout.wires:
            _draw_wire(axes, layout, wire)
        for wire in layout.wires:
            _draw_tokens(axes, layout, wire)
        _draw_boxes(axes, layout)
        legend.draw(axes)
        file = BytesIO()
        metadata = {"Date": None} if kind == "svg" else {"Software": None}
        figure.savefig(file, format=kind, metadata=metadata, dpi=_RESOLUTION)
    return file.getvalue()


def _draw_boxes(axes: "Axes", layout: Layout) -> None:
    diagram, colours = layout.diagram, class_colours(layout.diagram.classes)
    idle = {block for block in layout.boxes if diagram.marks and block not in diagram.busy}
    for block, box in layout.boxes.items():
        colour = paler(BOX) if block in idle else BOX
        draw_rectangle(axes, box, 4.0, colour, colour)
        _draw_title(axes, block, box, at_bottom=block == diagram.bar.block)
        if block in diagram.busy and block != diagram.bar.block:
            draw_text(axes, (box.x + box.width / 2, box.y - 5), _steps_text(diagram.busy[block]), 7.0, INK)
    for slot, field in layout.slots.items():
        colour = colours[diagram.class_of[slot]]
        shown, edge, ink = (paler(colour), paler(BOX), paler(INK)) if slot[0] in idle else (colour, BOX, INK)
        draw_rectangle(axes, field, 4.0, shown, edge)
        draw_text(axes, (field.x + field.width / 2, field.y + field.height / 2), slot[1], SLOT_SIZE, ink)


def _draw_title(axes: "Axes", block: str, box: Rectangle, *, at_bottom: bool) -> None:
    x = box.x + box.width / 2
    action, mode = split_mode(block)
    if at_bottom:
        draw_text(axes, (x, box.y + box.height - 11), block, TITLE_SIZE, TITLE, weight="bold")
        return
    draw_text(axes, (x, box.y + (11 if mode else 15)), action, TITLE_SIZE, TITLE, weight="bold")
    if mode:
        draw_text(axes, (x, box.y + 23), mode, TITLE_SIZE - 1, MODE)


def _steps_text(steps: tuple[int, ...]) -> str:
    """Return the numbers of steps as text, e.g. ``steps 2-4, 6``."""
    groups: list[list[int]] = []
    for step in steps:
        if groups and groups[-1][-1] == step - 1:
            groups[-1].append(step)
        else:
            groups.append([step])
    ranges = ", ".join(str(group[0]) if len(group) == 1 else f"{group[0]}-{group[-1]}" for group in groups)
    return f"step{'s' * (len(steps) > 1)} {ranges}"


def _draw_wire(axes: "Axes", layout: Layout, wire: DrawnWire) -> None:
    colour = wire_colour(layout.diagram, wire.wire)
    if layout.diagram.marks:
        colour = paler(colour)
    lines = [*strokes(wire)]
    for line in lines:
        draw_stroke(axes, line, [PAGE], _LINE + _GAP)  # a gap in the line below shows that the lines do not meet
    for line in lines:
        draw_stroke(axes, line, [colour], _LINE)
    for point in junctions(wire):
        draw_dot(axes, point, colour)
    for _, end, into in wire.ends:
        if into:
            draw_head(axes, before(wire, end), end, colour)


def _draw_tokens(axes: "Axes", layout: Layout, wire: DrawnWire) -> None:
    """Draw the paths of tokens through a wire. If several tokens pass, their colours alternate."""
    passed, colours = layout.diagram.passed, token_colours(layout.diagram)
    lines = [*token_strokes(wire, passed)]
    for line, _ in lines:
        draw_stroke(axes, line, [PAGE], _PATH + _GAP)
    for line, tokens in lines:
        draw_stroke(axes, line, [colours[token] for token in tokens], _PATH)
    for end, tokens in entered_ends(wire, passed).items():
        draw_head(axes, before(wire, end), end, colours[tokens[0]] if len(tokens) == 1 else INK, 1.4)
