"""Drawing of a recording: a picture of each step, a video and an animated GIF."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.pictures.rendering import Renderer
from hybrid_tamp.physics.pictures.track import follow
from hybrid_tamp.report import gif as gifs
from hybrid_tamp.report.folder import RunFolder
from hybrid_tamp.report.frame_size import SIZE, check_size
from hybrid_tamp.report.frames import Frames, choose_layout
from hybrid_tamp.report.video import Progress, check_film, step_pictures, write_video


@dataclass(frozen=True)
class Films:
    """The moving pictures that a run writes besides its step pictures.

    Attributes:
        video: path of an mp4 video, or None.
        gif: path of an animated GIF, or None.
        size: width and height of the step pictures and the video [pixels]. A GIF is smaller if necessary.
    """

    video: Path | None = None
    gif: Path | None = None
    size: tuple[int, int] = SIZE

    def check(self) -> None:
        """Raise `InputError` if a file has the wrong ending or no folder, or if the size is impossible."""
        check_film(self.video, "video", ".mp4")
        check_film(self.gif, "GIF", ".gif")
        check_size(self.size)


def draw_run(
    folder: RunFolder,
    task: Task,
    recording: Recording,
    films: Films,
    progress: Progress = lambda done, of: None,
    deadline: Deadline = NEVER,
) -> None:
    """Draw a picture of each step, and the video and the GIF if their paths are given.

    Raises:
        InputError: a file cannot be written.
        LimitReached: the deadline passes.
    """
    with _open_frames(task, recording, films.size) as frames:
        # The camera of the step pictures does not move, so that the pictures can be compared.
        step_pictures(folder.path, frames(moving=False), deadline)
        if films.video is not None:
            write_video(films.video, frames(moving=True), progress, deadline)
    if films.gif is not None:
        with _open_frames(task, recording, gifs.fit_size(films.size)) as frames:
            gifs.write_gif(films.gif, frames(moving=True), progress, deadline)


class _MakeFrames(Protocol):
    """Function that returns frames from a camera that follows the action or does not move."""

    def __call__(self, *, moving: bool) -> Frames: ...


@contextmanager
def _open_frames(task: Task, recording: Recording, size: tuple[int, int]) -> Iterator[_MakeFrames]:
    layout, view = choose_layout(task, recording, size)
    with Renderer(task, view) as renderer:

        def make(*, moving: bool) -> Frames:
            return Frames(task, recording, layout, renderer, follow(task, recording, view) if moving else None)

        yield make
