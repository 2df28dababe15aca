"""Pictures of a recording; the drawing library is imported when a renderer is first opened."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.pictures.camera import spheres_of
from hybrid_tamp.physics.protocol import Resource, load

WIDTH, HEIGHT = 640, 352
"""Size of a picture [pixels]: about 80 ms each, so that ten seconds at 20 pictures a second take 16 s."""

_RENDERER = "hybrid_tamp.physics.bullet.tiny_renderer:TinyRenderer"


class Renderer(Resource, Protocol):
    """Draws states of one task with one camera."""

    def picture(self, state: State) -> NDArray[np.uint8]:
        """Return the picture of a state, ``(height, width, 3)``, red, green, blue."""
        ...


def open_renderer(task: Task, recording: Recording, width: int = WIDTH, height: int = HEIGHT) -> Renderer:
    """Open a renderer whose camera shows every token during the whole run, whatever backend recorded it.

    Raises:
        InputError: PyBullet is not installed.
    """
    renderer: Renderer = load(_RENDERER)(task, spheres_of(task, recording), width, height)
    return renderer
