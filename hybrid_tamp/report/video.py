"""Write the frames of a recording as a video and as one picture per step."""

import os
from collections.abc import Callable, Generator, Iterator
from contextlib import closing, contextmanager
from itertools import chain
from pathlib import Path

import imageio_ffmpeg
import numpy as np
from PIL import Image

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.report.folder import check_parent
from hybrid_tamp.report.frames import Frames
from hybrid_tamp.report.layout import Picture

Progress = Callable[[int, int], None]
"""Function that is called with the number of finished frames and the total number of frames."""

FRAME_RATE = 30
"""Frames per second of a video."""
_QUALITY = ["-crf", "20", "-preset", "veryfast", "-movflags", "+faststart"]


def frame_times(recording: Recording, frame_rate: float = FRAME_RATE) -> FloatArray:
    """Return the instants of the frames [s], shape ``(n,)``, from the start to the end of the run."""
    count = int(np.ceil(round(recording.duration * frame_rate, 6)))
    return np.append(np.arange(count) / frame_rate, recording.duration)


def write_video(
    path: Path, frames: Frames, progress: Progress = lambda done, of: None, deadline: Deadline = NEVER
) -> int:
    """Write an mp4 video and return its number of frames.

    Args:
        path: path of the video. The file has a temporary name until the video is complete.
        frames: the frames of the run.
        progress: function that is called after every frame.
        deadline: deadline of the command.

    Raises:
        InputError: the file cannot be written.
        LimitReached: the deadline passes. No video is left.
    """
    times: list[float] = frame_times(frames.recording).tolist()
    with renamed(path) as temporary:
        pictures = frames.draw(zip(times, times, strict=True), deadline)
        first = next(pictures)
        with closing(_encoder(temporary, first)) as encoder:
            encoder.send(None)
            for done, picture in enumerate(chain([first], pictures), start=1):
                encoder.send(np.ascontiguousarray(picture))
                progress(done, len(times))
    return len(times)


def step_pictures(folder: Path, frames: Frames, deadline: Deadline = NEVER) -> tuple[Path, ...]:
    """Write one PNG per step (``step-01.png`` etc.) that shows the scene at the end of the step.

    Raises:
        InputError: a file cannot be written.
        LimitReached: the deadline passes. The pictures so far are left.
    """
    recording = frames.recording
    steps = tuple(recording.plan.steps)
    # The end of a step belongs to the next step, so the caption is taken from the preceding time step.
    instants = [(float(step.end), max(step.start, float(step.end) - recording.timestep)) for step in steps]
    written = []
    # Labels need not keep their sides between pictures that differ much.
    pictures = chain.from_iterable(frames.draw([instant], deadline) for instant in instants)
    for step, picture in zip(steps, pictures, strict=True):
        path = folder / f"step-{step.index:02d}.png"
        with renamed(path) as temporary:
            Image.fromarray(picture).save(temporary, format="PNG")
        written.append(path)
    return tuple(written)


def check_film(path: Path | None, kind: str, suffix: str) -> None:
    """Raise `InputError` if the folder of a video or GIF does not exist or its path has another ending.

    Args:
        path: path of the file, or None.
        kind: what the file is, for messages, e.g. ``"video"``.
        suffix: ending that the path must have, e.g. ``".mp4"``.
    """
    if path is None:
        return
    if path.suffix.lower() != suffix:
        raise InputError([Issue(str(path), f"the name of the {kind} must end in {suffix}")])
    check_parent(path, f"the {kind}")


def _encoder(path: Path, picture: Picture) -> Generator[None, Picture | None, None]:
    height, width = picture.shape[:2]
    encoder: Generator[None, Picture | None, None] = imageio_ffmpeg.write_frames(
        str(path),
        (width, height),
        fps=FRAME_RATE,
        codec="libx264",
        pix_fmt_in="rgb24",
        pix_fmt_out="yuv420p",
        macro_block_size=2,
        ffmpeg_log_level="error",
        output_params=_QUALITY,
    )
    return encoder


@contextmanager
def renamed(path: Path) -> Iterator[Path]:
    """Yield a temporary path with the same ending, and rename the temporary file to `path` if no error occurs.

    Raises:
        InputError: the file cannot be written.
    """
    temporary = path.with_name(f".{os.getpid()}.part.{path.name}")
    try:
        # Fail early if the file cannot be written, before any picture is drawn or an encoder is started.
        temporary.touch()
        yield temporary
        temporary.replace(path)
    except OSError as error:
        raise InputError([Issue(str(path), "cannot write the file", str(error).splitlines()[0])]) from error
    finally:
        temporary.unlink(missing_ok=True)
