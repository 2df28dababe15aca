"""Frames of a recording: the picture of the scene with labels and captions. Videos and step pictures consist of frames."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Protocol

from PIL import Image

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.pictures.appearance import choose_colours, legend
from hybrid_tamp.physics.pictures.camera import find_actors
from hybrid_tamp.physics.pictures.sight import choose_camera
from hybrid_tamp.physics.pictures.view import Rectangle
from hybrid_tamp.report.caption import Captions
from hybrid_tamp.report.labels import Labels
from hybrid_tamp.report.layout import Layout, Panel, Picture, Strips

SIZE = (1280, 720)
"""Default width and height of frames [pixels]."""
_MOST_LABELS = 20
SMALLEST, LARGEST = (320, 240), (7680, 4320)


class Scene(Protocol):
    """A renderer that draws the scene without text, in the size `Layout.scene`."""

    def picture(self, state: State) -> Picture:
        """Return the picture of a state ``(n,)``, of shape ``(height, width, 3)``."""
        ...

    def bounds(self, state: State) -> Mapping[str, Rectangle]:
        """Map each token to the part of the picture in which the token appears."""
        ...


class Frames:
    """The frames of one recording.

    Args:
        task: the task of the run.
        recording: the recording of the run.
        layout: places of the scene and of the text.
        scene: renderer of the scene.
    """

    def __init__(self, task: Task, recording: Recording, layout: Layout, scene: Scene) -> None:
        self.recording = recording
        self._layout = layout
        self._scene = scene
        actors, colours = find_actors(task, recording), choose_colours(task)
        # Labels of tokens that take part in the run are placed first.
        labelled = sorted(colours, key=lambda name: name not in actors)[: max(_MOST_LABELS, len(actors))]
        self._colours = {name: colours[name] for name in labelled}

    def draw(self, instants: Iterable[tuple[float, float]], deadline: Deadline = NEVER) -> Iterator[Picture]:
        """Yield a frame for each pair of (instant of the picture, instant of the caption) [s].

        Raises:
            LimitReached: the deadline passes.
        """
        # New labels for each file, so that a file does not depend on the files that were written before.
        labels = Labels(self._colours, self._layout.letters)
        for time, captioned in instants:
            deadline.check()
            state = self.recording.at(time)
            picture = Image.fromarray(self._scene.picture(state))
            labels.draw(picture, self._scene.bounds(state))
            yield self._layout.frame(picture, captioned)


def choose_layout(task: Task, recording: Recording, size: tuple[int, int]) -> Layout:
    """Return the layout for frames of a size [pixels] in which the bodies are larger."""
    captions = Captions(recording, task.domain.resting)

    def enlargement(layout: Layout) -> float:
        width, height = layout.scene
        return height / choose_camera(task, recording, width / height).distance

    layouts = [kind(captions, legend(task), size) for kind in (Strips, Panel)]
    return max(layouts, key=enlargement)


def check_size(size: tuple[int, int]) -> None:
    """Raise `InputError` if pictures cannot have this width and height [pixels]."""
    width, height = size
    small = any(one < least for one, least in zip(size, SMALLEST, strict=True))
    large = any(one > most for one, most in zip(size, LARGEST, strict=True))
    if small or large or width % 2 or height % 2:
        least, most = (f"{one}x{other}" for one, other in (SMALLEST, LARGEST))
        wanted = f"width and height of a picture must be even numbers from {least} to {most}"
        raise InputError([Issue("size", wanted, f"{width}x{height}")])
