"""Read a demonstration of a whole scene from a table of times and token poses.

::

    time [s], hand.x, hand.y, hand.z, drum.x, drum.y, drum.z, drum.qx, drum.qy, drum.qz, drum.qw
    0.00, 0.250, -0.450, 0.300, 0.0, 0.0, 0.1, 0.7071, 0.0, 0.0, 0.7071

A token without the columns qx, qy, qz, qw keeps its initial orientation. A token without columns keeps its initial
pose. Other varying properties of a token, e.g. ``hand.aperture``, may have columns too.
"""

import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from hybrid_tamp.model.control import CONTROL_PERIOD
from hybrid_tamp.model.state import State
from hybrid_tamp.model.table_columns import TIME, column_names
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_conjugate, quaternion_multiply, rotation_vector
from hybrid_tamp.taskfile.demonstrations import MAX_BYTES, Cell, check_quaternions, numbered, read_samples
from hybrid_tamp.taskfile.places import Faults, Mark, shown
from hybrid_tamp.taskfile.yaml.nodes import read_text

LONGEST = 600.0
"""Longest demonstration [s]."""
_RATE_OF = {"position": "velocity", "orientation": "angular_velocity"}
_NAME = re.compile(r"^(.*?)\s*(\[[^]]*\])?$")
_SPANS = (0.03, 0.15)
"""Shortest and longest time span for the estimation of velocities [s]. The span is longer if the poses are noisier."""
_SPAN_PER_DEVIATION = 100.0
"""Ratio of the span to the standard deviation of the noise [s/m or s/rad]."""
Columns = Mapping[tuple[str, str], list[int]]
"""Maps each pair of (token, property) to the columns of the property's components."""


def read_poses(path: Path | str, task: Task) -> tuple[FloatArray, State, State]:
    """Read a demonstration of a whole scene.

    Args:
        path: path of the file.
        task: the task with the tokens of the demonstration.

    Returns:
        Tuple of (times, states, noise). The times [s] are one control period apart and have the shape ``(t,)``. The
        states at these times have the batch shape ``(t,)`` and include velocities. The noise is a single state that
        contains the standard deviation of each varying property.

    Raises:
        InputError: the file has faults; the issues list all faults with their lines and columns.
    """
    rows = numbered(read_text(Path(path), "a demonstration", MAX_BYTES))
    faults = Faults(str(path))
    header = rows[0][1] if rows else []
    columns = _columns(header, task, faults)
    faults.raise_if_any()
    table, lines = read_samples(rows, len(header), faults)
    for (token, name), places in columns.items():
        if name == "orientation":
            check_quaternions(table[:, places], lines, faults, f"{token}.")
    if len(table) and table[-1, 0] - table[0, 0] > LONGEST:
        came = f"{table[-1, 0] - table[0, 0]:g} s"
        faults.add(Mark(lines[-1]), f"a demonstration must not be longer than {LONGEST:g} s", came)
    faults.raise_if_any()
    return _states(table, columns, task)


def _columns(header: list[Cell], task: Task, faults: Faults) -> Columns:
    """Return the columns of the tokens' properties and record the faults of the first line."""
    names = [str(_NAME.sub(r"\1", cell.text)) for cell in header]
    if not names or names[0].casefold() != TIME:
        came = shown(names[0]) if names else "an empty file"
        faults.add(Mark(), "the first line must name the columns time, token.x, token.y, token.z etc.", came)
        return {}
    wanted = _available(task)
    found: dict[str, int] = {}
    for index, (name, cell) in enumerate(zip(names[1:], header[1:], strict=True), start=1):
        if name not in wanted:
            faults.add(cell.mark, "a column must belong to a token of the task", shown(name), tuple(wanted))
        elif name in found:
            faults.add(cell.mark, "a column must not occur twice", shown(name))
        found[name] = index
    if len(names) == 1:
        faults.add(Mark(), "the table must have a column for a token of the task", "only time", tuple(wanted))
    return _complete(header, found, wanted, faults)


def _available(task: Task) -> dict[str, tuple[str, str]]:
    """Return a mapping from each possible column to its pair of (token, property)."""
    found: dict[str, tuple[str, str]] = {}
    for token in task.assigned:
        for varying in token.varying:
            names = column_names(token.name, varying.name, varying.size)
            found |= dict.fromkeys(names, (token.name, varying.name))
    return found


def _complete(
    header: list[Cell], found: Mapping[str, int], wanted: Mapping[str, tuple[str, str]], faults: Faults
) -> Columns:
    columns: dict[tuple[str, str], list[int]] = {}
    for name, index in found.items():
        if name not in wanted or wanted[name] in columns:
            continue
        names = [column for column, owner in wanted.items() if owner == wanted[name]]
        missing = [part for part in names if part not in found]
        if missing:
            wanted_together = f"the columns {', '.join(names)} must occur together"
            faults.add(header[index].mark, wanted_together, f"no {', '.join(missing)}")
        columns[wanted[name]] = [found.get(part, 0) for part in names]
    return columns


def _states(table: FloatArray, columns: Columns, task: Task) -> tuple[FloatArray, State, State]:
    given = table[:, 0] - table[0, 0]
    times = np.arange(int(np.floor(given[-1] / CONTROL_PERIOD)) + 1, dtype=np.float64) * CONTROL_PERIOD
    changes: dict[tuple[str, str], FloatArray] = {}
    noise: dict[tuple[str, str], FloatArray] = {}
    for (token, name), places in columns.items():
        column = _steady(table[:, places]) if name == "orientation" else table[:, places]
        values = np.stack([np.interp(times, given, part) for part in column.T], axis=-1)
        if name == "orientation":
            values /= np.linalg.norm(values, axis=-1, keepdims=True)
        changes[token, name] = values
        if name in _RATE_OF:
            noise[token, name] = np.full(values.shape[-1], _deviation(column))
            # The noise of the rotation angle is twice the noise of the quaternion, which contains half the angle.
            way, deviation = (_turned(values), 2.0) if name == "orientation" else (values, 1.0)
            deviation *= noise[token, name][0]
            span = float(np.clip(_SPAN_PER_DEVIATION * deviation, *_SPANS))
            changes[token, _RATE_OF[name]] = _rates(way, span)
            samples = max(2.0, span * (len(given) - 1) / given[-1])
            noise[token, _RATE_OF[name]] = np.full(3, deviation * np.sqrt(12.0 / samples) / span)
    blank = State(task.state.layout, np.zeros_like(task.state.values))
    return times, task.state.repeated(len(times)).replace(changes), blank.replace(noise)


def _turned(quaternions: FloatArray) -> FloatArray:
    """Return the accumulated rotation vectors ``(t, 3)`` [rad] of a sequence of orientations ``(t, 4)``."""
    turns = rotation_vector(quaternion_multiply(quaternions[1:], quaternion_conjugate(quaternions[:-1])))
    return np.concatenate([np.zeros((1, 3)), np.cumsum(turns, axis=0)])


def _steady(quaternions: FloatArray) -> FloatArray:
    """Return quaternions ``(t, 4)`` with signs chosen so that each quaternion is close to its predecessor."""
    flips = np.where(np.sum(quaternions[1:] * quaternions[:-1], axis=-1) < 0, -1.0, 1.0)
    return np.asarray(quaternions * np.concatenate([[1.0], np.cumprod(flips)])[:, None])


def _deviation(values: FloatArray) -> float:
    """Estimate the standard deviation of the noise in values ``(t, c)`` from their second differences."""
    bends = np.abs(values[2:] - 2.0 * values[1:-1] + values[:-2])
    return float(np.median(bends) / (0.6745 * np.sqrt(6.0)))


def _rates(values: FloatArray, span: float) -> FloatArray:
    """Estimate the rates of change [1/s] of values ``(t, c)`` over a span [s] before or after each instant."""
    count = max(2, min(round(span / CONTROL_PERIOD), len(values) - 1))
    offsets = np.arange(count + 1) - count / 2.0
    kernel = (offsets / (offsets @ offsets) / CONTROL_PERIOD)[::-1]
    slopes = np.stack([np.convolve(part, kernel, mode="valid") for part in values.T], axis=-1)
    rows = np.arange(len(values))
    before, after = slopes[np.maximum(rows - count, 0)], slopes[np.minimum(rows, len(slopes) - 1)]
    # The slower rate is used, because the mean of both rates would miss a short rest between two movements.
    slower = np.linalg.norm(before, axis=-1) < np.linalg.norm(after, axis=-1)
    return np.asarray(np.where(slower[:, None], before, after))
