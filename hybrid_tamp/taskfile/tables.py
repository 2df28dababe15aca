"""Read comma-separated tables of numbers and record every fault at its place."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.taskfile.places import Faults, Mark, shown

MAX_BYTES = 64 * 1024**2
"""Largest table that is read [bytes]."""
_LARGEST = 1e6
_UNIT_TOLERANCE = 0.01


@dataclass(frozen=True)
class Cell:
    """One entry of a table and its place."""

    text: str
    mark: Mark


def cells(line: str, number: int) -> Iterator[Cell]:
    """Yield the entries of a line."""
    column = 1
    for text in line.split(","):
        indent = len(text) - len(text.lstrip())
        yield Cell(text.strip(), Mark(number, column + indent))
        column += len(text) + 1


def numbered(text: str) -> list[tuple[int, list[Cell]]]:
    """Return the lines that are not empty, each with its number and entries."""
    return [(n, list(cells(line, n))) for n, line in enumerate(text.splitlines(), start=1) if line.strip()]


def sample(entries: list[Cell], width: int, faults: Faults) -> list[float] | None:
    """Return the numbers of a line, or record a fault and return None."""
    if len(entries) != width:
        mark = entries[min(width, len(entries) - 1)].mark
        faults.add(mark, f"every line has {width} columns", f"{len(entries)} columns")
        return None
    values = []
    for cell in entries:
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


def check_times(times: FloatArray, lines: list[int], least: int, faults: Faults) -> None:
    """Record a fault if there are too few samples or time does not increase.

    Args:
        times: the times [s], shape ``(t,)``.
        lines: the line of each sample.
        least: least number of samples.
        faults: the file's faults.
    """
    if len(times) < least:
        last = lines[-1] if lines else 1
        faults.add(Mark(last), f"a demonstration has at least {least} samples", f"{len(times)} samples")
    for row in np.flatnonzero(np.diff(times) <= 0.0) + 1:
        came = f"{times[row]:g} s after {times[row - 1]:g} s"
        faults.add(Mark(lines[row]), "time must increase from line to line", came)


def check_quaternions(quaternions: FloatArray, lines: list[int], faults: Faults, name: str = "") -> None:
    """Record every quaternion that is not a unit quaternion.

    Args:
        quaternions: x, y, z, w, shape ``(t, 4)``.
        lines: the line of each sample.
        faults: the file's faults.
        name: prefix of the columns' names.
    """
    lengths = np.linalg.norm(quaternions, axis=-1)
    for row in np.flatnonzero(np.abs(lengths - 1.0) > _UNIT_TOLERANCE):
        columns = ", ".join(f"{name}{letter}" for letter in ("qx", "qy", "qz", "qw"))
        faults.add(Mark(lines[row]), f"{columns} are a unit quaternion", f"one of length {lengths[row]:.3g}")
