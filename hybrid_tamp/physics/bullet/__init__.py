"""The PyBullet backend and the software renderer. No other package imports PyBullet."""

import ctypes
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib import import_module


@contextmanager
def _silence() -> Iterator[None]:
    """Redirect the standard output and error of the process to the null device.

    PyBullet prints its build time when Python imports the package. This line would corrupt the output of ``--json``.
    C code prints the line, so redirecting `sys.stdout` has no effect. The flush empties C's own buffers.
    """
    saved = {}
    for descriptor in (1, 2):
        with suppress(OSError):  # the stream may be closed
            saved[descriptor] = os.dup(descriptor)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        for descriptor in saved:
            os.dup2(nowhere, descriptor)
        yield
    finally:
        if os.name == "posix":
            ctypes.CDLL(None).fflush(None)
        for descriptor, copy in saved.items():
            os.dup2(copy, descriptor)
            os.close(copy)
        os.close(nowhere)


# This import must come before any other import of PyBullet, because only this import is silent.
with _silence():
    import_module("pybullet")
