"""Captions for pictures of a run: the step, the time and the tokens in each block (as in the paper's Fig. 3)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from hybrid_tamp.model.plan import TIME_TOLERANCE, BlockInstance, Step
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.task import Task

Picture = NDArray[np.uint8]
"""Image array of shape ``(height, width, 3)`` with the channels red, green and blue."""

_BACKGROUND = (255, 255, 255)
_RULE = (205, 210, 216)
_INK = (28, 33, 40)
_PALE = (120, 128, 138)
_GOOD, _BAD = (26, 127, 55), (190, 40, 35)
_MARGIN = 14
_HEADLINE = 18
_BODY = 15
_LINE = 22
_VERDICT_TIME = 0.5


def allocation(instance: BlockInstance) -> str:
    """Return the slots and tokens of an instance as text, e.g. ``ROLLING-1: hand=hand object=drum -> goal``."""
    slots = " ".join(f"{slot}={token}" for slot, token in instance.slots.items())
    targets = ", ".join(instance.targets.values())
    return f"{instance.name}: {slots}" + (f" -> {targets}" if targets else "")


@dataclass(frozen=True)
class _Line:
    text: str
    colour: tuple[int, int, int]


class Captions:
    """Writer of captions for the pictures of one recording. All pictures get the same height.

    Args:
        task: the task of the run.
        recording: the recording of the run.
        width: width of the pictures in pixels.
    """

    def __init__(self, task: Task, recording: Recording, width: int) -> None:
        self._recording = recording
        self._resting = task.domain.resting
        # Video codecs halve the resolution of colours, so the width and height must be even.
        self._width = width + width % 2
        self._headline = ImageFont.load_default(_HEADLINE)
        self._body = ImageFont.load_default(_BODY)
        self.steps = tuple(recording.plan.steps)
        self._lines = [self._wrapped(step) for step in self.steps] or [[]]
        self._height = 2 * _MARGIN + _LINE + _LINE * max(map(len, self._lines))

    def under(self, picture: Picture, time: float) -> Picture:
        """Add the caption for a time [s] below a picture of shape ``(h, w, 3)``, and return the result."""
        height = picture.shape[0] + self._height
        canvas = Image.new("RGB", (self._width, height + height % 2), _BACKGROUND)
        canvas.paste(Image.fromarray(picture), (0, 0))
        draw = ImageDraw.Draw(canvas)
        top = picture.shape[0]
        draw.line([(0, top), (self._width, top)], fill=_RULE)
        index = self.index_at(time)
        top += _MARGIN
        draw.text((_MARGIN, top), f"step {index + 1} of {len(self._lines)}", _INK, self._headline)
        draw.text((self._width - _MARGIN, top), f"t = {time:.2f} s", _INK, self._headline, anchor="ra")
        verdict = self._verdict(time)
        if verdict is not None:
            draw.text((self._width / 2, top), verdict.text, verdict.colour, self._headline, anchor="ma")
        for row, line in enumerate(self._lines[index], start=1):
            draw.text((_MARGIN, top + row * _LINE + 4), line.text, line.colour, self._body)
        return np.asarray(canvas)

    def index_at(self, time: float) -> int:
        """Return the index (from 0) of the step at a time [s]. At a reassignment, return the later step's index."""
        return max(0, sum(step.start <= time + TIME_TOLERANCE for step in self.steps) - 1)

    def _verdict(self, time: float) -> _Line | None:
        if time < self._recording.duration - _VERDICT_TIME:
            return None
        if self._recording.failure is not None:
            return _Line("stopped", _BAD)
        return _Line("goal reached", _GOOD) if self._recording.success else _Line("goal missed", _BAD)

    def _wrapped(self, step: Step) -> list[_Line]:
        """Return the lines of a step: a paragraph per busy instance and a pale paragraph for all resting tokens."""
        busy = sorted((i for i in step.instances if i.block != self._resting), key=lambda i: (i.start, i.name))
        lines = [_Line(text, _INK) for instance in busy for text in self._fitted(allocation(instance))]
        resting = sorted(t for i in step.instances if i.block == self._resting for t in i.slots.values())
        if resting:
            lines += [_Line(text, _PALE) for text in self._fitted(f"{self._resting}: {', '.join(resting)}")]
        return lines

    def _fitted(self, text: str) -> list[str]:
        """Break a text into lines that fit the picture. Break only words that are wider than a line."""
        room = self._width - 2 * _MARGIN
        lines = [""]
        for word in text.split(" "):
            longer = f"{lines[-1]} {word}" if lines[-1] else word
            if self._body.getlength(longer) <= room:
                lines[-1] = longer
                continue
            lines = [*(lines if lines[-1] else lines[:-1]), *self._pieces(word, room)]
        return lines

    def _pieces(self, word: str, room: float) -> list[str]:
        pieces = [""]
        for letter in word:
            if self._body.getlength(pieces[-1] + letter) > room:
                pieces.append("")
            pieces[-1] += letter
        return pieces
