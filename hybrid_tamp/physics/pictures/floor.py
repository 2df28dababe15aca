"""The floor of a picture: chequered tiles that fade with the distance, regions and shadows of bodies."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFilter
from scipy.spatial import ConvexHull, QhullError

from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import cross
from hybrid_tamp.physics.pictures.appearance import Colour
from hybrid_tamp.physics.pictures.view import View

LIGHT = np.array([-0.5, 0.55, 1.0])
"""Direction to the light: to the right and backward of the camera, both level, and upward."""

_TILES = np.array([(0.962, 0.966, 0.972), (0.92, 0.927, 0.937)])
_SKY = np.array((1.0, 1.0, 1.0))
_SIZES = (0.02, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0, 25.0)
_TILES_IN_VIEW = 10.0
_FADES = (0.75, 2.2)
_STRIP = 128
_RIM, _FILL = 0.12, 0.5
_LINE, _ARM = 0.0026, 0.02
"""Width of lines, and length of the arms outside the circle, as shares of the camera's distance."""
_DASHES = 24
_SHADOW = (38, 46, 66)
_DARKNESS = 0.42
_SOFTNESS = 0.004


@dataclass(frozen=True)
class Region:
    """A disc on the floor.

    Attributes:
        token: name of the token that the disc shows.
        radius: radius of the disc [m].
        colour: colour of the rim. The inside is paler.
        reach: radius of a circle and a cross around the disc [m], or zero. They mark a region in the goal, and are
            larger than the objects that the goal requires in the region, so that no object hides them.
    """

    token: str
    radius: float
    colour: Colour
    reach: float = 0.0


def light_direction(view: View) -> FloatArray:
    """Return the vector to the light in the world frame, with a vertical component of 1."""
    right = view.axes[0]
    toward = cross(right, np.array([0.0, 0.0, 1.0]))
    return np.asarray(LIGHT[0] * right + LIGHT[1] * toward + LIGHT[2] * np.array([0.0, 0.0, 1.0]))


def tile_size(view: View) -> float:
    """Return a length of the floor's tiles [m] that suits a view."""
    return next((each for each in _SIZES if each * _TILES_IN_VIEW >= view.camera.distance), _SIZES[-1])


def paint_floor(view: View, tile: float, regions: Iterable[tuple[Region, FloatArray]]) -> Image.Image:
    """Return the picture of the floor without bodies.

    Args:
        view: view of the scene.
        tile: length of the floor's tiles [m].
        regions: pairs of a region and the position of its centre, ``(2,)`` or ``(3,)`` [m].
    """
    placed = tuple(regions)
    # Strips bound the memory that a large picture needs.
    strips = [
        _paint_strip(view, tile, (top, min(top + _STRIP, view.height)), placed) for top in range(0, view.height, _STRIP)
    ]
    return Image.fromarray(np.round(np.concatenate(strips) * 255).astype(np.uint8))


def _paint_strip(
    view: View, tile: float, rows: tuple[int, int], regions: Sequence[tuple[Region, FloatArray]]
) -> FloatArray:
    """Return the colours ``(last - first, width, 3)`` of rows (first, last) of the picture, without the last."""
    pixels = np.meshgrid(np.arange(view.width) + 0.5, np.arange(*rows) + 0.5)
    points = view.meet_floor(np.stack(pixels, axis=-1))
    beyond = ~np.isfinite(points[..., 0])
    points[beyond] = 0.0
    scale = view.camera.distance
    # Tiles in two directions: an edge is where the wave is zero.
    one, other = (_covered(np.abs(points[..., axis] / tile % 2 - 1) - 0.5) for axis in (0, 1))
    colours = _mixed(np.broadcast_to(_TILES[0], (*one.shape, 3)), _TILES[1], one + other - 2 * one * other)
    away = np.linalg.norm(points - view.camera.target[:2], axis=-1) / scale
    fade = np.clip((away - _FADES[0]) / (_FADES[1] - _FADES[0]), 0.0, 1.0)
    colours = _mixed(colours, _SKY, np.where(beyond, 1.0, fade * fade * (3 - 2 * fade)))
    for region, centre in regions:
        offset = points - np.asarray(centre)[:2]
        near = np.abs(offset) < region.radius + region.reach + _ARM * scale
        if np.any(near[..., 0] & near[..., 1]):
            for share in _cover_region(offset, region, scale):
                colours = _mixed(colours, np.array(region.colour), np.where(beyond, 0.0, share))
    return colours


def _cover_region(offset: FloatArray, region: Region, scale: float) -> tuple[FloatArray, FloatArray]:
    """Return the shares of the region's colour in each pixel, of the inside and of the lines.

    Args:
        offset: position of each pixel on the floor, relative to the centre of the region, ``(h, w, 2)`` [m].
        region: the region.
        scale: distance of the camera [m].
    """
    distance = np.linalg.norm(offset, axis=-1)
    rim = max(_RIM * region.radius, _LINE * scale)
    inside = _covered(region.radius - distance)
    lines = np.minimum(inside, _covered(distance - region.radius + rim))
    if region.reach > 0:
        width = _LINE / 2 * scale
        # A broken circle looks different from the rim of a large region.
        angle = np.arctan2(offset[..., 1], offset[..., 0]) * _DASHES / (2 * np.pi)
        dashes = np.where(angle - np.floor(angle) < 0.6, _covered(width - np.abs(distance - region.reach)), 0.0)
        between = (distance > region.radius) & (distance < region.reach + _ARM * scale)
        arms = [np.where(between, _covered(width - np.abs(offset[..., axis])), 0.0) for axis in (0, 1)]
        lines = np.maximum.reduce([lines, dashes, *arms])
    return _FILL * inside, lines


def _covered(field: FloatArray) -> FloatArray:
    """Return how much of each pixel is where the field is positive. The field has a value at each pixel's centre."""
    slope = sum(np.abs(np.gradient(field, axis=axis)) for axis in (0, 1) if field.shape[axis] > 1)
    return np.clip(0.5 + field / np.maximum(slope, 1e-12), 0.0, 1.0)


def _mixed(colours: FloatArray, others: FloatArray, share: FloatArray) -> FloatArray:
    """Return colours in which `share` of each pixel, ``(h, w)``, has the other colour."""
    return colours + share[..., None] * (others - colours)


def draw_shadows(floor: Image.Image, view: View, solids: Iterable[NDArray[np.float64]]) -> None:
    """Draw the shadows of convex bodies on the picture of the floor.

    Args:
        floor: picture of the floor, which is changed.
        view: view of the scene.
        solids: vertices of each convex body in the world frame, ``(n, 3)`` [m].
    """
    light = light_direction(view)
    # Half the resolution is enough for soft edges.
    mask = Image.new("L", (max(view.width // 2, 1), max(view.height // 2, 1)))
    draw = ImageDraw.Draw(mask)
    for vertices in solids:
        fallen = vertices - np.maximum(vertices[:, 2:], 0.0) * light
        outline = _outline(view.project(fallen) / 2)
        if len(outline) > 2:
            draw.polygon([(float(x), float(y)) for x, y in outline], fill=round(255 * _DARKNESS))
    softness = _SOFTNESS * mask.width
    bounds = mask.getbbox()
    if bounds is None:
        return
    border = int(3 * softness) + 1
    left, top = max(bounds[0] - border, 0), max(bounds[1] - border, 0)
    right, bottom = min(bounds[2] + border, mask.width), min(bounds[3] + border, mask.height)
    soft = mask.crop((left, top, right, bottom)).filter(ImageFilter.GaussianBlur(softness))
    floor.paste(_SHADOW, (2 * left, 2 * top), soft.resize((2 * soft.width, 2 * soft.height)))


def _outline(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the corners of the convex hull of points ``(n, 2)``, or no corner if the points are on one line."""
    try:
        return np.asarray(points[ConvexHull(points).vertices])
    except QhullError:
        return points[:0]
