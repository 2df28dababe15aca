"""Read a demonstration: a table of time and position, or of time and pose.

::

    time [s], x [m], y [m], z [m]
    0.00, 0.250, -0.450, 0.300

The first line names the columns; units may follow in brackets. Poses also have the columns qx, qy, qz, qw.
"""

import re
from pathlib import Path

import numpy as np

from hybrid_tamp.motion.demonstration import MINIMAL_SAMPLES, ShownMovement
from hybrid_tamp.taskfile.places import Faults, Mark, shown
from hybrid_tamp.taskfile.tables import MAX_BYTES, Cell, check_quaternions, check_times, numbered, sample
from hybrid_tamp.taskfile.yaml.nodes import read_text

_POSITION = ("time", "x", "y", "z")
_POSE = (*_POSITION, "qx", "qy", "qz", "qw")
_NAME = re.compile(r"^([a-z]*)\s*(\[[^]]*\])?$")


def read_demonstration(path: Path | str) -> ShownMovement:
    """Read one demonstration.

    Raises:
        InputError: everything that is wrong with the file, each fault with its line and column.
    """
    path = Path(path)
    rows = numbered(read_text(path, "a demonstration", MAX_BYTES))
    faults = Faults(str(path))
    width = _check_header(rows[0][1] if rows else [], faults)
    samples = [values for _, cells in rows[1:] if (values := sample(cells, width, faults)) is not None]
    faults.raise_if_any()
    table = np.array(samples, dtype=np.float64).reshape(-1, width)
    lines = [number for number, _ in rows[1:]]
    check_times(table[:, 0], lines, MINIMAL_SAMPLES, faults)
    if width == len(_POSE):
        check_quaternions(table[:, 4:], lines, faults)
    faults.raise_if_any()
    orientations = table[:, 4:] / np.linalg.norm(table[:, 4:], axis=-1, keepdims=True) if width == len(_POSE) else None
    return ShownMovement(path.name, table[:, 0], table[:, 1:4], orientations)


def _check_header(cells: list[Cell], faults: Faults) -> int:
    """Return the number of columns, or raise the faults if the columns are not those of a demonstration."""
    found = [_NAME.match(cell.text.casefold()) for cell in cells]
    names = tuple(match.group(1) if match else "" for match in found)
    if names not in (_POSITION, _POSE):
        wanted = f"the first line must name the columns {', '.join(_POSITION)}; for poses also {', '.join(_POSE[4:])}"
        faults.add(Mark(), wanted, shown(",".join(cell.text for cell in cells)) if cells else "an empty file")
        faults.raise_all()
    return len(names)
