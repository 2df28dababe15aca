"""Read a demonstration from a comma-separated table of times and positions, or of times and poses.

::

    time [s], x [m], y [m], z [m]
    0.00, 0.250, -0.450, 0.300

The first line names the columns. A unit in brackets may follow a name. Poses also have the columns qx, qy, qz, qw.
"""

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.demonstration import MINIMAL_SAMPLES, ShownMovement
from hybrid_tamp.taskfile.places import Faults, Mark, shown
from hybrid_tamp.taskfile.yaml.nodes import read_text

MAX_BYTES = 64 * 1024**2
"""Maximum size of a table [bytes]."""
_LARGEST = 1e6
_UNIT_TOLERANCE = 0.01
_POSITION = ("time", "x", "y", "z")
_POSE = (*_POSITION, "qx", "qy", "qz", "qw")
_NAME = re.compile(r"^([a-z]*)\s*(\[[^]]*\])?$")


@dataclass(frozen=True)
class Cell:
    """An entry of a table, with the line and column of the entry."""

    text: str
    mark: Mark


def read_demonstration(path: Path | str) -> ShownMovement:
    """Read one demonstration.

    Raises:
        InputError: the file has faults; the issues list all faults with their lines and columns.
    """
    path = Path(path)
    rows = numbered(read_text(path, "a demonstration", MAX_BYTES))
    faults = Faults(str(path))
    width = _check_header(rows[0][1] if rows else [], faults)
    table, lines = read_samples(rows, width, faults)
    if width == len(_POSE):
        check_quaternions(table[:, 4:], lines, faults)
    faults.raise_if_any()
    orientations = table[:, 4:] / np.linalg.norm(table[:, 4:], axis=-1, keepdims=True) if width == len(_POSE) else None
    return ShownMovement(path.name, table[:, 0], table[:, 1:4], orientations)


def _check_header(cells: list[Cell], faults: Faults) -> int:
    """Return the number of columns, or raise `InputError` if the columns are wrong."""
    names = tuple(match[1] if (match := _NAME.match(cell.text.casefold())) else "" for cell in cells)
    if names not in (_POSITION, _POSE):
        wanted = f"the first line must name the columns {', '.join(_POSITION)} (for poses also {', '.join(_POSE[4:])})"
        faults.add(Mark(), wanted, shown(",".join(cell.text for cell in cells)) if cells else "an empty file")
        faults.raise_all()
    return len(names)


def cells(line: str, number: int) -> Iterator[Cell]:
    """Yield the entries of a line, each with its line and column."""
    column = 1
    for text in line.split(","):
        yield Cell(text.strip(), Mark(number, column + len(text) - len(text.lstrip())))
        column += len(text) + 1


def numbered(text: str) -> list[tuple[int, list[Cell]]]:
    """Return a pair of (line number, entries) for each line that is not empty."""
    return [(n, list(cells(line, n))) for n, line in enumerate(text.splitlines(), start=1) if line.strip()]


def read_samples(rows: list[tuple[int, list[Cell]]], width: int, faults: Faults) -> tuple[FloatArray, list[int]]:
    """Return the numbers below the header, shape ``(t, width)``, and the line number of each row.

    A fault is recorded if there are too few samples or the times in the first column do not increase.

    Raises:
        InputError: a line does not have `width` columns, or an entry is not a number.
    """
    samples = [values for _, cells in rows[1:] if (values := _sample(cells, width, faults)) is not None]
    faults.raise_if_any()
    table, lines = np.array(samples, dtype=np.float64).reshape(-1, width), [number for number, _ in rows[1:]]
    times = table[:, 0]
    if len(times) < MINIMAL_SAMPLES:
        wanted = f"a demonstration must have at least {MINIMAL_SAMPLES} samples"
        faults.add(Mark(lines[-1] if lines else 1), wanted, f"{len(times)} samples")
    for row in np.flatnonzero(np.diff(times) <= 0.0) + 1:
        came = f"{times[row]:g} s after {times[row - 1]:g} s"
        faults.add(Mark(lines[row]), "time must increase from line to line", came)
    return table, lines


def _sample(entries: list[Cell], width: int, faults: Faults) -> list[float] | None:
    """Return the numbers in a line. If the line has a fault, record the fault and return None."""
    if len(entries) != width:
        mark = entries[min(width, len(entries) - 1)].mark
        faults.add(mark, f"every line must have {width} columns", f"{len(entries)} columns")
        return None
    values = []
    for cell in entries:
        try:
            value = float(cell.text)
        except ValueError:
            faults.add(cell.mark, "must be a number", shown(cell.text) if cell.text else "nothing")
            return None
        if not math.isfinite(value) or abs(value) > _LARGEST:
            faults.add(cell.mark, f"must be a finite number between -{_LARGEST:g} and {_LARGEST:g}", cell.text)
            return None
        values.append(value)
    return values


def check_quaternions(quaternions: FloatArray, lines: list[int], faults: Faults, name: str = "") -> None:
    """Record every quaternion whose length is not 1.

    Args:
        quaternions: the quaternions as x, y, z, w, shape ``(t, 4)``.
        lines: the line number of each sample.
        faults: the faults of the file.
        name: prefix of the names of the columns.
    """
    lengths = np.linalg.norm(quaternions, axis=-1)
    for row in np.flatnonzero(np.abs(lengths - 1.0) > _UNIT_TOLERANCE):
        columns = ", ".join(f"{name}{letter}" for letter in ("qx", "qy", "qz", "qw"))
        faults.add(Mark(lines[row]), f"{columns} must be a unit quaternion", f"length {lengths[row]:.3g}")
