"""Read mesh files (Wavefront OBJ) and refuse those that physics cannot use, with the offending figure."""

import hashlib
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.geometry.meshes import Hull, MeshShape
from hybrid_tamp.geometry.shapes import MeshFile
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.taskfile.yaml.nodes import read_text

MOST_TRIANGLES = 200_000
MOST_BYTES = 64 * 1024 * 1024
MOST_SOLIDS = 1000
SMALLEST, LARGEST = 0.001, 10.0
"""Bounds of the longest edge of a body's bounding box [m]; outside them the unit is wrong."""
MOST_SKEW = 0.05
_WHAT = "a mesh file"
_THINNEST = 1e-6
"""Least volume of a solid, as a share of the cube of its longest edge."""
_DENT = 1e-3
"""Deepest dent of a convex solid, as a share of its longest edge: numbers in files are rounded."""
_SAME = 1e-7
"""Corners closer than this are one corner, as a share of the body's longest edge."""


@dataclass
class _Surface:
    """One object of the file.

    Attributes:
        name: its name, or a number if it has none.
        triangles: indices of the file's vertices, three per triangle; polygons are cut into fans.
    """

    name: str
    triangles: list[tuple[int, int, int]] = field(default_factory=list)


def _read_objects(text: str, source: str) -> tuple[FloatArray, list[_Surface]]:
    """Return the vertices ``(n, 3)`` of a file and its objects that have triangles.

    Args:
        text: the file.
        source: name of the file in messages.

    Raises:
        InputError: a vertex is not three finite numbers, or a face names a vertex that does not exist.
    """
    vertices: list[tuple[float, float, float]] = []
    objects = [_Surface("1")]
    for number, line in enumerate(text.splitlines(), start=1):
        keyword, *words = line.split() or ("",)
        try:
            if keyword == "v":
                x, y, z = (float(word) for word in words[:3])
                vertices.append((x, y, z))
            elif keyword == "f":
                corners = [_index(word, len(vertices)) for word in words]
                fans = pairwise(corners[1:])
                objects[-1].triangles += [(corners[0], one, other) for one, other in fans]
            elif keyword in ("o", "g"):
                objects.append(_Surface(" ".join(words) or str(len(objects))))
        except (ValueError, IndexError) as error:
            wanted = "a vertex 'v x y z' of three numbers" if keyword == "v" else "a face 'f i j k' of vertices above"
            raise InputError([Issue(f"{source}:{number}", wanted, repr(line[:60]))]) from error
    found = np.array(vertices, dtype=float).reshape(-1, 3)
    if not np.isfinite(found).all():
        raise InputError([Issue(source, "a mesh of finite coordinates", "one that is not finite")])
    return found, [surface for surface in objects if surface.triangles]


def _index(word: str, count: int) -> int:
    """Return the index of a face's corner, e.g. ``3``, ``3/1/2`` or ``-1``, which counts from the last vertex."""
    number = int(word.split("/")[0])
    index = number - 1 if number > 0 else count + number
    if not 0 <= index < count or number == 0:
        raise IndexError(word)
    return index


def read_mesh(path: Path, written: MeshFile) -> MeshShape:
    """Read a mesh file.

    Args:
        path: the file.
        written: the entry of the task file.

    Raises:
        InputError: the file is missing, not OBJ, empty, too large or in the wrong unit; or an object is degenerate,
            not watertight, not in one piece or not convex; or the axes are far from the principal axes.
    """
    source = str(path)
    if path.suffix.lower() != ".obj":
        raise InputError(
            [Issue(source, "a Wavefront OBJ file, whose name ends in .obj", repr(path.suffix or path.name))]
        )
    if path.is_file() and path.stat().st_size > MOST_BYTES:
        _check_count(_triangles_in(path), source)
    text = read_text(path, _WHAT, MOST_BYTES)
    vertices, surfaces = _read_objects(text, source)
    _check_count(sum(len(surface.triangles) for surface in surfaces), source)
    if len(surfaces) > MOST_SOLIDS:
        raise InputError([Issue(source, f"a mesh of at most {MOST_SOLIDS} convex parts", str(len(surfaces)))])
    size = _size(vertices, surfaces) * written.scale
    if not SMALLEST <= size <= LARGEST:
        remedy = (
            "is the file in millimetres? then write scale: 0.001" if size > LARGEST else "give the scale of its unit"
        )
        wanted = f"a body between {SMALLEST:g} m and {LARGEST:g} m long"
        raise InputError([Issue(source, wanted, f"one of {size:.4g} m", remedy=remedy)])
    solids = [_solid(vertices * written.scale, surface, size, source) for surface in surfaces]
    shape = MeshShape.of(path.absolute(), written.scale, digest_of(text), solids)
    if shape.skew > MOST_SKEW:
        wanted = f"a mesh whose axes are its principal ones, up to a product of inertia of {MOST_SKEW:g} of its moment"
        raise InputError(
            [Issue(source, wanted, f"{shape.skew:.3g}", remedy="turn it in its file and back by its pose")]
        )
    return shape


def digest_of(text: str) -> str:
    """Return a digest of the content of a mesh file."""
    return hashlib.sha256(text.encode()).hexdigest()


def _triangles_in(path: Path) -> int:
    """Count the faces of a file that is too large to read as a whole."""
    count, before = 0, b"\n"
    with path.open("rb") as file:
        while block := file.read(1 << 24):
            count += (before + block).count(b"\nf ")
            before = block[-2:]
    return count


def _check_count(count: int, source: str) -> None:
    if count == 0:
        raise InputError([Issue(source, "a mesh with triangles", "none")])
    if count > MOST_TRIANGLES:
        wanted = f"a mesh of at most {MOST_TRIANGLES} triangles"
        raise InputError([Issue(source, wanted, str(count), remedy="simplify it: only its convex hulls matter")])


def _size(vertices: FloatArray, surfaces: list[_Surface]) -> float:
    used = vertices[np.unique([index for surface in surfaces for triangle in surface.triangles for index in triangle])]
    return float(np.ptp(used, axis=0).max())


def _solid(vertices: FloatArray, surface: _Surface, size: float, source: str) -> Hull:
    """Return one object as a convex solid; equal corners are merged."""
    corners = vertices[np.array(surface.triangles)].reshape(-1, 3)
    _, first, names = np.unique(np.round(corners / (_SAME * size)), axis=0, return_index=True, return_inverse=True)
    solid = Hull(corners[first], names.reshape(-1, 3).astype(np.intp))
    fault = _fault(solid)
    if fault is not None:
        wanted, came = fault
        raise InputError([Issue(source, f"object {surface.name!r} of the mesh must be {wanted}", came)])
    return solid if solid.integrals[0] > 0 else Hull(solid.vertices, solid.triangles[:, ::-1])


def _fault(solid: Hull) -> tuple[str, str] | None:
    """Return the violated requirement and what was found instead, or None.

    A closed surface of the sphere's topology without a dent across any edge is convex.
    """
    size = float(np.ptp(solid.vertices, axis=0).max())
    corners = solid.vertices[solid.triangles]
    crossed = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(crossed, axis=1) / 2.0
    thin = int(np.sum(areas < 1e-12 * size**2))
    if thin:
        return "without degenerate triangles", f"{thin} of {len(areas)} have no area"
    edges = solid.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    partners = _partners(edges)
    if partners is None:
        pairs, counts = np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)
        odd = int(np.sum(counts != 2))
        said = f"{odd} of its {len(pairs)} edges do not join two triangles" if odd else "triangles of two orientations"
        return "watertight", said
    if len(solid.vertices) - len(edges) // 2 + len(areas) != 2:
        return "one solid without holes", "several pieces, or one with holes"
    volume = solid.integrals[0]
    if abs(volume) < _THINNEST * size**3:
        return "a solid", f"degenerate: a volume of {abs(volume):.3g} m^3 at a length of {size:.3g} m"
    normals = np.repeat(crossed / (2.0 * areas[:, None]) * np.sign(volume), 3, axis=0)
    apexes = solid.triangles[:, [2, 0, 1]].reshape(-1)[partners]
    dent = float(np.max(np.sum(normals * (solid.vertices[apexes] - solid.vertices[edges[:, 0]]), axis=1)))
    if dent > _DENT * size:
        return "convex: split it into convex objects", f"a dent of {dent:.3g} m"
    return None


def _partners(edges: NDArray[np.intp]) -> NDArray[np.intp] | None:
    """Return the index of the opposite of each directed edge ``(e, 2)``; None if an edge has none or several."""
    count = int(edges.max()) + 1
    keys, mirrored = edges @ [count, 1], edges @ [1, count]
    order = np.argsort(keys)
    found = np.searchsorted(keys[order], mirrored)
    if len(np.unique(keys)) < len(keys) or not np.array_equal(np.sort(keys), np.sort(mirrored)):
        return None
    return np.asarray(order[found])
