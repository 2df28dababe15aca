"""Read named objects of vertices and triangles from Wavefront OBJ text; the rest of the format is ignored."""

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.motion.arrays import FloatArray


@dataclass
class Surface:
    """One object of the file.

    Attributes:
        name: its name, or a number where it has none.
        triangles: indices of the file's vertices, three a triangle; polygons are cut into fans.
    """

    name: str
    triangles: list[tuple[int, int, int]] = field(default_factory=list)


def read_objects(text: str, source: str) -> tuple[FloatArray, list[Surface]]:
    """Return the vertices ``(n, 3)`` of a file and its objects that have triangles.

    Args:
        text: the file.
        source: its name as messages show it.

    Raises:
        InputError: a vertex is no three finite numbers, or a face names a vertex that is not there.
    """
    vertices: list[tuple[float, float, float]] = []
    objects = [Surface("1")]
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
                objects.append(Surface(" ".join(words) or str(len(objects))))
        except (ValueError, IndexError) as error:
            wanted = "a vertex 'v x y z' of three numbers" if keyword == "v" else "a face 'f i j k' of vertices above"
            raise InputError([Issue(f"{source}:{number}", wanted, repr(line[:60]))]) from error
    found = np.array(vertices, dtype=float).reshape(-1, 3)
    if not np.isfinite(found).all():
        raise InputError([Issue(source, "a mesh of finite coordinates", "one that is not finite")])
    return found, [surface for surface in objects if surface.triangles]


def _index(word: str, count: int) -> int:
    """Return the index of a face's corner such as ``3``, ``3/1/2`` or ``-1``, which counts from the last vertex."""
    number = int(word.split("/")[0])
    index = number - 1 if number > 0 else count + number
    if not 0 <= index < count or number == 0:
        raise IndexError(word)
    return index
