"""Rendering with PyBullet's software renderer, which needs no display or graphics card.

The pixels are the same on every machine. The renderer has its own client with visual shapes only, so drawing does not
affect a simulation.
"""

import numpy as np
import pybullet
from numpy.typing import NDArray

from hybrid_tamp.geometry.triangles import Mesh, tiles
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.bullet.engine import Client
from hybrid_tamp.physics.pictures.appearance import Colour, ColouredMesh, draw_tokens
from hybrid_tamp.physics.pictures.camera import FIELD_OF_VIEW, Camera, Spheres, frame_camera

Picture = NDArray[np.uint8]
"""RGB array of shape ``(height, width, 3)``."""

_TILE = 0.25
_TILES_ACROSS = 40
_BORDER = 0.4
_FLOOR: tuple[Colour, Colour] = ((0.97, 0.97, 0.97), (0.915, 0.92, 0.925))
_LIGHT = (-0.35, -0.6, 1.0)
_LIGHT_DISTANCE = 2.0
_AMBIENT, _DIFFUSE, _SPECULAR = 0.6, 0.45, 0.05


class TinyRenderer(Client):
    """A renderer of states of a task.

    Args:
        task: task with the tokens to draw.
        seen: spheres that the camera must show in every picture.
        width: width of a picture [pixels].
        height: height of a picture [pixels].
    """

    def __init__(self, task: Task, seen: Spheres, width: int, height: int) -> None:
        super().__init__()
        self._size = (width, height)
        self._camera = frame_camera(seen, width / height)
        self._draw_floor(seen)
        self._drawn = [(each, self._draw(each.mesh, each.colour)) for each in draw_tokens(task)]
        self._view, self._projection = self._compute_matrices(self._camera)

    def picture(self, state: State) -> Picture:
        """Return the picture of a state of shape ``(n,)``."""
        for each, handle in self._drawn:
            self._place(each, handle, state)
        width, height = self._size
        seen = pybullet.getCameraImage(
            width,
            height,
            self._view,
            self._projection,
            shadow=1,
            renderer=pybullet.ER_TINY_RENDERER,
            flags=pybullet.ER_NO_SEGMENTATION_MASK,
            lightDirection=_LIGHT,
            lightColor=(1.0, 1.0, 1.0),
            # The shadow map has the camera's angle of view, so it covers a larger area if the light is farther away.
            lightDistance=_LIGHT_DISTANCE * self._camera.distance,
            lightAmbientCoeff=_AMBIENT,
            lightDiffuseCoeff=_DIFFUSE,
            lightSpecularCoeff=_SPECULAR,
            physicsClientId=self._client,
        )
        pixels = np.asarray(seen[2], dtype=np.uint8).reshape(height, width, 4)
        return np.ascontiguousarray(pixels[..., :3])

    def _compute_matrices(self, camera: Camera) -> tuple[tuple[float, ...], tuple[float, ...]]:
        # The renderer's light points at the origin, so the scene is shifted until the target is at the origin.
        eye = (camera.eye - camera.target).tolist()
        width, height = self._size
        far = 3 * camera.distance
        view = pybullet.computeViewMatrix(eye, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
        projection = pybullet.computeProjectionMatrixFOV(
            np.degrees(FIELD_OF_VIEW), width / height, 0.02 * camera.distance, far
        )
        return view, projection

    def _draw_floor(self, seen: Spheres) -> None:
        lower, upper = (corner[:2] for corner in seen.bounds)
        border = _BORDER + 0.2 * float(np.max(upper - lower))
        size = _TILE
        while np.max(upper - lower) / size > _TILES_ACROSS:
            size *= 2
        for mesh, colour in zip(tiles(lower - border, upper + border, size), _FLOOR, strict=True):
            handle = self._draw(mesh, colour)
            self._set(handle, np.zeros(3), (0.0, 0.0, 0.0, 1.0))

    def _draw(self, mesh: Mesh, colour: Colour) -> int:
        visual = pybullet.createVisualShape(
            pybullet.GEOM_MESH,
            vertices=mesh.vertices.tolist(),
            normals=mesh.normals.tolist(),
            indices=mesh.triangles.ravel().tolist(),
            # Bullet does not draw meshes without texture coordinates.
            uvs=[[0.0, 0.0]] * len(mesh.vertices),
            rgbaColor=(*colour, 1.0),
            specularColor=(0.1, 0.1, 0.1),
            physicsClientId=self._client,
        )
        handle: int = pybullet.createMultiBody(0.0, -1, visual, physicsClientId=self._client)
        return handle

    def _place(self, drawn: ColouredMesh, handle: int, state: State) -> None:
        position = state[drawn.token, "position"]
        if drawn.flat:
            self._set(handle, position * [1.0, 1.0, 0.0], (0.0, 0.0, 0.0, 1.0))
        else:
            self._set(handle, position, tuple(state[drawn.token, "orientation"].tolist()))

    def _set(self, handle: int, position: NDArray[np.float64], orientation: tuple[float, ...]) -> None:
        shifted = (position - self._camera.target).tolist()
        pybullet.resetBasePositionAndOrientation(handle, shifted, orientation, physicsClientId=self._client)
