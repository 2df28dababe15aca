"""Rendering of recordings. The drawing library is imported when a renderer is first opened."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import rotate
from hybrid_tamp.physics.pictures.appearance import ColouredMesh, choose_colours, draw_tokens
from hybrid_tamp.physics.pictures.floor import Region, draw_shadows, paint_floor, tile_size
from hybrid_tamp.physics.pictures.outlines import disc_radius, is_raised
from hybrid_tamp.physics.pictures.sight import choose_shot
from hybrid_tamp.physics.pictures.subject import goal_reach
from hybrid_tamp.physics.pictures.view import Rectangle, View, merge_rectangles, overlap
from hybrid_tamp.physics.protocol import Resource, load

WIDTH, HEIGHT = 1280, 720
"""Default size of a picture [pixels]."""

_RENDERER = "hybrid_tamp.physics.bullet.tiny_renderer:TinyRenderer"
_SAMPLES = 2
"""Number of rows and columns that are drawn per pixel, so that edges look smooth."""
_DECIMALS = 5
"""Poses are rounded to this number of decimals, so that a body that rests does not flicker."""


class BodyRenderer(Resource, Protocol):
    """A renderer that draws the bodies of a task, but not the floor and not shadows."""

    def aim(self, view: View) -> None:
        """Change the view of the scene."""
        ...

    def place(self, state: State) -> None:
        """Move all bodies to their poses in a state ``(n,)``."""
        ...

    def draw(self, part: Rectangle, samples: int) -> NDArray[np.uint8]:
        """Return a part of the picture, of shape ``(height * samples, width * samples, 4)``, with opacity."""
        ...


class Renderer(Resource):
    """A renderer that draws states of a task.

    Args:
        task: task with the tokens to draw.
        view: first view of the scene.
    """

    def __init__(self, task: Task, view: View) -> None:
        self.view = view
        # The tiles keep their size if the camera moves.
        self._tile = tile_size(view)
        meshes = draw_tokens(task)
        drawn = {each.token for each in meshes}
        self._solids = {token.name: _solids_of(token.name, meshes) for token in task.tokens if token.name in drawn}
        self._regions = list(_regions_of(task))
        self._floor: tuple[bytes, Image.Image] | None = None
        self._drawn: dict[tuple[Rectangle, bytes], Image.Image] = {}
        self._bodies: BodyRenderer = load(_RENDERER)(meshes, view)

    def close(self) -> None:
        """Release the resources. The renderer must not be used afterwards."""
        self._bodies.close()

    def aim(self, view: View) -> None:
        """Change the view of the scene. Pictures take longer to draw if the view often changes."""
        if view is not self.view:
            self.view, self._floor = view, None
            self._drawn.clear()
            self._bodies.aim(view)

    def picture(self, state: State) -> NDArray[np.uint8]:
        """Return the picture of a state, as an RGB array of shape ``(height, width, 3)``."""
        state = State(state.layout, np.round(state.values, _DECIMALS))
        picture = self._paint_floor(state)
        placed = {name: _placed(solids, state, name) for name, solids in self._solids.items()}
        draw_shadows(picture, self.view, [each for solids in placed.values() for each in solids])
        bounds = {name: self.view.bounds(np.concatenate(solids)) for name, solids in placed.items()}
        self._bodies.place(state)
        before, self._drawn = self._drawn, {}
        for part in merge_rectangles(list(bounds.values())):
            poses = [_pose(state, name) for name, own in bounds.items() if overlap(own, part)]
            key = (part, np.concatenate(poses).tobytes())
            # Drawing is slow, so a part of the picture in which nothing has moved is kept.
            drawn = before.get(key) or Image.fromarray(self._bodies.draw(part, _SAMPLES)).reduce(_SAMPLES)
            self._drawn[key] = drawn
            picture.paste(drawn, part[:2], drawn)
        return np.array(picture)

    def bounds(self, state: State) -> Mapping[str, Rectangle]:
        """Map each token to the part of the picture in which the token appears."""
        found = {
            name: self.view.bounds(np.concatenate(_placed(solids, state, name)))
            for name, solids in self._solids.items()
        }
        for region in self._regions:
            reach = max(region.radius, region.reach) * np.array([[-1, -1, 0], [-1, 1, 0], [1, -1, 0], [1, 1, 0]])
            found[region.token] = self.view.bounds(_on_floor(state, region.token) + reach)
        return found

    def _paint_floor(self, state: State) -> Image.Image:
        """Return a new picture of the floor. The floor is painted again only if a region has moved."""
        centres = [_on_floor(state, region.token) for region in self._regions]
        key = np.array(centres).tobytes()
        if self._floor is None or self._floor[0] != key:
            self._floor = (key, paint_floor(self.view, self._tile, zip(self._regions, centres, strict=True)))
        return self._floor[1].copy()


def open_renderer(task: Task, recording: Recording, width: int = WIDTH, height: int = HEIGHT) -> Renderer:
    """Open a renderer whose camera shows all that moves or takes part in the run, also if PyBullet did not run it.

    Raises:
        InputError: PyBullet is not installed.
    """
    return Renderer(task, View(choose_shot(task, recording, width / height).camera, width, height))


def _regions_of(task: Task) -> Iterator[Region]:
    """Yield the discs on the floor."""
    colours = choose_colours(task)
    for token in task.tokens:
        if token.shape is None and not is_raised(task.state, token):
            yield Region(token.name, disc_radius(token), colours[token.name], goal_reach(task, token))


def _solids_of(token: str, meshes: Sequence[ColouredMesh]) -> list[FloatArray]:
    """Return the vertices of each convex solid of a token in its body frame, ``(n, 3)`` [m]."""
    return [np.unique(each.mesh.vertices, axis=0) for each in meshes if each.token == token and not each.mark]


def _placed(solids: Sequence[FloatArray], state: State, token: str) -> list[FloatArray]:
    position, orientation = state[token, "position"], state[token, "orientation"]
    return [rotate(orientation, vertices) + position for vertices in solids]


def _pose(state: State, token: str) -> FloatArray:
    return np.concatenate([state[token, "position"], state[token, "orientation"]])


def _on_floor(state: State, token: str) -> FloatArray:
    return np.asarray(state[token, "position"]) * [1.0, 1.0, 0.0]
