"""One view of a swept plan, drawn with matplotlib."""

from collections.abc import Iterable, Iterator
from math import dist
from typing import TYPE_CHECKING, Any

import numpy as np

from hybrid_tamp.model.closest_pair import ClosestPair
from hybrid_tamp.model.swept import SweptPath
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.physics.pictures.view import Rectangle, overlap
from hybrid_tamp.report.labels import Labels
from hybrid_tamp.report.lettering import Letters
from hybrid_tamp.report.swept.legend import colour_of
from hybrid_tamp.report.swept.outlines import bounds_of
from hybrid_tamp.report.swept.scene import SweptView

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

GREY = "#5c6570"
POINTS = 8.0
"""Size of all texts [points]."""
_INK, _PALE, _RED = "#1c2128", "#d0d7de", "#be2823"
_CLOSE = 0.1
"""Distance below which the line of a closest pair is thick [m]."""
_SHARES = (0.5, 0.35, 0.65, 0.2, 0.8)
"""Shares of a path at which its number may be, in the order of preference."""
_TOKENS: dict[str, dict[str, Any]] = {
    "fixed": {"facecolor": "#eceff2", "edgecolor": GREY, "hatch": "////", "linewidth": 0.8},
    "movable": {"facecolor": "none", "edgecolor": _INK, "linewidth": 0.9},
    "region": {"facecolor": "none", "edgecolor": GREY, "linewidth": 1.2, "linestyle": ":"},
}
"""How tokens of each kind are drawn."""


class Panel:
    """Writer of one view.

    Args:
        axes: axes of the view, with limits in metres.
        view: what the view shows.
        letters: letters of the labels.
        size: width and height of the view [pixels].
    """

    def __init__(self, axes: "Axes", view: SweptView, letters: Letters, size: tuple[int, int]) -> None:
        self._axes, self._view, self._letters, self._size = axes, view, letters, size

    def draw(self) -> None:
        """Draw the bodies, the movements and the labels."""
        self._draw_axes()
        for token in self._view.tokens:
            self._fill(token.outlines, zorder=2, **_TOKENS[token.kind])
        paths = self._view.chapter.paths
        for (number, path), area in zip(paths, self._view.areas, strict=True):
            self._draw_path(number, path, area)
        self._label(self._number())

    def _draw_axes(self) -> None:
        axes, (across, up) = self._axes, self._view.axis_names
        axes.set_xlabel(f"{across} [m]", fontsize=POINTS, labelpad=1)
        axes.set_ylabel(f"{up} [m]", fontsize=POINTS, labelpad=1)
        axes.tick_params(labelsize=POINTS, length=2, pad=2)
        for side in axes.spines.values():
            side.set_edgecolor(_PALE)
        if self._view.shows_height:
            axes.axhline(0.0, color=GREY, linewidth=0.8, zorder=1)

    def _fill(self, outlines: Iterable[FloatArray], **style: Any) -> None:
        """Draw outlines as one area. Outlines in the same direction make one area also where they overlap."""
        from matplotlib.patches import PathPatch
        from matplotlib.path import Path

        path = Path.make_compound_path(*(Path(np.vstack([each, each[:1]]), closed=True) for each in outlines))
        # Unlike `add_patch`, this does not search the curves for new limits of the axes.
        self._axes.add_artist(PathPatch(path, **style))

    def _draw_path(self, number: int, path: SweptPath, area: list[FloatArray]) -> None:
        colour = colour_of(number)
        self._fill(area, facecolor=colour, alpha=0.2, linewidth=0, zorder=3)
        for row, width in ((0, 0.6), (-1, 1.3)):
            outlines = self._view.outlines_at(path, row)
            self._fill(outlines, facecolor="none", edgecolor=colour, linewidth=width, zorder=4)
        for body in path.bodies:
            self._axes.plot(*self._view.flatten(body.positions).T, color=colour, linewidth=1.0, zorder=5)
        if path.instance.path:
            corners = self._view.flatten(np.array(path.instance.path))
            self._axes.plot(*corners.T, color=colour, linestyle="none", marker=".", markersize=3, zorder=5)
        if path.closest is not None:
            self._draw_closest(path, path.closest)

    def _draw_closest(self, path: SweptPath, pair: ClosestPair) -> None:
        """Draw a line between the nearest points or, if the bodies overlap, a cross and the moving body."""
        across, up = self._view.flatten(np.array(pair.points)).T
        if pair.distance >= 0:
            self._axes.plot(across, up, color=_INK, linewidth=1.4 if pair.distance < _CLOSE else 0.6, zorder=7)
            return
        row = int(np.abs(path.times - pair.time).argmin())
        outlines = self._view.outlines_at(path, row, pair.moving)
        self._fill(outlines, facecolor="none", edgecolor=_RED, linewidth=1.3, hatch="xx", zorder=6)
        self._axes.plot(across, up, color=_RED, marker="X", markersize=8, markeredgecolor="white", zorder=7)

    def _number(self) -> dict[str, Rectangle]:
        """Write the number of each movement on its path, apart from other numbers. Return the occupied places."""
        taken: dict[str, Rectangle] = {}
        for number, path in self._view.chapter.paths:
            positions = self._view.flatten(path.bodies[0].positions)
            for share in _SHARES:
                place = positions[round(share * (len(positions) - 1))]
                box = self._box([place[None]], round(0.75 * self._letters.size))
                if not any(overlap(box, other) for other in taken.values()):
                    # A name that no token has.
                    taken[f"\n{number}"] = box
                    write_number(self._axes, float(place[0]), float(place[1]), number)
                    break
        return taken

    def _label(self, taken: dict[str, Rectangle]) -> None:
        """Write the names of the tokens and the distances of the closest pairs beside their places."""
        distances = dict(self._distances())
        bodies = distances | {each.name: self._box(each.outlines) for each in self._view.tokens}
        labels = Labels(dict.fromkeys(bodies, (0.0, 0.0, 0.0)), self._letters)
        for text, place in labels.place(bodies | taken, self._size).items():
            leader = labels.lead(place, bodies[text])
            # A short line before a figure would look like a minus sign.
            if leader is not None and dist(*leader) > 1.5 * self._letters.size:
                ends = np.array([self._share(*end) for end in leader])
                self._axes.plot(*ends.T, transform=self._axes.transAxes, color=GREY, linewidth=0.5, zorder=8)
            self._axes.text(
                *self._share((place[0] + place[2]) / 2, (place[1] + place[3]) / 2),
                text,
                transform=self._axes.transAxes,
                fontsize=POINTS,
                ha="center",
                va="center",
                color=_RED if text in distances and text.endswith("deep") else _INK,
                bbox={"boxstyle": "square,pad=0.1", "facecolor": "white", "edgecolor": "none", "alpha": 0.75},
                zorder=9,
                parse_math=False,
            )

    def _distances(self) -> Iterator[tuple[str, Rectangle]]:
        for number, path in self._view.chapter.paths:
            if path.closest is not None:
                points = self._view.flatten(np.array(path.closest.points))
                yield f"{number}: {path.closest.figure}", self._box([points], 2)

    def _box(self, outlines: list[FloatArray], border: int = 0) -> Rectangle:
        """Return the rectangle around outlines [pixels], with a border."""
        lower, upper = bounds_of(outlines)
        across, up = self._axes.get_xlim(), self._axes.get_ylim()
        scale = self._size[0] / (across[1] - across[0])
        left, right = (round(scale * (x - across[0])) for x in (lower[0], upper[0]))
        top, bottom = (round(scale * (up[1] - y)) for y in (upper[1], lower[1]))
        return left - border, top - border, right + border + 1, bottom + border + 1

    def _share(self, x: float, y: float) -> tuple[float, float]:
        """Return the coordinates of a pixel as fractions of the view, from its lower left corner."""
        return x / self._size[0], 1.0 - y / self._size[1]


def write_number(where: "Axes | Figure", x: float, y: float, number: int) -> None:
    """Write the number of a movement on its colour, with its centre at a place in the coordinates of `where`."""
    box = {"boxstyle": "round,pad=0.12", "facecolor": colour_of(number), "edgecolor": "white", "linewidth": 0.5}
    where.text(x, y, str(number), fontsize=POINTS - 1, ha="center", va="center", color="white", bbox=box, zorder=8)
