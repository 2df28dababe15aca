"""Storage of recordings as npz archives. An archive contains three arrays and a JSON document, but no pickled object.

`load_recording` accepts files from untrusted sources. The function checks every statement in a file, such as the shape
of an array, against the data, and raises an `InputError` that names the fault.
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

import numpy as np
from pydantic import ValidationError

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.execution.recording_document import RecordingDocument, find_fault
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.motion.arrays import FloatArray

MAXIMAL_SIZE = 512 * 2**20
"""Largest size of an uncompressed array that `load_recording` reads [bytes], enough for days of simulated time."""

_MEMBERS = {"times": (1, "<f8"), "states": (2, "<f8"), "commands": (2, "<f8"), "document": (1, "|u1")}
# Header that numpy writes before an array. numpy evaluates such a header as Python code when it reads an array, which
# can raise any error of Python's tokenizer and parser. This pattern matches every header that `save` writes.
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
    RuntimeError,  # raised for encrypted files and, as NotImplementedError, for unknown compression methods
    ValueError,
    lzma.LZMAError,
    struct.error,
)


def save(recording: Recording, path: Path) -> None:
    """Write a recording to a file. The file has a temporary name until the recording is complete.

    Raises:
        OSError: the file cannot be written.
    """
    document = RecordingDocument.of(recording)
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


def load_recording(path: Path | str) -> Recording:
    """Read a recording from a file.

    Raises:
        InputError: the file does not exist, or does not contain a complete and consistent recording.
    """
    path = Path(path)
    if not path.exists():
        remedy = f"record a run with 'hybrid-tamp run TASK -o {path.parent}'"
        raise InputError([Issue(str(path), "there is no recording of a run", remedy=remedy)])
    try:
        arrays = _read_arrays(path)
        document = RecordingDocument.model_validate_json(arrays["document"].tobytes())
        recording = document.read(arrays)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"])) or "the document"
        raise _refuse(path, f"invalid JSON document at {place}: {first['msg']}") from error
    except _UNREADABLE as error:
        raise _refuse(path, str(error) or type(error).__name__) from error
    fault = find_fault(recording)
    if fault:
        raise _refuse(path, fault)
    return recording


def _refuse(path: Path, what: str) -> InputError:
    return InputError([Issue(str(path), f"not a recording of a run: {what}", remedy="run the task again")])


def _read_arrays(path: Path) -> Mapping[str, FloatArray]:
    with zipfile.ZipFile(path) as archive:
        names = set(archive.namelist())
        wanted = {f"{name}.npy" for name in _MEMBERS}
        if names != wanted:
            missing, strange = sorted(wanted - names), sorted(names - wanted)
            raise ValueError(f"members missing: {missing}" if missing else f"unexpected members: {strange}")
        return {name: _read_array(archive, name) for name in _MEMBERS}


def _read_array(archive: zipfile.ZipFile, name: str) -> FloatArray:
    dimensions, dtype = _MEMBERS[name]
    member = f"{name}.npy"
    claimed = archive.getinfo(member).file_size
    if claimed > MAXIMAL_SIZE:
        raise ValueError(f"{name} must not exceed {MAXIMAL_SIZE} bytes, got {claimed}")
    with archive.open(member) as stream:
        data = stream.read(MAXIMAL_SIZE)
    header = _HEADER.match(data)
    if header is None:
        raise ValueError(f"{name} must begin with the header of a numpy array")
    found, fortran, sizes = (group.decode("latin-1") for group in header.groups())
    if found != dtype or fortran == "True":
        order = "Fortran" if fortran == "True" else "C"
        raise ValueError(f"{name} must have type {np.dtype(dtype)} in C order, got type {found} in {order} order")
    shape = tuple(int(size) for size in sizes.replace(" ", "").split(",") if size)
    size = len(data) - header.end()
    if len(shape) != dimensions or math.prod(shape) * np.dtype(dtype).itemsize != size:
        raise ValueError(f"{name} must have {dimensions} dimensions and {size} bytes of data, got shape {shape}")
    return np.frombuffer(data, dtype=dtype, offset=header.end()).reshape(shape)
