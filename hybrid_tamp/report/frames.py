"""Frames of videos, GIFs and step pictures: the picture of the scene with labels and captions."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Protocol

from PIL import Image

from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.pictures.appearance import choose_colours, legend
from hybrid_tamp.physics.pictures.sight import choose_shot
from hybrid_tamp.physics.pictures.subject import find_actors
from hybrid_tamp.physics.pictures.track import Track
from hybrid_tamp.physics.pictures.view import Rectangle, View
from hybrid_tamp.report.caption import Captions
from hybrid_tamp.report.labels import Labels
from hybrid_tamp.report.layout import Layout, Panel, Picture, Strips

_MOST_LABELS = 20


class Scene(Protocol):
    """A renderer that draws the scene without text, in the size `Layout.scene`."""

    def aim(self, view: View) -> None:
        """Change the view of the scene."""
        ...

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
        track: views of the camera. None means that the camera does not move.
    """

    def __init__(
        self, task: Task, recording: Recording, layout: Layout, scene: Scene, track: Track | None = None
    ) -> None:
        self.recording = recording
        self._track = track
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
            if self._track is not None:
                self._scene.aim(self._track.at(time))
            picture = Image.fromarray(self._scene.picture(state))
            labels.draw(picture, self._scene.bounds(state))
            yield self._layout.frame(picture, captioned)


def choose_layout(task: Task, recording: Recording, size: tuple[int, int]) -> tuple[Layout, View]:
    """Return the layout for frames of a size [pixels], and the view of the scene.

    A layout with room for all captions is preferred. Of two such layouts, the one with larger bodies is chosen.
    """
    captions = Captions(recording, task.domain.resting)
    found = []
    for kind in (Strips, Panel):
        layout = kind(captions, legend(task), size)
        width, height = layout.scene
        shot = choose_shot(task, recording, width / height)
        found.append(((layout.complete, height * shot.quality), layout, View(shot.camera, width, height)))
    _, layout, view = max(found, key=lambda each: each[0])
    return layout, view
