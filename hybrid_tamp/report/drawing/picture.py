"""Draw the layout of a network as SVG or PNG."""

from collections.abc import Iterator
from io import BytesIO
from typing import TYPE_CHECKING, Any, Literal

from hybrid_tamp.model.plan import split_mode
from hybrid_tamp.report.drawing.layout import DrawnWire, Layout, Point, Rectangle
from hybrid_tamp.report.drawing.palette import BOX, INK, MIXED, MODE, PAGE, TITLE, class_colours, darker
from hybrid_tamp.report.drawing.sizes import SLOT_SIZE, TITLE_SIZE, text_width

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_BORDER, _LEGEND, _POINTS = 22.0, 18.0, 72.0
"""Width of the border of the page, height of a row of the legend [pt], and points per inch."""
_RESOLUTION = 180
"""Resolution of a PNG [px/inch]."""
_LINE, _HEAD, _RADIUS = 1.6, 6.0, 5.0
"""Width of lines, length of arrow heads, and radius of corners [pt]."""


_SWATCH, _SPACE = 18.0, 5.0
"""Width of a coloured field of the legend, and its distance from the text [pt]."""


def draw_layout(layout: Layout, kind: Literal["svg", "png"]) -> bytes:
    """Return a picture of a layout. Equal layouts give equal bytes."""
    import matplotlib
    from matplotlib.figure import Figure

    legend = _Legend(layout)
    width, height = legend.width + 2 * _BORDER, layout.height + 2 * _BORDER + legend.height
    # The salt makes the names inside an SVG repeatable. Outlines of letters look the same with all fonts.
    with matplotlib.rc_context({"svg.hashsalt": "hybrid-tamp", "svg.fonttype": "path", "font.family": "DejaVu Sans"}):
        figure = Figure(figsize=(width / _POINTS, height / _POINTS), facecolor=PAGE)
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0), xlim=(-_BORDER, width - _BORDER), ylim=(height - _BORDER, -_BORDER))
        axes.set_axis_off()
        _draw(axes, layout)
        legend.draw(axes)
        file = BytesIO()
        metadata = {"Date": None} if kind == "svg" else {"Software": None}
        figure.savefig(file, format=kind, metadata=metadata, dpi=_RESOLUTION)
    return file.getvalue()


def _draw(axes: "Axes", layout: Layout) -> None:
    diagram, colours = layout.diagram, class_colours(layout.diagram.classes)
    for wire in layout.wires:
        name = diagram.wire_class(wire.wire)
        _draw_wire(axes, wire, MIXED if name is None else darker(colours[name]))
    for block, box in layout.boxes.items():
        _rounded(axes, box, 4.0, BOX)
        _title(axes, block, box, at_bottom=block == diagram.bar.block)
    for slot, pill in layout.slots.items():
        _rounded(axes, pill, 4.0, colours[diagram.class_of[slot]], edge=BOX)
        _text(axes, pill.x + pill.width / 2, pill.y + pill.height / 2, slot[1], SLOT_SIZE, INK)


def _rounded(axes: "Axes", box: Rectangle, radius: float, colour: str, edge: str | None = None) -> None:
    from matplotlib.patches import FancyBboxPatch

    style = f"round,pad=0,rounding_size={radius}"
    axes.add_patch(
        FancyBboxPatch(
            (box.x, box.y), box.width, box.height, style, facecolor=colour, edgecolor=edge or colour, linewidth=1.0, zorder=3
        )
    )


def _text(axes: "Axes", x: float, y: float, text: str, size: float, colour: str, **more: Any) -> None:
    style = {"ha": "center", "va": "center_baseline", "zorder": 5} | more
    axes.text(x, y, text, fontsize=size, color=colour, **style)


def _title(axes: "Axes", block: str, box: Rectangle, *, at_bottom: bool) -> None:
    x = box.x + box.width / 2
    action, mode = split_mode(block)
    if at_bottom:
        _text(axes, x, box.y + box.height - 9, block, TITLE_SIZE, TITLE, weight="bold")
        return
    _text(axes, x, box.y + (11 if mode else 15), action, TITLE_SIZE, TITLE, weight="bold")
    if mode:
        _text(axes, x, box.y + 23, mode, TITLE_SIZE - 1, MODE)


def _draw_wire(axes: "Axes", wire: DrawnWire, colour: str) -> None:
    from matplotlib.patches import Polygon

    paths = [*_paths(wire)]
    for path in paths:
        _line(axes, path, PAGE, _LINE + 3.0)  # a gap in the wires below shows which wires cross
    for path in paths:
        _line(axes, path, colour, _LINE)
    for x, y in _junctions(wire):
        axes.plot([x], [y], marker="o", markersize=4.2, color=colour, zorder=2)
    neighbours = _neighbours(wire)
    for _, end, into in wire.ends:
        if into:
            ((x, y),) = neighbours[end]
            along = ((end[0] > x) - (end[0] < x), (end[1] > y) - (end[1] < y))
            back = end[0] - _HEAD * along[0], end[1] - _HEAD * along[1]
            across = (-along[1] * _HEAD * 0.5, along[0] * _HEAD * 0.5)
            corners = [end, (back[0] + across[0], back[1] + across[1]), (back[0] - across[0], back[1] - across[1])]
            axes.add_patch(Polygon(corners, closed=True, facecolor=colour, edgecolor="none", zorder=4))


def _line(axes: "Axes", points: list[Point], colour: str, width: float, **more: Any) -> None:
    """Draw a line with rounded corners."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    vertices, codes = [points[0]], [Path.MOVETO]
    for before, corner, after in zip(points, points[1:], points[2:], strict=False):
        vertices += [_towards(corner, before), corner, _towards(corner, after)]
        codes += [Path.LINETO, Path.CURVE3, Path.CURVE3]
    path = Path([*vertices, points[-1]], [*codes, Path.LINETO])
    style = {"facecolor": "none", "edgecolor": colour, "linewidth": width, "capstyle": "butt", "zorder": 2} | more
    axes.add_patch(PathPatch(path, **style))


def _towards(corner: Point, other: Point) -> Point:
    """Return the point at which the rounding of a corner begins."""
    length = abs(other[0] - corner[0]) + abs(other[1] - corner[1])
    share = min(_RADIUS, length / 2) / length if length else 0.0
    return corner[0] + share * (other[0] - corner[0]), corner[1] + share * (other[1] - corner[1])


def _neighbours(wire: DrawnWire) -> dict[Point, list[Point]]:
    found: dict[Point, list[Point]] = {}
    for one, other in wire.lines:
        if one != other:
            found.setdefault(one, []).append(other)
            found.setdefault(other, []).append(one)
    return found


def _junctions(wire: DrawnWire) -> list[Point]:
    return [point for point, others in _neighbours(wire).items() if len(set(others)) > 2]


def _paths(wire: DrawnWire) -> Iterator[list[Point]]:
    """Yield the corners of each path between two ends or junctions of a wire."""
    neighbours = _neighbours(wire)
    stops = {point for point, others in neighbours.items() if len(others) != 2}
    for stop in sorted(stops):
        for following in neighbours[stop]:
            path = [stop, following]
            while path[-1] not in stops:
                path.append(next(point for point in neighbours[path[-1]] if point != path[-2]))
            if path[0] <= path[-1]:
                yield _corners(path)


def _corners(path: list[Point]) -> list[Point]:
    """Return the path without points on straight lines."""
    inner = [
        point
        for before, point, after in zip(path, path[1:], path[2:], strict=False)
        if len({before[0], point[0], after[0]}) > 1 and len({before[1], point[1], after[1]}) > 1
    ]
    return [path[0], *inner, path[-1]]


class _Legend:
    """The classes of a drawing with their colours, in rows below the drawing."""

    def __init__(self, layout: Layout) -> None:
        self._names, self._top = layout.diagram.shown_classes, layout.height + _LEGEND
        self._colours = class_colours(layout.diagram.classes)
        widths = [_SWATCH + _SPACE + text_width(name, SLOT_SIZE, False) for name in self._names]
        self.width = max(layout.width, *widths)
        self._places, x, row = list[Point](), 0.0, 0
        for width in widths:
            if x + width > self.width:
                x, row = 0.0, row + 1
            self._places.append((x, self._top + row * _LEGEND))
            x += width + 3 * _SPACE
        self.height = (row + 1) * _LEGEND

    def draw(self, axes: "Axes") -> None:
        """Draw the legend."""
        for name, (x, y) in zip(self._names, self._places, strict=True):
            _rounded(axes, Rectangle(x, y - 6, _SWATCH, 12), 3.0, self._colours[name], edge=BOX)
            _text(axes, x + _SWATCH + _SPACE, y, name, SLOT_SIZE, INK, ha="left")
