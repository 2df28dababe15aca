"""The PyBullet backend and its software renderer: the only package that imports PyBullet."""

import ctypes
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib import import_module


@contextmanager
def _silence() -> Iterator[None]:
    """Redirect the process's standard streams to the null device.

    On import PyBullet prints its build time from C, past `sys.stdout`, to standard output or error depending on the
    build, but standard output belongs to ``--json``. The flush discards what C still buffers.
    """
    saved = {}
    for descriptor in (1, 2):
        with suppress(OSError):  # the process may have no such stream
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


# Before any module of this package imports it.
with _silence():
    import_module("pybullet")
