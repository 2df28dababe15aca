"""Draw rounded rectangles, texts, lines and arrow heads with matplotlib."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from hybrid_tamp.report.drawing.layout import Point, Rectangle
from hybrid_tamp.report.drawing.strokes import Stroke

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_HEAD, _RADIUS, _DASH = 6.0, 5.0, 6.0
"""Length of arrow heads, radius of the corners of lines, and length of the dashes of alternating colours [pt]."""


def draw_rectangle(axes: "Axes", box: Rectangle, radius: float, colour: str, edge: str) -> None:
    """Draw a filled rectangle with rounded corners."""
    from matplotlib.patches import FancyBboxPatch

    style = f"round,pad=0,rounding_size={radius}"
    corner = (box.x, box.y)
    patch = FancyBboxPatch(
        corner, box.width, box.height, style, facecolor=colour, edgecolor=edge, linewidth=1, zorder=3
    )
    axes.add_patch(patch)


def draw_text(axes: "Axes", at: Point, text: str, size: float, colour: str, **more: Any) -> None:
    """Draw a text, by default around a point."""
    style: dict[str, Any] = {"ha": "center", "va": "center_baseline", "zorder": 5} | more
    axes.text(*at, text, fontsize=size, color=colour, **style)


def draw_stroke(axes: "Axes", stroke: Stroke, colours: Sequence[str], width: float) -> None:
    """Draw a line with rounded corners. Several colours alternate."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    vertices, codes = [stroke[0]], [Path.MOVETO]
    for before, corner, after in zip(stroke, stroke[1:], stroke[2:], strict=False):
        vertices += [_towards(corner, before), corner, _towards(corner, after)]
        codes += [Path.LINETO, Path.CURVE3, Path.CURVE3]
    path = Path([*vertices, stroke[-1]], [*codes, Path.LINETO])
    for index, colour in enumerate(colours):
        dashes = (-_DASH * index / width, (_DASH / width, _DASH * (len(colours) - 1) / width))
        style: Any = "solid" if len(colours) == 1 else dashes
        line = {"edgecolor": colour, "linewidth": width, "linestyle": style, "capstyle": "butt"}
        axes.add_patch(PathPatch(path, facecolor="none", zorder=2, **line))


def draw_dot(axes: "Axes", at: Point, colour: str) -> None:
    """Draw a dot, which shows that lines meet."""
    axes.plot([at[0]], [at[1]], marker="o", markersize=4.2, color=colour, zorder=2)


def draw_head(axes: "Axes", before: Point, end: Point, colour: str, scale: float = 1.0) -> None:
    """Draw the head of an arrow that comes from another point and touches its end."""
    from matplotlib.patches import Polygon

    size = _HEAD * scale
    x, y = ((end[axis] > before[axis]) - (end[axis] < before[axis]) for axis in (0, 1))
    back, side = (end[0] - size * x, end[1] - size * y), (-y * size / 2, x * size / 2)
    corners = [end, (back[0] + side[0], back[1] + side[1]), (back[0] - side[0], back[1] - side[1])]
    axes.add_patch(Polygon(corners, closed=True, facecolor=colour, edgecolor="none", zorder=2))


def _towards(corner: Point, other: Point) -> Point:
    """Return the point at which the rounding of a corner begins."""
    length = abs(other[0] - corner[0]) + abs(other[1] - corner[1])
    share = min(_RADIUS, length / 2) / length if length else 0.0
    return corner[0] + share * (other[0] - corner[0]), corner[1] + share * (other[1] - corner[1])
