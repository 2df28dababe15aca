"""The relation between points in the world and pixels of a picture."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import cross, normalized
from hybrid_tamp.physics.pictures.camera import FIELD_OF_VIEW, Camera

Rectangle = tuple[int, int, int, int]
"""Left, top, right and bottom edge of a part of a picture [pixels]. The right and bottom edges are excluded."""


@dataclass(frozen=True, eq=False)
class View:
    """A camera and the size of its picture. The origin of pixel coordinates is the top left corner of the picture.

    Attributes:
        camera: the camera.
        width: width of the picture [pixels].
        height: height of the picture [pixels].
    """

    camera: Camera
    width: int
    height: int

    @cached_property
    def axes(self) -> FloatArray:
        """Unit vectors to the right, up and backward in the world frame, as rows of shape ``(3, 3)``."""
        back = (self.camera.eye - self.camera.target) / self.camera.distance
        right = normalized(cross(np.array([0.0, 0.0, 1.0]), back))
        return np.stack([right, cross(back, right), back])

    @cached_property
    def focal(self) -> float:
        """Distance from the camera to the picture plane [pixels]."""
        return float(self.height / 2 / np.tan(FIELD_OF_VIEW / 2))

    def project(self, points: ArrayLike) -> FloatArray:
        """Return the pixel coordinates ``(..., 2)`` of points ``(..., 3)`` [m] in front of the camera."""
        right, up, back = np.moveaxis((np.asarray(points) - self.camera.eye) @ self.axes.T, -1, 0)
        scale = self.focal / np.maximum(-back, 1e-6)
        return np.stack([self.width / 2 + right * scale, self.height / 2 - up * scale], axis=-1)

    def meet_floor(self, pixels: ArrayLike) -> FloatArray:
        """Return the points of the floor ``(..., 2)`` [m] that appear at pixel coordinates ``(..., 2)``.

        The result is infinite above the horizon.
        """
        x, y = np.moveaxis(np.asarray(pixels, dtype=float), -1, 0)
        across = np.stack([x - self.width / 2, self.height / 2 - y, np.full(x.shape, -self.focal)], axis=-1)
        rays = across @ self.axes
        falling = rays[..., 2:] < 0
        reach = np.divide(-self.camera.eye[2], rays[..., 2:], out=np.full(falling.shape, np.inf), where=falling)
        with np.errstate(invalid="ignore"):
            return np.where(falling, self.camera.eye[:2] + reach * rays[..., :2], np.inf)

    def bounds(self, points: NDArray[np.float64], border: int = 2) -> Rectangle:
        """Return the part of the picture in which points ``(n, 3)`` [m] appear, with a border [pixels] around it."""
        pixels = self.project(points)
        most = [self.width, self.height]
        low = np.clip(np.floor(pixels.min(axis=0)).astype(int) - border, 0, most)
        high = np.clip(np.ceil(pixels.max(axis=0)).astype(int) + border, 0, most)
        return int(low[0]), int(low[1]), int(high[0]), int(high[1])


def merge_rectangles(rectangles: list[Rectangle]) -> list[Rectangle]:
    """Return rectangles that cover the given rectangles and do not overlap. Empty rectangles are left out."""
    found: list[Rectangle] = []
    waiting = [each for each in rectangles if each[0] < each[2] and each[1] < each[3]]
    while waiting:
        here = waiting.pop()
        touching = [each for each in found if overlap(here, each)]
        found = [each for each in found if each not in touching]
        if touching:
            lefts, tops, rights, bottoms = zip(here, *touching, strict=True)
            waiting.append((min(lefts), min(tops), max(rights), max(bottoms)))
        else:
            found.append(here)
    return sorted(found)


def overlap(one: Rectangle, other: Rectangle) -> bool:
    """Return whether two rectangles share a pixel."""
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]
