"""Read mesh files (Wavefront OBJ) and refuse meshes that the physics backend cannot use."""

import hashlib
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.geometry.common_volume import MOST_SHARED, find_overlap
from hybrid_tamp.geometry.convex import placed
from hybrid_tamp.geometry.gaps import MOST_APART, find_gap
from hybrid_tamp.geometry.meshes import Hull, MeshShape
from hybrid_tamp.geometry.shapes import MeshFile
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.taskfile.yaml.nodes import read_text

MOST_TRIANGLES = 200_000
MOST_BYTES = 64 * 1024 * 1024
MOST_SOLIDS = 1000
SMALLEST, LARGEST = 0.001, 10.0
"""Bounds of the longest edge of a body's bounding box [m]. Outside these bounds, the unit is probably wrong."""
MOST_SKEW = 0.05
_WHAT = "a mesh file"
_THINNEST = 1e-6
"""Minimum volume of a solid, relative to the cube of the longest edge of its bounding box."""
_DENT = 1e-3
"""Maximum dent of a convex solid, relative to the longest edge of its bounding box. Rounding causes small dents."""
_SAME = 1e-7
"""Maximum distance between corners that are merged, relative to the longest edge of the body's bounding box."""


@dataclass
class _Surface:
    """An object of a mesh file: its name or number, and the indices of the three vertices of each triangle."""

    name: str
    triangles: list[tuple[int, int, int]] = field(default_factory=list)


def _read_objects(text: str, source: str) -> tuple[FloatArray, list[_Surface]]:
    """Return the vertices ``(n, 3)`` of a mesh file and its objects that have triangles, or raise `InputError`."""
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
                # Polygons are split into triangle fans.
                objects[-1].triangles += [(corners[0], one, other) for one, other in pairwise(corners[1:])]
            elif keyword in ("o", "g"):
                objects.append(_Surface(" ".join(words) or str(len(objects))))
        except (ValueError, IndexError) as error:
            wanted = (
                "a vertex must be 'v x y z' with three numbers"
                if keyword == "v"
                else "a face must be 'f i j k' with indices of vertices that precede the face"
            )
            raise InputError([Issue(f"{source}:{number}", wanted, repr(line[:60]))]) from error
    found = np.array(vertices, dtype=float).reshape(-1, 3)
    if not np.isfinite(found).all():
        raise InputError([Issue(source, "the coordinates of a mesh must be finite", "infinity or NaN")])
    return found, [surface for surface in objects if surface.triangles]


def _index(word: str, count: int) -> int:
    """Return the index of the vertex at a corner of a face, e.g. ``3``, ``3/1/2`` or ``-1`` for the last vertex."""
    number = int(word.split("/")[0])
    index = number - 1 if number > 0 else count + number
    if not 0 <= index < count or number == 0:
        raise IndexError(word)
    return index


def read_mesh(path: Path, written: MeshFile) -> MeshShape:
    """Read a mesh file. Tokens with the same file share one shape.

    Args:
        path: path of the file.
        written: the shape's entry in the task file.

    Raises:
        InputError: the file is missing, not OBJ, empty, too large or in the wrong unit. Or an object is degenerate,
            not watertight, not in one piece or not convex. Or objects overlap or lie apart. Or the axes are far from
            the principal axes.
    """
    source = str(path)
    if path.suffix.lower() != ".obj":
        wanted = "the name of a mesh file must end in .obj (Wavefront)"
        raise InputError([Issue(source, wanted, repr(path.suffix or path.name))])
    if path.is_file() and path.stat().st_size > MOST_BYTES:
        _check_count(_triangles_in(path), source)
    return _read_text(path.absolute(), source, written.scale, read_text(path, _WHAT, MOST_BYTES))


@lru_cache(maxsize=4)
def _read_text(path: Path, source: str, scale: float, text: str) -> MeshShape:
    """Return the shape in the text of a mesh file. The cache keeps only the last files, because texts can be large."""
    vertices, surfaces = _read_objects(text, source)
    _check_count(sum(len(surface.triangles) for surface in surfaces), source)
    if len(surfaces) > MOST_SOLIDS:
        raise InputError([Issue(source, f"a mesh must have at most {MOST_SOLIDS} convex parts", str(len(surfaces)))])
    size = _size(vertices, surfaces) * scale
    if not SMALLEST <= size <= LARGEST:
        remedy = (
            "write scale: 0.001 if the file is in millimetres"
            if size > LARGEST
            else "set scale to the length of one unit in metres"
        )
        wanted = f"the length of a mesh must be between {SMALLEST:g} m and {LARGEST:g} m"
        raise InputError([Issue(source, wanted, f"{size:.4g} m", remedy=remedy)])
    solids = [_solid(vertices * scale, surface, size, source) for surface in surfaces]
    shape = MeshShape.of(path, scale, digest_of(text), solids)
    _check_solids(shape, [surface.name for surface in surfaces], size, source)
    if shape.skew > MOST_SKEW:
        wanted = f"the products of inertia of a mesh must be at most {MOST_SKEW:g} times its largest moment of inertia"
        remedy = "rotate the mesh in its file to its principal axes and adapt the pose"
        raise InputError([Issue(source, wanted, f"{shape.skew:.3g}", remedy=remedy)])
    return shape


def _check_solids(shape: MeshShape, names: list[str], size: float, source: str) -> None:
    """Raise `InputError` if objects of the mesh overlap or lie apart. No volume may count twice."""
    overlap = find_overlap(shape.parts)
    if overlap is not None:
        pair = f"{names[overlap.one]!r} and {names[overlap.other]!r}"
        wanted = f"objects {pair} of the mesh must not share more than {MOST_SHARED:.0%} of the smaller volume"
        came = f"{overlap.volume:.3g} m^3 of {overlap.smaller:.3g} m^3 in the smaller object"
        remedy = "cut one of the two objects, because the common volume would count twice"
        raise InputError([Issue(source, wanted, came, remedy=remedy)])
    gap = find_gap(placed(shape, np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0])), MOST_APART * size)
    if gap is not None:
        wanted = f"the objects of the mesh must touch, with gaps of at most {MOST_APART * size:.3g} m"
        came = f"a gap of {gap.width:.3g} m between {names[gap.one]!r} and {names[gap.other]!r}"
        raise InputError([Issue(source, wanted, came, remedy="join the objects, or use a token for each piece")])


def digest_of(text: str) -> str:
    """Return a digest of the content of a mesh file."""
    return hashlib.sha256(text.encode()).hexdigest()


def _triangles_in(path: Path) -> int:
    """Return the number of faces in a file that is too large to be read as a whole."""
    count, before = 0, b"\n"
    with path.open("rb") as file:
        while block := file.read(1 << 24):
            count += (before + block).count(b"\nf ")
            before = block[-2:]
    return count


def _check_count(count: int, source: str) -> None:
    if count == 0:
        raise InputError([Issue(source, "a mesh must have triangles", "none")])
    if count > MOST_TRIANGLES:
        wanted = f"a mesh must have at most {MOST_TRIANGLES} triangles"
        remedy = "simplify the mesh, because only its convex hulls matter"
        raise InputError([Issue(source, wanted, str(count), remedy=remedy)])


def _size(vertices: FloatArray, surfaces: list[_Surface]) -> float:
    used = vertices[np.unique([index for surface in surfaces for triangle in surface.triangles for index in triangle])]
    return float(np.ptp(used, axis=0).max())


def _solid(vertices: FloatArray, surface: _Surface, size: float, source: str) -> Hull:
    """Return an object of the mesh as a convex solid in which equal corners are merged, or raise `InputError`."""
    corners = vertices[np.array(surface.triangles)].reshape(-1, 3)
    _, first, names = np.unique(np.round(corners / (_SAME * size)), axis=0, return_index=True, return_inverse=True)
    solid = Hull(corners[first], names.reshape(-1, 3).astype(np.intp))
    fault = _fault(solid)
    if fault is not None:
        wanted, came = fault
        raise InputError([Issue(source, f"object {surface.name!r} of the mesh must be {wanted}", came)])
    return solid if solid.integrals[0] > 0 else Hull(solid.vertices, solid.triangles[:, ::-1])


def _fault(solid: Hull) -> tuple[str, str] | None:
    """Return a pair of (violated requirement, finding), or None if the surface is closed and convex."""
    size = float(np.ptp(solid.vertices, axis=0).max())
    corners = solid.vertices[solid.triangles]
    crossed = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(crossed, axis=1) / 2.0
    thin = int(np.sum(areas < 1e-12 * size**2))
    if thin:
        return "without degenerate triangles", f"{thin} of {len(areas)} triangles without area"
    edges = solid.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    partners = _partners(edges)
    if partners is None:
        pairs, counts = np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)
        odd = int(np.sum(counts != 2))
        said = (
            f"{odd} of {len(pairs)} edges do not join exactly two triangles"
            if odd
            else "triangles with inconsistent orientations"
        )
        return "watertight", said
    # A closed surface is convex if it has the topology of a sphere and no dent at any edge.
    if len(solid.vertices) - len(edges) // 2 + len(areas) != 2:
        return "one solid without holes", "several pieces, or one piece with holes"
    volume = solid.integrals[0]
    if abs(volume) < _THINNEST * size**3:
        return "a solid", f"a volume of only {abs(volume):.3g} m^3 at a length of {size:.3g} m"
    normals = np.repeat(crossed / (2.0 * areas[:, None]) * np.sign(volume), 3, axis=0)
    apexes = solid.triangles[:, [2, 0, 1]].reshape(-1)[partners]
    dent = float(np.max(np.sum(normals * (solid.vertices[apexes] - solid.vertices[edges[:, 0]]), axis=1)))
    if dent > _DENT * size:
        return "convex (a concave body needs several objects)", f"a dent of {dent:.3g} m"
    return None


def _partners(edges: NDArray[np.intp]) -> NDArray[np.intp] | None:
    """Return the index of each directed edge's reversed edge ``(e, 2)``, or None if an edge has none or several."""
    count = int(edges.max()) + 1
    keys, mirrored = edges @ [count, 1], edges @ [1, count]
    order = np.argsort(keys)
    found = np.searchsorted(keys[order], mirrored)
    if len(np.unique(keys)) < len(keys) or not np.array_equal(np.sort(keys), np.sort(mirrored)):
        return None
    return np.asarray(order[found])
