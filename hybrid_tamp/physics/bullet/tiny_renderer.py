"""Rendering of bodies with PyBullet's software renderer, which needs no display or graphics card.

The pixels are the same on every machine. The renderer has its own client with visual shapes only, so drawing does not
affect a simulation. The renderer clears and copies every pixel of its picture, which takes longer than drawing a few
bodies, so it draws only those parts of a picture in which bodies appear.
"""

from collections.abc import Sequence

import numpy as np
import pybullet
from numpy.typing import NDArray

from hybrid_tamp.geometry.triangles import Mesh
from hybrid_tamp.model.state import State
from hybrid_tamp.physics.bullet.engine import Client
from hybrid_tamp.physics.pictures.appearance import Colour, ColouredMesh
from hybrid_tamp.physics.pictures.floor import light_direction
from hybrid_tamp.physics.pictures.view import Rectangle, View

_AMBIENT, _DIFFUSE, _SPECULAR = 0.56, 0.5, 0.12
_NEAR, _FAR = 0.02, 3.0


class TinyRenderer(Client):
    """A renderer of the bodies of a task.

    Args:
        meshes: surfaces of the bodies.
        view: first view of the scene.
    """

    def __init__(self, meshes: Sequence[ColouredMesh], view: View) -> None:
        super().__init__()
        self._drawn = [(each.token, self._draw(each.mesh, each.colour)) for each in meshes]
        self.aim(view)

    def aim(self, view: View) -> None:
        """Change the view of the scene. Bodies must be placed again."""
        self._view = view
        # The renderer's light points at the origin, so the scene is shifted until the target is at the origin.
        eye = (view.camera.eye - view.camera.target).tolist()
        self._matrix = pybullet.computeViewMatrix(eye, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
        self._light = tuple(light_direction(view).tolist())

    def place(self, state: State) -> None:
        """Move all bodies to their poses in a state of shape ``(n,)``."""
        for token, handle in self._drawn:
            position = (state[token, "position"] - self._view.camera.target).tolist()
            orientation = state[token, "orientation"].tolist()
            pybullet.resetBasePositionAndOrientation(handle, position, orientation, physicsClientId=self._client)

    def draw(self, part: Rectangle, samples: int) -> NDArray[np.uint8]:
        """Return a part of the picture with red, green, blue and opacity, which is zero where no body is.

        Args:
            part: part of the picture to draw.
            samples: number of rows and columns per pixel.
        """
        width, height = (part[2] - part[0]) * samples, (part[3] - part[1]) * samples
        seen = pybullet.getCameraImage(
            width,
            height,
            self._matrix,
            self._projection(part),
            shadow=0,
            renderer=pybullet.ER_TINY_RENDERER,
            lightDirection=self._light,
            lightColor=(1.0, 1.0, 1.0),
            lightAmbientCoeff=_AMBIENT,
            lightDiffuseCoeff=_DIFFUSE,
            lightSpecularCoeff=_SPECULAR,
            physicsClientId=self._client,
        )
        pixels = np.array(seen[2], dtype=np.uint8).reshape(height, width, 4)
        bodies = np.asarray(seen[4]).reshape(height, width)
        pixels[..., 3] = np.where(bodies < 0, 0, 255)
        return pixels

    def _projection(self, part: Rectangle) -> tuple[float, ...]:
        """Return the projection matrix of a part of the picture."""
        view = self._view
        near = _NEAR * view.camera.distance
        scale = near / view.focal
        left, right = ((x - view.width / 2) * scale for x in (part[0], part[2]))
        top, bottom = ((view.height / 2 - y) * scale for y in (part[1], part[3]))
        matrix: tuple[float, ...] = pybullet.computeProjectionMatrix(
            left, right, bottom, top, near, _FAR * view.camera.distance
        )
        return matrix

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
