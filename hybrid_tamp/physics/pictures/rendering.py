"""Rendering of recordings. The drawing library is imported when a renderer is first opened."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.pictures.camera import spheres_of
from hybrid_tamp.physics.protocol import Resource, load

WIDTH, HEIGHT = 640, 352
"""Default size of a picture [pixels]. Drawing a picture takes about 80 ms, so a video of 200 pictures takes 16 s."""

_RENDERER = "hybrid_tamp.physics.bullet.tiny_renderer:TinyRenderer"


class Renderer(Resource, Protocol):
    """A renderer that draws states of a task with a fixed camera."""

    def picture(self, state: State) -> NDArray[np.uint8]:
        """Return the picture of a state, as an RGB array of shape ``(height, width, 3)``."""
        ...


def open_renderer(task: Task, recording: Recording, width: int = WIDTH, height: int = HEIGHT) -> Renderer:
    """Open a renderer whose camera shows every token during the whole run. Recordings of any backend can be drawn.

    Raises:
        InputError: PyBullet is not installed.
    """
    renderer: Renderer = load(_RENDERER)(task, spheres_of(task, recording), width, height)
    return renderer
