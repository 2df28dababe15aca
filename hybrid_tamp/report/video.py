"""A recording as a video and as one picture a step; who draws the scene is passed in."""

import os
from collections.abc import Callable, Generator, Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import imageio_ffmpeg
import numpy as np
from PIL import Image

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.report.caption import Captions, Picture

Render = Callable[[State], Picture]
"""State, of shape ``(n,)``, to its picture ``(height, width, 3)``; always of one size."""

Progress = Callable[[int, int], None]
"""Called with how many frames are done and how many there will be."""

FRAME_RATE = 20
"""Frames a second."""
_QUALITY = ["-crf", "20", "-preset", "veryfast", "-movflags", "+faststart"]


def frame_times(recording: Recording, frame_rate: int = FRAME_RATE) -> FloatArray:
    """Return the instants of the frames ``(n,)`` [s]; the first is the start, the last the end of the run."""
    count = int(np.ceil(round(recording.duration * frame_rate, 6)))
    return np.append(np.arange(count) / frame_rate, recording.duration)


def frames(task: Task, recording: Recording, render: Render, times: FloatArray) -> Iterator[Picture]:
    """Yield the captioned picture of each instant [s]."""
    captions: Captions | None = None
    for time in times:
        picture = render(recording.at(float(time)))
        if captions is None:
            captions = Captions(task, recording, picture.shape[1])
        yield captions.under(picture, float(time))


def write_video(
    path: Path,
    task: Task,
    recording: Recording,
    render: Render,
    progress: Progress | None = None,
) -> int:
    """Write an mp4 that any player and browser shows, and return how many frames it has.

    Args:
        path: the file, which appears only when it is whole.
        task: the task that was run.
        recording: what happened.
        render: draws a state.
        progress: called after every frame.

    Raises:
        InputError: the file cannot be written.
    """
    times = frame_times(recording)
    with _renamed(path) as temporary:
        pictures = frames(task, recording, render, times)
        first = next(pictures)
        with closing(_encoder(temporary, first)) as encoder:
            encoder.send(None)
            for index in range(len(times)):
                encoder.send(np.ascontiguousarray(first if index == 0 else next(pictures)))
                if progress is not None:
                    progress(index + 1, len(times))
    return len(times)


def step_pictures(folder: Path, task: Task, recording: Recording, render: Render) -> tuple[Path, ...]:
    """Write one PNG a step, ``step-01.png`` and so on, each as things stand at the step's end.

    Raises:
        InputError: a file cannot be written.
    """
    steps = tuple(recording.plan.steps)
    ends = np.array([step.end for step in steps])
    written = []
    captions: Captions | None = None
    for step, end in zip(steps, ends, strict=True):
        picture = render(recording.at(float(end)))
        if captions is None:
            captions = Captions(task, recording, picture.shape[1])
        # The instant of a reassignment belongs to the next step, and this picture to the one that ends there.
        row_before = max(step.start, float(end) - recording.timestep)
        path = folder / f"step-{step.index:02d}.png"
        with _renamed(path) as temporary:
            Image.fromarray(captions.under(picture, row_before)).save(temporary, format="PNG")
        written.append(path)
    return tuple(written)


def draw_run(
    folder: Path,
    task: Task,
    recording: Recording,
    render: Render,
    video: Path | None,
    progress: Callable[[float], None],
) -> None:
    """Draw one picture for each step, and the video if one is wanted.

    Args:
        folder: where the pictures go.
        task: the task that was run.
        recording: what happened.
        render: draws a state.
        video: where the video goes, or None.
        progress: told the share of the video that is drawn.

    Raises:
        InputError: a file cannot be written.
    """
    step_pictures(folder, task, recording, render)
    if video is not None:
        write_video(video, task, recording, render, lambda done, of: progress(done / of))


def check_video(path: Path | None) -> None:
    """Refuse a video that could not be written, before anything is done.

    Raises:
        InputError: its folder is not there, or it does not end in ``.mp4``.
    """
    if path is None:
        return
    if path.suffix.lower() != ".mp4":
        raise InputError([Issue(str(path), "a video file that ends in .mp4")])
    if path.parent.exists() and not path.parent.is_dir():
        raise InputError([Issue(str(path), "a video file in a folder", f"{path.parent}, a file")])
    if not path.parent.exists():
        raise InputError([Issue(str(path), "a video file in a folder that exists", f"{path.parent}, which does not")])


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
def _renamed(path: Path) -> Iterator[Path]:
    """Give a temporary path with the same ending, and rename it when the block ends without an error.

    Raises:
        InputError: the file cannot be written.
    """
    temporary = path.with_name(f".{os.getpid()}.part.{path.name}")
    try:
        # Whether the file can be written is seen here, before anything is drawn or an encoder started.
        temporary.touch()
        yield temporary
        temporary.replace(path)
    except OSError as error:
        wanted = "a file that can be written"
        raise InputError([Issue(str(path), wanted, str(error).splitlines()[0])]) from error
    finally:
        temporary.unlink(missing_ok=True)
