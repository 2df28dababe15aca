"""The text around pictures of a run: classes, step, time and the tokens in each block (as in the paper's Fig. 3)."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from hybrid_tamp.model.plan import TIME_TOLERANCE, BlockInstance, Step
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.pictures.appearance import Colour, legend
from hybrid_tamp.report.tables import roles_text

Picture = NDArray[np.uint8]
"""Image array of shape ``(height, width, 3)`` with the channels red, green and blue."""

_BACKGROUND = (255, 255, 255)
_RULE = (205, 210, 216)
_INK = (28, 33, 40)
_PALE = (112, 120, 130)
_GOOD, _BAD = (26, 127, 55), (190, 40, 35)
_LETTERS = 58
_SMALLEST = 9
_VERDICT_TIME = 0.5
_MOST = 0.45
"""Largest share of the height that the text may take."""


def allocation(instance: BlockInstance) -> str:
    """Return the tokens in the roles of a block, e.g. ``ROLLING: hand=hand, object=drum -> region=goal``."""
    mode = f" ({instance.mode})" if instance.mode else ""
    targets = f" -> {roles_text(instance.targets)}" if instance.targets else ""
    return f"{instance.action}{mode}: {roles_text(instance.slots)}{targets}"


@dataclass(frozen=True)
class _Line:
    """A line of text, or a coloured sample of a class if `chip` is given."""

    text: str
    ink: tuple[int, int, int] = _INK
    chip: Colour | None = field(default=None)


class Captions:
    """Writer of the text around the pictures of one recording. All pictures get the same size.

    Args:
        task: the task of the run.
        recording: the recording of the run.
        width: width of a picture with its text [pixels].
        height: height of a picture with its text [pixels].
    """

    def __init__(self, task: Task, recording: Recording, width: int, height: int) -> None:
        self._recording = recording
        self._resting = task.domain.resting
        self._size = (width, height)
        self.letters = max(width // _LETTERS, _SMALLEST)
        """Height of the letters [pixels]."""
        self._font = ImageFont.load_default(self.letters)
        self._line, self._margin = round(1.36 * self.letters), self.letters // 2
        self.steps = tuple(recording.plan.steps)
        room = max(int(_MOST * height - 4 * self._margin) // self._line - 1, 1)
        self._header = self._fill_header(legend(task))[:room]
        texts = [list(self._texts(step)) for step in self.steps] or [[]]
        self._columns = 2 if all(self._narrow(text) for lines in texts for text in lines) else 1
        fitted = [self._shorten(self._wrap(lines), room - len(self._header) + 1) for lines in texts]
        self._captions = fitted
        rows = max(-(-len(lines) // self._columns) for lines in fitted)
        self._top = 2 * self._margin + self._line * len(self._header)
        self._bottom = 2 * self._margin + self._line * rows if rows else 0

    @property
    def scene(self) -> tuple[int, int]:
        """Width and height of the picture of the scene, without the text [pixels]."""
        return self._size[0], self._size[1] - self._top - self._bottom

    def around(self, picture: Picture | Image.Image, time: float) -> Picture:
        """Return a picture of the scene with the text for a time [s] above and below it.

        Args:
            picture: picture of the scene, with the size `scene`.
            time: instant of the text [s].
        """
        canvas = Image.new("RGB", self._size, _BACKGROUND)
        scene = picture if isinstance(picture, Image.Image) else Image.fromarray(picture)
        canvas.paste(scene, (0, self._top))
        draw = ImageDraw.Draw(canvas)
        width, height = self._size
        for row, lines in enumerate(self._header):
            self._write_legend(draw, self._margin + row * self._line, lines)
        index = self.index_at(time)
        draw.text((width - self._margin, self._margin), self._now(index, time), _INK, self._font, anchor="ra")
        for edge in (self._top - 1, height - self._bottom):
            draw.line([(0, edge), (width, edge)], fill=_RULE)
        for place, line in enumerate(self._captions[index]):
            column, row = place % self._columns, place // self._columns
            x = self._margin + column * width / 2
            draw.text((x, height - self._bottom + self._margin + row * self._line), line.text, line.ink, self._font)
        self._write_verdict(draw, time)
        return np.array(canvas)

    def index_at(self, time: float) -> int:
        """Return the index (from 0) of the step at a time [s]. At a reassignment, return the later step's index."""
        return max(0, sum(step.start <= time + TIME_TOLERANCE for step in self.steps) - 1)

    def _now(self, index: int, time: float) -> str:
        return f"step {index + 1} of {len(self._captions)}    t = {time:5.2f} s"

    def _write_verdict(self, draw: ImageDraw.ImageDraw, time: float) -> None:
        """Write the verdict in the upper right corner of the scene during the last half second."""
        if time < self._recording.duration - _VERDICT_TIME:
            return
        text, colour = "goal missed", _BAD
        if self._recording.failure is not None:
            text = "stopped"
        elif self._recording.success:
            text, colour = "goal reached", _GOOD
        right, top = self._size[0] - self._margin, self._top + self._margin
        left = right - self._font.getlength(text) - 2 * self._margin
        draw.rounded_rectangle((left, top, right, top + self._line + self._margin), self._margin, fill=colour)
        middle = ((left + right) / 2, top + (self._line + self._margin) / 2)
        draw.text(middle, text, _BACKGROUND, self._font, anchor="mm")

    def _fill_header(self, classes: tuple[tuple[str, Colour], ...]) -> list[list[_Line]]:
        """Return the rows of the legend. The first row leaves room for step and time."""
        rows: list[list[_Line]] = [[]]
        room = self._size[0] - self._font.getlength(self._now_at_most) - 3 * self._margin
        left = room
        for text, colour in classes:
            short = self._cut(text, room - 2 * self.letters)
            need = self._font.getlength(short) + 2.4 * self.letters
            if rows[-1] and need > left:
                rows.append([])
                left = self._size[0] - 2 * self._margin
            rows[-1].append(_Line(short, chip=colour))
            left -= need
        return rows

    @property
    def _now_at_most(self) -> str:
        count = len(self.steps)
        return f"step {count} of {count}    t = {max(self._recording.duration, 10):5.2f} s"

    def _write_legend(self, draw: ImageDraw.ImageDraw, top: float, lines: list[_Line]) -> None:
        x, size = float(self._margin), round(0.8 * self.letters)
        for line in lines:
            red, green, blue = (round(255 * channel) for channel in line.chip or (0, 0, 0))
            above = top + (self._line - size) / 2
            draw.rounded_rectangle((x, above, x + size, above + size), size // 4, fill=(red, green, blue))
            draw.text((x + 1.2 * self.letters, top), line.text, _PALE, self._font)
            x += self._font.getlength(line.text) + 2.4 * self.letters

    def _texts(self, step: Step) -> Iterator[_Line]:
        """Yield a text per busy instance of a step, and a pale text with all resting tokens."""
        busy = sorted((i for i in step.instances if i.block != self._resting), key=lambda i: (i.start, i.name))
        yield from (_Line(allocation(instance)) for instance in busy)
        resting = sorted(t for i in step.instances if i.block == self._resting for t in i.slots.values())
        if resting:
            yield _Line(f"{self._resting}: {', '.join(resting)}", _PALE)

    def _narrow(self, line: _Line) -> bool:
        return bool(self._font.getlength(line.text) <= self._size[0] / 2 - 2 * self._margin)

    def _wrap(self, lines: list[_Line]) -> list[_Line]:
        """Break texts into lines that fit the picture. Break only words that are wider than a line."""
        room = self._size[0] / self._columns - 2 * self._margin
        return [_Line(text, line.ink) for line in lines for text in self._fit(line.text, room)]

    def _shorten(self, lines: list[_Line], rows: int) -> list[_Line]:
        """Replace the last lines by dots if there is no room for all lines."""
        most = max(rows, 1) * self._columns
        return lines if len(lines) <= most else [*lines[: most - 1], _Line("...", _PALE)]

    def _cut(self, text: str, room: float) -> str:
        """Return the text, shortened with dots if it is wider than the room [pixels]."""
        if self._font.getlength(text) <= room:
            return text
        while text and self._font.getlength(f"{text}...") > room:
            text = text[:-1]
        return f"{text}..."

    def _fit(self, text: str, room: float) -> list[str]:
        lines = [""]
        for word in text.split(" "):
            longer = f"{lines[-1]} {word}" if lines[-1] else word
            if self._font.getlength(longer) <= room:
                lines[-1] = longer
                continue
            lines = [*(lines if lines[-1] else lines[:-1]), *self._pieces(word, room)]
        return lines

    def _pieces(self, word: str, room: float) -> list[str]:
        pieces = [""]
        for letter in word:
            if self._font.getlength(pieces[-1] + letter) > room:
                pieces.append("")
            pieces[-1] += letter
        return pieces
