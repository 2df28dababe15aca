"""Demonstrations as files: a table of time and position, or of time and pose, with every fault at its place.

::

    time [s], x [m], y [m], z [m]
    0.00, 0.250, -0.450, 0.300

The first line names the columns; units may follow in brackets. Poses have the columns qx, qy, qz, qw as well.
"""

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hybrid_tamp.motion.demonstration import MINIMAL_SAMPLES, ShownMovement
from hybrid_tamp.taskfile.places import Faults, Mark, shown
from hybrid_tamp.taskfile.yaml_nodes import read_text

MAX_BYTES = 64 * 1024**2
"""Largest demonstration that is read [bytes]."""
_POSITION = ("time", "x", "y", "z")
_POSE = (*_POSITION, "qx", "qy", "qz", "qw")
_LARGEST = 1e6
_UNIT_TOLERANCE = 0.01
_NAME = re.compile(r"^([a-z]*)\s*(\[[^]]*\])?$")


@dataclass(frozen=True)
class _Cell:
    text: str
    mark: Mark


def read_demonstration(path: Path | str) -> ShownMovement:
    """Read one demonstration.

    Raises:
        InputError: everything that is wrong with the file, each fault with its line and column.
    """
    path = Path(path)
    lines = read_text(path, "a demonstration", MAX_BYTES).splitlines()
    faults = Faults(str(path))
    rows = [(number, list(_cells(line, number))) for number, line in enumerate(lines, start=1) if line.strip()]
    width = _check_header(rows[0][1] if rows else [], faults)
    samples = [sample for _, cells in rows[1:] if (sample := _sample(cells, width, faults)) is not None]
    faults.raise_if_any()
    table = np.array(samples, dtype=np.float64).reshape(-1, width)
    _check_samples(table, [number for number, _ in rows[1:]], faults)
    faults.raise_if_any()
    orientations = table[:, 4:] / np.linalg.norm(table[:, 4:], axis=-1, keepdims=True) if width == len(_POSE) else None
    return ShownMovement(path.name, table[:, 0], table[:, 1:4], orientations)


def _cells(line: str, number: int) -> Iterator[_Cell]:
    column = 1
    for text in line.split(","):
        indent = len(text) - len(text.lstrip())
        yield _Cell(text.strip(), Mark(number, column + indent))
        column += len(text) + 1


def _check_header(cells: list[_Cell], faults: Faults) -> int:
    """Return how many columns there are; the faults are raised if they are not those of a demonstration."""
    found = [_NAME.match(cell.text.casefold()) for cell in cells]
    names = tuple(match.group(1) if match else "" for match in found)
    if names not in (_POSITION, _POSE):
        wanted = f"the first line names the columns {', '.join(_POSITION)}; of poses, {', '.join(_POSE[4:])} as well"
        faults.add(Mark(), wanted, shown(",".join(cell.text for cell in cells)) if cells else "an empty file")
        faults.raise_all()
    return len(names)


def _sample(cells: list[_Cell], width: int, faults: Faults) -> list[float] | None:
    if len(cells) != width:
        faults.add(cells[min(width, len(cells) - 1)].mark, f"every line has {width} columns", f"{len(cells)} columns")
        return None
    values = []
    for cell in cells:
        try:
            value = float(cell.text)
        except ValueError:
            faults.add(cell.mark, "a number", shown(cell.text) if cell.text else "nothing")
            return None
        if not math.isfinite(value) or abs(value) > _LARGEST:
            faults.add(cell.mark, f"a finite number of at most {_LARGEST:g} in size", cell.text)
            return None
        values.append(value)
    return values


def _check_samples(
    table: "np.ndarray[tuple[int, ...], np.dtype[np.float64]]", lines: list[int], faults: Faults
) -> None:
    last = lines[-1] if lines else 1
    if len(table) < MINIMAL_SAMPLES:
        faults.add(Mark(last), f"a demonstration has at least {MINIMAL_SAMPLES} samples", f"{len(table)} samples")
    for row in np.flatnonzero(np.diff(table[:, 0]) <= 0.0) + 1:
        came = f"{table[row, 0]:g} s after {table[row - 1, 0]:g} s"
        faults.add(Mark(lines[row]), "time must increase from line to line", came)
    lengths = np.linalg.norm(table[:, 4:], axis=-1)
    for row in np.flatnonzero(np.abs(lengths - 1.0) > _UNIT_TOLERANCE) if table.shape[1] > len(_POSITION) else ():
        faults.add(Mark(lines[row]), "qx, qy, qz, qw are a unit quaternion", f"one of length {lengths[row]:.3g}")
