"""Bodies of convex parts, whose triangulated surfaces come from a mesh file. All lengths are in metres."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.motion.arrays import FloatArray

_CENTRE = (0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Hull:
    """The surface of a convex part in the body frame.

    Attributes:
        vertices: positions of the vertices [m], shape ``(n, 3)``.
        triangles: indices of the vertices of each triangle, counterclockwise seen from outside, shape ``(m, 3)``.
    """

    position: ClassVar[tuple[float, float, float]] = _CENTRE
    rpy: ClassVar[tuple[float, float, float]] = _CENTRE

    vertices: FloatArray
    triangles: NDArray[np.intp]

    def moved(self, offset: FloatArray) -> "Hull":
        """Return the part translated by an offset [m], shape ``(3,)``."""
        return Hull(self.vertices + offset, self.triangles)

    @property
    def integrals(self) -> tuple[float, FloatArray, FloatArray]:
        """Volume [m^3], first moments ``(3,)`` [m^4] and second moments ``(3, 3)`` [m^5] about the origin.

        The integrals are sums over tetrahedra with signed volumes. Each tetrahedron spans a triangle and the origin.
        """
        corners = self.vertices[self.triangles]  # (m, 3 corners, 3)
        volumes = np.einsum("mi,mi->m", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0
        sums = corners.sum(axis=1)
        first = volumes @ sums / 4.0
        second = np.einsum("m,mci,mcj->ij", volumes, corners, corners) + np.einsum("m,mi,mj->ij", volumes, sums, sums)
        return float(volumes.sum()), first, second / 20.0


@dataclass(frozen=True)
class MeshShape:
    """A rigid body of convex parts. The body frame has its origin at the centre of mass and the axes of the mesh file.

    Attributes:
        path: path of the mesh file.
        scale: length of one coordinate unit of the mesh file [m].
        digest: digest of the file's content. Shapes from equal files are equal.
        parts: convex parts, which can touch but do not overlap.
        volume: volume of the body [m^3].
        moments: moments of inertia about the three axes, divided by the mass [m^2].
        skew: ratio of the largest product of inertia to the largest moment of inertia. 0 for principal axes.
    """

    path: Path = field(compare=False)
    scale: float
    digest: str
    parts: tuple[Hull, ...] = field(compare=False, repr=False)
    volume: float = field(compare=False)
    moments: tuple[float, float, float] = field(compare=False)
    skew: float = field(compare=False)

    @classmethod
    def of(cls, path: Path, scale: float, digest: str, solids: Sequence[Hull]) -> "MeshShape":
        """Return the shape of several solids, translated so that their common centre of mass is the origin."""
        volume, first, _ = _sum(solids)
        moved = tuple(each.moved(-first / volume) for each in solids)
        _, _, second = _sum(moved)
        spread = np.diag(second) / volume
        x, y, z = (float(moment) for moment in spread.sum() - spread)
        products = np.abs(second - np.diag(np.diag(second))) / volume
        return cls(path, scale, digest, moved, volume, (x, y, z), float(products.max() / max(x, y, z)))

    @property
    def vertices(self) -> FloatArray:
        """Vertices of all parts [m], shape ``(n, 3)``."""
        return np.concatenate([part.vertices for part in self.parts])

    @property
    def corners(self) -> FloatArray:
        """Lower and upper corner of the bounding box in the body frame [m], shape ``(2, 3)``."""
        vertices = self.vertices
        return np.array([vertices.min(axis=0), vertices.max(axis=0)])


def _sum(solids: Sequence[Hull]) -> tuple[float, FloatArray, FloatArray]:
    volumes, firsts, seconds = zip(*(each.integrals for each in solids), strict=True)
    return float(sum(volumes)), np.asarray(np.sum(firsts, axis=0)), np.asarray(np.sum(seconds, axis=0))


def obj_text(solids: Sequence[Hull]) -> str:
    """Return the text of a Wavefront OBJ file that has a separate object for each solid."""
    lines: list[str] = []
    first = 1
    for number, solid in enumerate(solids, start=1):
        lines.append(f"o part-{number}")
        lines += ["v {:.9g} {:.9g} {:.9g}".format(*vertex) for vertex in solid.vertices]
        lines += ["f {} {} {}".format(*triangle) for triangle in solid.triangles + first]
        first += len(solid.vertices)
    return "\n".join(lines) + "\n"
