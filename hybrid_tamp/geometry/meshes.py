"""Bodies of convex parts given by their surfaces, as read from a mesh file. All lengths are in metres."""

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
    """The surface of a convex part, in the frame of its body.

    Attributes:
        vertices: ``(n, 3)`` [m].
        triangles: indices of vertices ``(m, 3)``, counterclockwise seen from outside.
    """

    position: ClassVar[tuple[float, float, float]] = _CENTRE
    rpy: ClassVar[tuple[float, float, float]] = _CENTRE

    vertices: FloatArray
    triangles: NDArray[np.intp]

    def moved(self, offset: FloatArray) -> "Hull":
        """Return the part moved by an offset ``(3,)`` [m]."""
        return Hull(self.vertices + offset, self.triangles)

    @property
    def integrals(self) -> tuple[float, FloatArray, FloatArray]:
        """Volume [m^3], first moments ``(3,)`` [m^4] and second moments ``(3, 3)`` [m^5] about the frame's origin.

        The part is the sum of the tetrahedra between its triangles and the origin, each with the sign of its volume.
        """
        corners = self.vertices[self.triangles]  # (m, 3 corners, 3)
        volumes = np.einsum("mi,mi->m", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0
        sums = corners.sum(axis=1)
        first = volumes @ sums / 4.0
        second = np.einsum("m,mci,mcj->ij", volumes, corners, corners) + np.einsum("m,mi,mj->ij", volumes, sums, sums)
        return float(volumes.sum()), first, second / 20.0


@dataclass(frozen=True)
class MeshShape:
    """A rigid body of convex parts; its frame has the origin in the centre of mass and the axes of the file.

    Attributes:
        path: the mesh file.
        scale: length of the file's unit [m].
        digest: of the file's content, so that shapes of equal files are equal.
        parts: the convex parts; they touch and do not overlap.
        volume: [m^3].
        moments: moments of inertia about the axes, divided by the mass, ``3`` [m^2].
        skew: largest product of inertia over the largest moment; 0 if the axes are the principal ones.
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
        """Return the shape of solids in any frame, moved so that their common centre of mass is the origin."""
        volume, first, _ = _sum(solids)
        moved = tuple(each.moved(-first / volume) for each in solids)
        _, _, second = _sum(moved)
        spread = np.diag(second) / volume
        x, y, z = (float(moment) for moment in spread.sum() - spread)
        products = np.abs(second - np.diag(np.diag(second))) / volume
        return cls(path, scale, digest, moved, volume, (x, y, z), float(products.max() / max(x, y, z)))

    @property
    def vertices(self) -> FloatArray:
        """Every part's vertices ``(n, 3)`` [m]."""
        return np.concatenate([part.vertices for part in self.parts])

    @property
    def corners(self) -> FloatArray:
        """Lower and upper corners ``(2, 3)`` [m] of the bounding box along the body's axes."""
        vertices = self.vertices
        return np.array([vertices.min(axis=0), vertices.max(axis=0)])


def _sum(solids: Sequence[Hull]) -> tuple[float, FloatArray, FloatArray]:
    volumes, firsts, seconds = zip(*(each.integrals for each in solids), strict=True)
    return float(sum(volumes)), np.asarray(np.sum(firsts, axis=0)), np.asarray(np.sum(seconds, axis=0))


def obj_text(solids: Sequence[Hull]) -> str:
    """Return solids as the text of a Wavefront OBJ file, each as an object of its own."""
    lines: list[str] = []
    first = 1
    for number, solid in enumerate(solids, start=1):
        lines.append(f"o part-{number}")
        lines += ["v {:.9g} {:.9g} {:.9g}".format(*vertex) for vertex in solid.vertices]
        lines += ["f {} {} {}".format(*triangle) for triangle in solid.triangles + first]
        first += len(solid.vertices)
    return "\n".join(lines) + "\n"
