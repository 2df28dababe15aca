"""Layouts of a frame: the text is in strips above and below the scene, or in a panel beside the scene."""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from hybrid_tamp.physics.pictures.appearance import Colour
from hybrid_tamp.report.caption import Captions, Paragraph
from hybrid_tamp.report.lettering import Letters

Picture = NDArray[np.uint8]
"""Image array of shape ``(height, width, 3)`` with the channels red, green and blue."""

Legend = Sequence[tuple[str, Colour]]
"""Pairs of (classes, colour)."""

_BACKGROUND = (255, 255, 255)
_RULE = (205, 210, 216)
_INK, _PALE = (28, 33, 40), (104, 112, 122)
_GOOD, _BAD = (26, 127, 55), (190, 40, 35)
_LETTERS, _SMALLEST = 52, 9
"""Number of letters per width of a frame, so that a frame is readable at a width of 400 pixels, and smallest size."""
_LEGEND = 0.85
"""Size of the legend's letters compared with the other letters."""
_TEXT_HEIGHT = 0.45
_PANEL_WIDTH = 0.33


@dataclass(frozen=True)
class _Line:
    text: str
    pale: bool
    first: bool
    """Whether the line begins a paragraph."""


class Layout(ABC):
    """The places of the scene and of the text in the frames of one recording. All frames have the same size.

    Args:
        captions: captions of the run.
        legend: classes of the tokens with their colours.
        size: width and height of a frame [pixels].
    """

    def __init__(self, captions: Captions, legend: Legend, size: tuple[int, int]) -> None:
        self.letters = Letters(max(size[0] // _LETTERS, _SMALLEST))
        self.small = Letters(max(round(_LEGEND * self.letters.size), _SMALLEST))
        self._captions = captions
        self._legend = legend
        self._size = size
        self._margin = self.letters.size // 2
        self.complete = True
        """Whether the frames have room for all captions."""

    @property
    @abstractmethod
    def scene(self) -> tuple[int, int]:
        """Width and height of the picture of the scene [pixels]."""

    @property
    @abstractmethod
    def corner(self) -> tuple[int, int]:
        """Left and top edge of the picture of the scene [pixels]."""

    @abstractmethod
    def write(self, draw: ImageDraw.ImageDraw, time: float) -> None:
        """Write the legend, the headline and the caption for a time [s] around the scene."""

    def frame(self, picture: Image.Image, time: float) -> Picture:
        """Return the frame with a picture of the scene, which has the size `scene`, and the text for a time [s]."""
        canvas = Image.new("RGB", self._size, _BACKGROUND)
        canvas.paste(picture, self.corner)
        draw = ImageDraw.Draw(canvas)
        self.write(draw, time)
        self._write_verdict(draw, time)
        return np.array(canvas)

    def _write_verdict(self, draw: ImageDraw.ImageDraw, time: float) -> None:
        """Write the verdict in the upper right corner of the scene."""
        verdict = self._captions.verdict(time)
        if verdict is None:
            return
        right, top = self.corner[0] + self.scene[0] - self._margin, self.corner[1] + self._margin
        left, bottom = right - self.letters.width(verdict.text) - 2 * self._margin, top + 2 * self.letters.size
        draw.rounded_rectangle((left, top, right, bottom), self._margin, fill=_GOOD if verdict.good else _BAD)
        middle = ((left + right) / 2, (top + bottom) / 2)
        draw.text(middle, verdict.text, _BACKGROUND, self.letters.font, anchor="mm")

    def _write_class(self, draw: ImageDraw.ImageDraw, x: float, y: float, text: str, colour: Colour) -> None:
        size = round(0.8 * self.small.size)
        above = y + (self.small.line - size) / 2
        red, green, blue = (round(255 * channel) for channel in colour)
        draw.rounded_rectangle((x, above, x + size, above + size), size // 4, fill=(red, green, blue))
        draw.text((x + 1.2 * self.small.size, y), text, _PALE, self.small.font)

    def _write_line(self, draw: ImageDraw.ImageDraw, x: float, y: float, line: _Line) -> None:
        draw.text((x, y), line.text, _PALE if line.pale else _INK, self.letters.font)

    def _wrap(self, paragraphs: Iterable[Paragraph], room: float, rows: int) -> list[_Line]:
        """Return lines that fit the room [pixels]. Dots replace the last lines if there are more lines than rows."""
        lines = [
            _Line(text, paragraph.pale, first=number == 0)
            for paragraph in paragraphs
            for number, text in enumerate(self.letters.wrap(paragraph.text, room))
        ]
        if len(lines) <= rows:
            return lines
        self.complete = False
        return [*lines[: max(rows - 1, 0)], _Line("...", pale=True, first=False)]


class Strips(Layout):
    """Legend and headline above the scene, and the caption below the scene."""

    def __init__(self, captions: Captions, legend: Legend, size: tuple[int, int]) -> None:
        super().__init__(captions, legend, size)
        line = self.letters.line
        rows = max(int(_TEXT_HEIGHT * size[1] - 4 * self._margin) // line, 2)
        self._header = self._fill_header()[: rows - 1]
        left = rows - len(self._header)
        self._lines = [self._wrap(each, size[0] - 2 * self._margin, left) for each in captions.paragraphs]
        self._top = 2 * self._margin + max(line, self.small.line * len(self._header))
        self._bottom = 2 * self._margin + line * max(map(len, self._lines))

    @property
    def scene(self) -> tuple[int, int]:  # noqa: D102
        return self._size[0], self._size[1] - self._top - self._bottom

    @property
    def corner(self) -> tuple[int, int]:  # noqa: D102
        return 0, self._top

    def write(self, draw: ImageDraw.ImageDraw, time: float) -> None:  # noqa: D102
        (width, height), margin, line = self._size, self._margin, self.letters.line
        for row, classes in enumerate(self._header):
            x = float(margin)
            for text, colour in classes:
                self._write_class(draw, x, margin + row * self.small.line, text, colour)
                x += self._class_width(text)
        draw.text((width - margin, margin), self._captions.headline(time), _INK, self.letters.font, anchor="ra")
        for edge in (self._top - 1, height - self._bottom):
            draw.line([(0, edge), (width, edge)], fill=_RULE)
        for row, each in enumerate(self._lines[self._captions.index_at(time)]):
            self._write_line(draw, margin, height - self._bottom + margin + row * line, each)

    def _class_width(self, text: str) -> float:
        return self.small.width(text) + 2.4 * self.small.size

    def _fill_header(self) -> list[list[tuple[str, Colour]]]:
        """Return the rows of the legend. Each row leaves room for the headline."""
        rows: list[list[tuple[str, Colour]]] = [[]]
        room = self._size[0] - self.letters.width(self._captions.last_headline) - 4 * self._margin
        left = room
        for text, colour in self._legend:
            short = self.small.cut(text, room - 2.4 * self.small.size)
            if rows[-1] and self._class_width(short) > left:
                rows.append([])
                left = room
            rows[-1].append((short, colour))
            left -= self._class_width(short)
        return rows


class Panel(Layout):
    """Headline, caption and legend in a panel on the left of the scene."""

    def __init__(self, captions: Captions, legend: Legend, size: tuple[int, int]) -> None:
        super().__init__(captions, legend, size)
        self._width = 2 * round(_PANEL_WIDTH * size[0] / 2)
        room = self._width - 3 * self._margin
        classes = [
            (text, colour if number == 0 else None)
            for name, colour in legend
            for number, text in enumerate(self.small.wrap(name, room - 1.2 * self.small.size))
        ]
        rows = (size[1] - 4 * self._margin) // self.letters.line - 2
        self._classes = classes[: rows // 2]
        # Gaps between paragraphs are half a line high.
        gaps = max(len(each) for each in captions.paragraphs) // 2 + 1
        left = rows - len(self._classes) - gaps
        self._lines = [self._wrap(each, room, left) for each in captions.paragraphs]

    @property
    def scene(self) -> tuple[int, int]:  # noqa: D102
        return self._size[0] - self._width, self._size[1]

    @property
    def corner(self) -> tuple[int, int]:  # noqa: D102
        return self._width, 0

    def write(self, draw: ImageDraw.ImageDraw, time: float) -> None:  # noqa: D102
        line, y = self.letters.line, 2.0 * self._margin
        draw.text((2 * self._margin, y), self._captions.headline(time), _INK, self.letters.font)
        y += 1.5 * line
        for number, each in enumerate(self._lines[self._captions.index_at(time)]):
            y += 0.5 * line * (each.first and number > 0)
            self._write_line(draw, 2 * self._margin, y, each)
            y += line
        draw.line([(self._width - 1, 0), (self._width - 1, self._size[1])], fill=_RULE)
        y = self._size[1] - 2.0 * self._margin - self.small.line * len(self._classes)
        for text, colour in self._classes:
            if colour is None:
                draw.text((2 * self._margin + 1.2 * self.small.size, y), text, _PALE, self.small.font)
            else:
                self._write_class(draw, 2 * self._margin, y, text, colour)
            y += self.small.line
