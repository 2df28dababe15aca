"""Triangle meshes with vertex normals. The normals make edges look sharp and curved surfaces look smooth."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hybrid_tamp.geometry.meshes import Hull
from hybrid_tamp.geometry.shapes import Box, BoxPart, Cylinder, CylinderPart, Solid, SpherePart
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_from_rpy, rotate

_SIDES = 40
_RINGS = 20


@dataclass(frozen=True, eq=False)
class Mesh:
    """A triangle mesh with vertex normals.

    Attributes:
        vertices: positions of the vertices [m], shape ``(n, 3)``.
        normals: outward unit vectors at the vertices, shape ``(n, 3)``.
        triangles: indices of the vertices of each triangle, counterclockwise seen from outside, shape ``(m, 3)``.
    """

    vertices: FloatArray
    normals: FloatArray
    triangles: NDArray[np.intp]

    def moved(self, offset: ArrayLike) -> "Mesh":
        """Return the mesh translated by an offset [m], shape ``(3,)``."""
        return Mesh(self.vertices + np.asarray(offset), self.normals, self.triangles)

    def turned(self, quaternion: ArrayLike) -> "Mesh":
        """Return the mesh rotated about the origin by a unit quaternion, shape ``(4,)``."""
        return Mesh(rotate(quaternion, self.vertices), rotate(quaternion, self.normals), self.triangles)


def joined(*meshes: Mesh) -> Mesh:
    """Return one mesh that contains the triangles of all meshes."""
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.normals for mesh in meshes]),
        np.concatenate([mesh.triangles + start for mesh, start in zip(meshes, starts, strict=True)]),
    )


def solid(shape: Solid | Hull) -> Mesh:
    """Return the surface of a convex shape. The centre of a cylinder, box or sphere is the origin."""
    if isinstance(shape, Hull):
        return faceted(shape)
    if isinstance(shape, Cylinder):
        return cylinder(shape.radius, shape.length)
    if isinstance(shape, Box):
        return box(shape.half_extents)
    return sphere(shape.radius)


def placed_solid(part: CylinderPart | BoxPart | SpherePart | Hull) -> Mesh:
    """Return the surface of a convex solid at its pose in the body frame."""
    return solid(part).turned(quaternion_from_rpy(part.rpy)).moved(part.position)


def faceted(hull: Hull) -> Mesh:
    """Return the surface of a hull as flat triangles that do not share vertices."""
    corners = hull.vertices[hull.triangles]
    crossed = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = crossed / np.linalg.norm(crossed, axis=1, keepdims=True)
    count = len(corners)
    return Mesh(corners.reshape(-1, 3), np.repeat(normals, 3, axis=0), np.arange(3 * count).reshape(-1, 3))


def disc(radius: float) -> Mesh:
    """Return a disc at the origin, perpendicular to the z axis."""
    angles = np.linspace(0, 2 * np.pi, _SIDES, endpoint=False)
    rim = np.stack([np.cos(angles), np.sin(angles), np.zeros(_SIDES)], axis=-1) * radius
    vertices = np.concatenate([np.zeros((1, 3)), rim])
    here = np.arange(_SIDES)
    triangles = np.stack([np.zeros(_SIDES, dtype=np.intp), 1 + here, 1 + (here + 1) % _SIDES], axis=-1)
    return Mesh(vertices, np.tile([0.0, 0.0, 1.0], (_SIDES + 1, 1)), triangles)


def cylinder(radius: float, length: float) -> Mesh:
    """Return a cylinder about the z axis."""
    top = disc(radius).moved([0, 0, length / 2])
    bottom = Mesh(top.vertices * [1, -1, -1], top.normals * -1, top.triangles)
    angles = np.linspace(0, 2 * np.pi, _SIDES, endpoint=False)
    outward = np.stack([np.cos(angles), np.sin(angles), np.zeros(_SIDES)], axis=-1)
    ends = [outward * radius + [0, 0, z] for z in (-length / 2, length / 2)]
    here = np.arange(_SIDES)
    there = (here + 1) % _SIDES
    lower = np.stack([here, there, _SIDES + here], axis=-1)
    upper = np.stack([there, _SIDES + there, _SIDES + here], axis=-1)
    side = Mesh(np.concatenate(ends), np.tile(outward, (2, 1)), np.concatenate([lower, upper]))
    return joined(side, top, bottom)


def box(half_extents: ArrayLike) -> Mesh:
    """Return an axis-aligned box."""
    corners = np.array([[-1.0, -1.0, 1.0], [1.0, -1.0, 1.0], [1.0, 1.0, 1.0], [-1.0, 1.0, 1.0]])
    top = Mesh(corners, np.tile([0.0, 0.0, 1.0], (4, 1)), np.array([[0, 1, 2], [0, 2, 3]]))
    faces = []
    # Cyclic permutations of the axes and half turns about an axis keep the orientation of triangles.
    for order in ([0, 1, 2], [1, 2, 0], [2, 0, 1]):
        for turn in (np.ones(3), np.array([1.0, -1.0, -1.0])):
            faces.append(Mesh((top.vertices * turn)[:, order], (top.normals * turn)[:, order], top.triangles))
    cube = joined(*faces)
    return Mesh(cube.vertices * np.asarray(half_extents), cube.normals, cube.triangles)


def sphere(radius: float) -> Mesh:
    """Return a sphere that is divided into rings and sides."""
    polar = np.linspace(0, np.pi, _RINGS + 1)[:, None]
    around = np.linspace(0, 2 * np.pi, _SIDES, endpoint=False)[None, :]
    components = (np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar) + 0 * around)
    normals = np.stack(components, axis=-1).reshape(-1, 3)
    ring, side = (grid.ravel() for grid in np.meshgrid(np.arange(_RINGS), np.arange(_SIDES), indexing="ij"))
    here, there = ring * _SIDES + side, ring * _SIDES + (side + 1) % _SIDES
    below, beyond = here + _SIDES, there + _SIDES
    triangles = np.concatenate([np.stack(t, axis=-1) for t in ((here, below, beyond), (here, beyond, there))])
    return Mesh(normals * radius, normals, triangles)


def tiles(lower: ArrayLike, upper: ArrayLike, size: float) -> tuple[Mesh, Mesh]:
    """Return one mesh for each colour of a chequered floor at height zero.

    The edges of the tiles are at multiples of `size`. The floor covers the rectangle from `lower` to `upper`.

    Args:
        lower: lower corner of the rectangle [m], shape ``(2,)``.
        upper: upper corner of the rectangle [m], shape ``(2,)``.
        size: edge length of a tile [m].
    """
    first = np.floor(np.asarray(lower) / size).astype(int)
    last = np.ceil(np.asarray(upper) / size).astype(int)
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    cells = [(i, j) for i in range(first[0], last[0]) for j in range(first[1], last[1])]
    colours = []
    for colour in (0, 1):
        corners = np.array([cell + square for cell in cells if sum(cell) % 2 == colour]).reshape(-1, 2) * size
        vertices = np.column_stack([corners, np.zeros(len(corners))])
        squares = np.arange(len(vertices)).reshape(-1, 4)
        triangles = np.concatenate([squares[:, [0, 1, 2]], squares[:, [0, 2, 3]]])
        colours.append(Mesh(vertices, np.tile([0.0, 0.0, 1.0], (len(vertices), 1)), triangles))
    return colours[0], colours[1]
