"""Write the frames of a recording as an animated GIF of limited size.

A GIF stores one palette and the pixels that change. All frames share one palette, and colours are not mixed by patterns
of dots, so that pixels of the still background do not change.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import numpy as np
from PIL import Image

from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.report.frames import Frames
from hybrid_tamp.report.video import Progress, renamed

SIZE = (960, 540)
"""Largest width and height of a GIF [pixels]."""
LARGEST_FILE = 3_000_000
"""Size that the file does not exceed [bytes]."""
PAUSE = 1.5
"""Time for which the last frame is shown before the GIF starts again [s]."""
_PERIOD = 0.08
_MOST_FRAMES = 150
_PALETTE_FRAMES = 8
_FEW = 200


@dataclass(frozen=True)
class _Attempt:
    """Settings of one attempt to keep the file small.

    Attributes:
        colours: number of colours of the palette.
        every: number of drawn frames from one frame of the GIF to the next.
        scale: factor for the width and height.
    """

    colours: int
    every: int
    scale: float

    @property
    def cost(self) -> float:
        """Size of the file compared with that of another attempt. Each pixel of each frame needs some bits."""
        return float(np.log2(self.colours)) / self.every * self.scale**2


_ATTEMPTS = (
    *(_Attempt(colours, 1, 1.0) for colours in (192, 96, 64)),
    *(_Attempt(64, 1, 0.8), _Attempt(64, 2, 0.8), _Attempt(48, 2, 0.65), _Attempt(32, 3, 0.5), _Attempt(16, 6, 0.35)),
    _Attempt(8, 12, 0.2),
)


def write_gif(
    path: Path, frames: Frames, progress: Progress = lambda done, of: None, deadline: Deadline = NEVER
) -> int:
    """Write an animated GIF, which repeats for ever, and return its number of frames.

    The GIF lasts as long as the run, and then shows its last frame for `PAUSE`. If the file is larger than
    `LARGEST_FILE`, fewer colours, fewer frames and a smaller picture are chosen, in this order.

    Args:
        path: path of the GIF. The file has a temporary name until the GIF is complete.
        frames: the frames of the run.
        progress: function that is called after every drawn frame.
        deadline: deadline of the command.

    Raises:
        InputError: the file cannot be written.
        LimitReached: the deadline passes. No GIF is left.
    """
    times = gif_times(frames.recording.duration)
    with renamed(path) as temporary:
        drawn = []
        for picture in frames.draw(zip(times, times, strict=True), deadline):
            drawn.append(Image.fromarray(picture))
            progress(len(drawn), len(times))
        content, count = _encode_small(drawn, times, deadline)
        temporary.write_bytes(content)
    return count


def fit_size(size: tuple[int, int]) -> tuple[int, int]:
    """Return a width and height [pixels] with nearly the same ratio that are not larger than a GIF can be."""
    scale = min(1.0, *(most / one for most, one in zip(SIZE, size, strict=True)))
    width, height = (2 * round(scale * one / 2) for one in size)
    return width, height


def gif_times(duration: float) -> list[float]:
    """Return the instants of the frames of a run [s]. A GIF counts time in hundredths of a second."""
    period = max(_PERIOD, float(np.ceil(duration / _MOST_FRAMES * 100)) / 100)
    if duration == 0:
        return [0.0]
    return [0.0, *np.arange(period, duration - period / 2, period).tolist(), duration]


def _encode_small(drawn: Sequence[Image.Image], times: Sequence[float], deadline: Deadline) -> tuple[bytes, int]:
    """Return the content of a GIF of at most `LARGEST_FILE`, and its number of frames."""
    waiting = list(_ATTEMPTS)
    while True:
        deadline.check()
        attempt = waiting.pop(0)
        content, count = _encode(drawn, times, attempt)
        if len(content) <= LARGEST_FILE or not waiting:
            return content, count
        # Attempts that are not expected to be small enough are left out, because each attempt takes seconds.
        wanted = attempt.cost * LARGEST_FILE / len(content)
        waiting = [each for each in waiting[:-1] if each.cost <= wanted] + waiting[-1:]


def _encode(drawn: Sequence[Image.Image], times: Sequence[float], attempt: _Attempt) -> tuple[bytes, int]:
    """Return the content of a GIF and its number of frames."""
    kept = [*range(0, len(drawn) - 1, attempt.every), len(drawn) - 1]
    size = (round(drawn[0].width * attempt.scale), round(drawn[0].height * attempt.scale))
    pictures = [drawn[index] if attempt.scale == 1 else drawn[index].resize(size) for index in kept]
    palette = _shared_palette(pictures, attempt.colours)
    first, *others = [each.quantize(palette=palette, dither=Image.Dither.NONE) for each in pictures]
    ends = [*(times[index] for index in kept[1:]), times[-1] + PAUSE]
    instants = np.round(100 * np.array([0.0, *ends])).astype(int)
    file = BytesIO()
    first.save(
        file,
        format="GIF",
        save_all=True,
        append_images=others,
        duration=[10 * int(each) for each in np.diff(instants)],
        loop=0,
        optimize=False,
        disposal=1,
    )
    return file.getvalue(), len(pictures)


def _shared_palette(pictures: Sequence[Image.Image], colours: int) -> Image.Image:
    """Return a picture whose palette suits all pictures."""
    # Every second row and column contain the same colours as the whole picture.
    chosen = [np.asarray(pictures[index])[::2, ::2] for index in _spread(len(pictures))]
    joined = Image.fromarray(np.concatenate(chosen))
    # The colours of the palette are improved until few pixels change to another colour.
    few = max(joined.width * joined.height // _FEW, 1)
    return joined.quantize(colours, method=Image.Quantize.MEDIANCUT, kmeans=few, dither=Image.Dither.NONE)


def _spread(count: int) -> Iterator[int]:
    yield from sorted({round(each) for each in np.linspace(0, count - 1, min(count, _PALETTE_FRAMES))})
