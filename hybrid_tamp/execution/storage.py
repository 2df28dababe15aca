"""Recordings as files: three arrays and one JSON document in an npz archive, without pickle.

Whatever the bytes are, `load` returns a recording or says what is wrong with the file; a claim of the file, such as
the shape of an array, is compared with what is there before it is believed.
"""

import lzma
import math
import os
import re
import struct
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, PositiveInt, ValidationError

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.plan import TIME_TOLERANCE, BlockInstance
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.recording import AtomMargin, Contact, Failure, Recording
from hybrid_tamp.model.state import StateLayout
from hybrid_tamp.motion.arrays import FloatArray

MAXIMAL_SIZE = 512 * 2**20
"""Largest uncompressed member that is read [bytes]: days of simulated time."""

_MEMBERS = {"times": (1, "<f8"), "states": (2, "<f8"), "commands": (2, "<f8"), "document": (1, "|u1")}
# What numpy writes in front of an array. Its own reader evaluates the header as Python, and thereby raises
# whatever Python's tokenizer and parser raise; the few headers that we write need no more than a pattern.
_HEADER = re.compile(
    rb"\x93NUMPY\x01\x00..\{'descr': '([^']*)', 'fortran_order': (False|True), 'shape': \(([0-9, ]*)\), \} *\n",
    re.DOTALL,
)
_UNREADABLE = (
    zipfile.BadZipFile,
    zlib.error,
    EOFError,
    KeyError,
    OSError,
    OverflowError,
    RuntimeError,  # encrypted, or (NotImplementedError) an unknown compression
    ValueError,
    lzma.LZMAError,
    struct.error,
)

_STRICT = ConfigDict(extra="forbid", strict=True, ser_json_inf_nan="constants")
_Entry = tuple[str, str, PositiveInt]


class _Margin(BaseModel):
    """A margin with its atom as text."""

    model_config = _STRICT

    atom: str = Field(pattern=r"(?s)^[^(]+\(.*\)$")
    measured: float | None
    predicted: float | None = None

    @classmethod
    def of(cls, margin: AtomMargin) -> "_Margin":
        return cls(atom=margin.atom.text, measured=margin.measured, predicted=margin.predicted)

    def read(self) -> AtomMargin:
        predicate, _, rest = self.atom.removeprefix("not ").partition("(")
        arguments = tuple(rest[:-1].split(", ")) if rest != ")" else ()
        atom = Atom(predicate, arguments, positive=not self.atom.startswith("not "))
        return AtomMargin(atom, self.measured, self.predicted)


class _Failure(BaseModel):
    """A failure with its atoms as text."""

    model_config = _STRICT

    step: int
    instance: str
    reason: str
    margins: tuple[_Margin, ...] = ()

    @classmethod
    def of(cls, failure: Failure) -> "_Failure":
        margins = tuple(map(_Margin.of, failure.margins))
        return cls(step=failure.step, instance=failure.instance, reason=failure.reason, margins=margins)

    def read(self) -> Failure:
        return Failure(self.step, self.instance, self.reason, tuple(margin.read() for margin in self.margins))


class _Document(BaseModel):
    """Everything of a recording that is not an array."""

    model_config = _STRICT

    version: Literal["hybrid-tamp/recording/1"]
    layout: tuple[_Entry, ...]
    commands_layout: tuple[_Entry, ...]
    instances: tuple[BlockInstance, ...]
    exits: dict[str, tuple[_Margin, ...]]
    goal: tuple[_Margin, ...]
    backend: str
    timestep: Annotated[FiniteFloat, Field(gt=0)]
    failure: _Failure | None
    warnings: tuple[str, ...]
    contacts: tuple[Contact, ...] = ()


def save(recording: Recording, path: Path) -> None:
    """Write the recording under a temporary name and rename it.

    Raises:
        OSError: the folder cannot be written to.
    """
    document = _Document(
        version="hybrid-tamp/recording/1",
        layout=recording.layout.entries,
        commands_layout=recording.commands_layout,
        instances=recording.instances,
        exits={instance: tuple(map(_Margin.of, margins)) for instance, margins in recording.exits.items()},
        goal=tuple(map(_Margin.of, recording.goal)),
        backend=recording.backend,
        timestep=recording.timestep,
        failure=None if recording.failure is None else _Failure.of(recording.failure),
        warnings=recording.warnings,
        contacts=recording.contacts,
    )
    arrays = {
        "times": np.ascontiguousarray(recording.times, dtype="<f8"),
        "states": np.ascontiguousarray(recording.states, dtype="<f8"),
        "commands": np.ascontiguousarray(recording.commands, dtype="<f8"),
        "document": np.frombuffer(document.model_dump_json().encode(), dtype=np.uint8),
    }
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        with temporary.open("wb") as file:
            np.savez_compressed(file, allow_pickle=False, **arrays)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def load(path: Path) -> Recording:
    """Read a recording.

    Raises:
        InputError: the file is not there, or is not a whole and consistent recording; names the file and the fault.
    """
    try:
        arrays = _arrays(path)
        document = _Document.model_validate_json(arrays["document"].tobytes())
        recording = _recording(document, arrays)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"])) or "the document"
        raise _refused(path, f"its document is wrong at {place}: {first['msg']}") from error
    except _UNREADABLE as error:
        raise _refused(path, str(error) or type(error).__name__) from error
    fault = _fault(recording)
    if fault:
        raise _refused(path, fault)
    return recording


def _refused(path: Path, what: str) -> InputError:
    return InputError([Issue(str(path), "a recording of a run", what, remedy="run the task again")])


def _arrays(path: Path) -> Mapping[str, FloatArray]:
    with zipfile.ZipFile(path) as archive:
        names = set(archive.namelist())
        wanted = {f"{name}.npy" for name in _MEMBERS}
        if names != wanted:
            missing, strange = sorted(wanted - names), sorted(names - wanted)
            raise ValueError(f"it lacks {missing}" if missing else f"it holds {strange}, which it should not")
        return {name: _array(archive, name) for name in _MEMBERS}


def _array(archive: zipfile.ZipFile, name: str) -> FloatArray:
    dimensions, dtype = _MEMBERS[name]
    member = f"{name}.npy"
    claimed = archive.getinfo(member).file_size
    if claimed > MAXIMAL_SIZE:
        raise ValueError(f"its {name} claim {claimed} bytes, more than the {MAXIMAL_SIZE} that are read")
    with archive.open(member) as stream:
        data = stream.read(MAXIMAL_SIZE)
    header = _HEADER.match(data)
    if header is None:
        raise ValueError(f"its {name} do not begin like an array")
    found, fortran, sizes = (group.decode("latin-1") for group in header.groups())
    if found != dtype or fortran == "True":
        raise ValueError(f"its {name} should be of type {np.dtype(dtype)}, in C order, got {found}")
    shape = tuple(int(size) for size in sizes.replace(" ", "").split(",") if size)
    size = len(data) - header.end()
    if len(shape) != dimensions or math.prod(shape) * np.dtype(dtype).itemsize != size:
        raise ValueError(f"its {name} claim the shape {shape}, which {size} bytes do not fill")
    return np.frombuffer(data, dtype=dtype, offset=header.end()).reshape(shape)


def _recording(document: _Document, arrays: Mapping[str, FloatArray]) -> Recording:
    return Recording(
        layout=StateLayout(document.layout),
        commands_layout=document.commands_layout,
        times=arrays["times"],
        states=arrays["states"],
        commands=arrays["commands"],
        instances=document.instances,
        exits={instance: tuple(each.read() for each in margins) for instance, margins in document.exits.items()},
        goal=tuple(margin.read() for margin in document.goal),
        backend=document.backend,
        timestep=document.timestep,
        failure=None if document.failure is None else document.failure.read(),
        warnings=document.warnings,
        contacts=document.contacts,
    )


def _fault(recording: Recording) -> str:
    """Say what contradicts what; empty if all is well."""
    rows = len(recording.times)
    width = sum(size for _, _, size in recording.commands_layout)
    shapes = {
        "states": (recording.states.shape, (rows, recording.layout.size)),
        "commands": (recording.commands.shape, (rows - 1, width)),
    }
    if rows == 0:
        return "it has no rows"
    for name, (shape, wanted) in shapes.items():
        if shape != wanted:
            return f"its {name} have the shape {shape}, not {wanted}"
    for name in ("times", "states", "commands"):
        if not np.isfinite(getattr(recording, name)).all():
            return f"its {name} are not all finite"
    if not np.allclose(recording.times, np.arange(rows) * recording.timestep, rtol=1e-9, atol=TIME_TOLERANCE):
        return "its times are not multiples of its control period"
    return _instances_fault(recording)


def _instances_fault(recording: Recording) -> str:
    names = [instance.name for instance in recording.instances]
    if len(set(names)) < len(names):
        return "two of its instances have one name"
    if set(recording.exits) - set(names):
        return "it has exit conditions of an instance that did not run"
    for contact in recording.contacts:
        if not (math.isfinite(contact.force) and math.isfinite(contact.time)):
            return f"the contact of {' and '.join(contact.tokens)} has numbers that are not finite"
    for instance in recording.instances:
        numbers = (instance.start, instance.end, *instance.hyperparameters.values())
        if not all(map(math.isfinite, numbers)):
            return f"{instance.name} has times or hyperparameters that are not finite"
        if not -TIME_TOLERANCE <= instance.start <= instance.end <= recording.duration + TIME_TOLERANCE:
            return f"{instance.name} runs from {instance.start} s to {instance.end} s, outside the run"
    failure = () if recording.failure is None else recording.failure.margins
    for margin in (*recording.goal, *failure, *(m for ms in recording.exits.values() for m in ms)):
        if any(value is not None and math.isnan(value) for value in (margin.measured, margin.predicted)):
            return f"the margin of {margin.atom.text} is not a number"
    return ""
