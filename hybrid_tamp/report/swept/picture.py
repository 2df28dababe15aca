"""The picture of a swept plan, which is the same in every format of matplotlib."""

from dataclasses import dataclass
from functools import cached_property
from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import ImageFont

from hybrid_tamp.model.swept import SweptPlan
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.report.lettering import Letters
from hybrid_tamp.report.swept.legend import KEY, line_of, title_of
from hybrid_tamp.report.swept.outlines import Plane
from hybrid_tamp.report.swept.panel import GREY, POINTS, Panel, write_number
from hybrid_tamp.report.swept.scene import SweptView, choose_planes, divide

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_WIDTH, _DPI = 5.0, 280
"""Width of a picture [inches] and its resolution. Its text can be read if it is shown with a width of 400 pixels."""
_LEFT, _RIGHT, _BELOW, _GAP = 0.5, 0.1, 0.42, 0.12
"""Room beside and below a view, for the numbers at its axes, and between parts of the picture [inches]."""
_TALLEST = 3.6
"""Largest height of a view [inches]."""
_BOLD = 1.2
"""Width of bold letters, as a multiple of the width of other letters."""
_MARGIN = 0.06
"""Room around the bodies of a view, as a fraction of its larger side."""
_UNSTAMPED: dict[str, dict[str, Any]] = {
    "png": {"Software": None},
    "svg": {"Date": None},
    "pdf": {"CreationDate": None},
}
"""Maps each format to metadata without a date or a version, so that a file depends only on the plan."""


@dataclass(frozen=True)
class PlotLetters(Letters):
    """Letters of the font that matplotlib uses."""

    @cached_property
    def font(self) -> ImageFont.FreeTypeFont:
        """Font with letters of this size."""
        from matplotlib.font_manager import findfont

        return ImageFont.truetype(findfont("DejaVu Sans"), self.size)


_LETTERS = PlotLetters(round(POINTS * _DPI / 72))
_LINE = _LETTERS.line / _DPI


def swept_picture(swept: SweptPlan, form: str = "png") -> bytes:
    """Return the picture of a swept plan. Equal plans have equal pictures.

    Args:
        swept: the movements of the plan.
        form: ``png``, ``svg`` or ``pdf``.
    """
    from matplotlib import rc_context

    picture = BytesIO()
    with rc_context({"svg.hashsalt": "hybrid_tamp", "hatch.linewidth": 0.4, "font.family": "DejaVu Sans"}):
        draw_figure(swept).savefig(picture, format=form, metadata=_UNSTAMPED[form])
    return picture.getvalue()


def draw_figure(swept: SweptPlan) -> "Figure":
    """Return the picture of a swept plan as a figure of matplotlib."""
    return _Page(swept).draw()


class _Page:
    """Writer of a picture from its top to its bottom. All views have one scale."""

    def __init__(self, swept: SweptPlan) -> None:
        self._title = _wrap(title_of(swept), _BOLD)
        self._chapters = divide(swept)
        planes = choose_planes(swept)
        self._views = [[SweptView(chapter, plane) for plane in planes] for chapter in self._chapters]
        self._frames = {plane: _frame([views[index] for views in self._views]) for index, plane in enumerate(planes)}
        spans = [upper - lower for lower, upper in self._frames.values()]
        widest = min((_WIDTH - _LEFT - _RIGHT) / float(span[0]) for span in spans)
        self._scale = min(widest, *(_TALLEST / float(span[1]) for span in spans))
        self._legends = [
            [(number, _wrap(line_of(path))) for number, path in chapter.paths] for chapter in self._chapters
        ]
        lines = len(self._title) + 1 + sum(len(texts) for legend in self._legends for _, texts in legend)
        each = sum(self._size(plane)[1] + _BELOW + _GAP for plane in planes) + 2 * _GAP
        self._height = lines * _LINE + len(self._chapters) * each + 2 * _GAP
        self._top = self._height - _GAP

    def draw(self) -> "Figure":
        """Return the picture."""
        # pyplot is avoided, because pyplot keeps all figures and needs a window system.
        from matplotlib.figure import Figure

        figure = Figure(figsize=(_WIDTH, self._height), dpi=_DPI)
        self._write(figure, self._title, fontweight="bold")
        for views, legend in zip(self._views, self._legends, strict=True):
            for view in views:
                self._draw_view(figure, view)
            self._top -= _GAP
            for number, texts in legend:
                place = ((_LEFT - 0.15) / _WIDTH, (self._top - 0.36 * _LINE) / self._height)
                write_number(figure, *place, number)
                self._write(figure, texts)
            self._top -= _GAP
        self._write(figure, [KEY], color=GREY)
        return figure

    def _draw_view(self, figure: "Figure", view: SweptView) -> None:
        width, height = self._size(view.plane)
        lower, upper = self._frames[view.plane]
        self._top -= _GAP
        place = _LEFT / _WIDTH, (self._top - height) / self._height, width / _WIDTH, height / self._height
        axes = figure.add_axes(place, xlim=(lower[0], upper[0]), ylim=(lower[1], upper[1]))
        Panel(axes, view, _LETTERS, (round(width * _DPI), round(height * _DPI))).draw()
        self._top -= height + _BELOW

    def _size(self, plane: Plane) -> tuple[float, float]:
        """Return the width and the height of a view [inches]."""
        lower, upper = self._frames[plane]
        width, height = self._scale * (upper - lower)
        return float(width), float(height)

    def _write(self, figure: "Figure", texts: list[str], **style: Any) -> None:
        for text in texts:
            place = _LEFT / _WIDTH, self._top / self._height
            figure.text(*place, text, va="top", fontsize=POINTS, parse_math=False, **style)
            self._top -= _LINE


def _frame(views: list[SweptView]) -> tuple[FloatArray, FloatArray]:
    """Return the corners of all views in a plane with room around their bodies, each ``(2,)`` [m]."""
    lower = np.min([view.bounds[0] for view in views], axis=0)
    upper = np.max([view.bounds[1] for view in views], axis=0)
    room = _MARGIN * float(np.max(upper - lower))
    return lower - room, upper + room


def _wrap(text: str, wider: float = 1.0) -> list[str]:
    return _LETTERS.wrap(text, (_WIDTH - _LEFT - _RIGHT) * _DPI / wider)
