"""Trees of processes: how much memory they use, and how to end all of them.

Engines start processes of their own, some in new sessions, some as orphans. So three things identify the members of a
tree: their descent, the record of earlier members, and a mark in the environment, which children inherit.
"""

import ctypes
import os
import sys
import time
from collections.abc import Iterable, Iterator
from pathlib import Path

import psutil

from hybrid_tamp.symbolic.engines.registry import with_java

MARK = "HYBRID_TAMP_PLANNER"
"""The environment variable that marks the processes of one planner."""

_MIB = 2**20
_SET_CHILD_SUBREAPER = 36  # PR_SET_CHILD_SUBREAPER in <linux/prctl.h>
_PATIENCE = 5.0  # Time for killed processes to vanish [s].
_PAUSE = 0.002  # Time between two checks [s].


def make_environment(mark: str, temporary: Path) -> dict[str, str]:
    """Return the environment of the process of a planner.

    The process finds the same modules as this one. It gives equal answers to equal requests, because the hashes of
    strings are fixed. Its temporary files are in its own directory, which Java needs as an option.
    """
    java = f"-Djava.io.tmpdir={temporary} -XX:-UsePerfData"
    return {
        **with_java(os.environ),
        **dict.fromkeys(("TMPDIR", "TEMP", "TMP"), str(temporary)),
        "JAVA_TOOL_OPTIONS": f"{os.environ.get('JAVA_TOOL_OPTIONS', '')} {java}".strip(),
        "PYTHONHASHSEED": "0",
        "PYTHONPATH": os.pathsep.join(map(os.path.abspath, sys.path)),
        MARK: mark,
    }


class ProcessTree:
    """A process and its descendants, as its parent sees them."""

    def __init__(self, root: int, mark: str) -> None:
        """Watch the tree of a process.

        Args:
            root: the process.
            mark: the value of `MARK` in its environment.
        """
        self._root = psutil.Process(root)
        self._mark = mark
        self._seen = {self._root}

    def memory(self) -> float:
        """Update the tree and return its memory [MiB]. Each process counts the pages that it shares."""
        self._seen = _alive({*self._seen, *_descendants(self._root)})
        return sum(map(_resident, self._seen)) / _MIB

    def exact_memory(self) -> float:
        """Return the memory of the processes of the last update [MiB]. Each shared page counts once.

        This takes longer than `memory`. The result is the same if the system does not account for shared pages.
        """
        return sum(map(_proportional, self._seen)) / _MIB

    def kill(self, *, search: bool) -> None:
        """Kill every process of the tree and wait until they are gone.

        Args:
            search: whether to look for the mark in all processes of the machine. There is no other way to find
                processes that left the tree between two updates.

        Raises:
            TimeoutError: if a process does not end, e.g. because it hangs in the kernel.
        """
        deadline = time.monotonic() + _PATIENCE
        while self._members(search):
            if time.monotonic() > deadline:
                raise TimeoutError(f"cannot end the planner's processes {[each.pid for each in self._seen]}")
            _kill(self._seen)
            time.sleep(_PAUSE)

    def _members(self, search: bool) -> set[psutil.Process]:
        """Update the tree with the descendants of all members and return its processes."""
        found = {child for process in self._seen for child in _descendants(process)}
        self._seen = _alive({*self._seen, *found, *(self._marked() if search else ())})
        return self._seen

    def _marked(self) -> Iterator[psutil.Process]:
        for process in psutil.process_iter():
            try:
                if process.environ().get(MARK) == self._mark:
                    yield process
            except (psutil.Error, OSError):
                # The process has ended, or it belongs to another user and so not to this tree.
                continue


def adopt_orphans() -> None:
    """Make this process the parent of descendants that lose theirs, if the system supports it."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_SET_CHILD_SUBREAPER, 1, 0, 0, 0)


def kill_descendants() -> None:
    """Kill all descendants of this process and leave no zombie.

    The function returns when none is left, or after 5 s. The parent of this process kills the rest.
    """
    deadline = time.monotonic() + _PATIENCE
    while time.monotonic() < deadline:
        descendants = _descendants(psutil.Process())
        if not descendants:
            return
        _kill(descendants)
        _reap()
        time.sleep(_PAUSE)


def _reap() -> None:
    """Reap every child that has ended."""
    try:
        while os.waitpid(-1, os.WNOHANG) != (0, 0):
            pass
    except ChildProcessError:
        # No child is left.
        return


def _descendants(process: psutil.Process) -> list[psutil.Process]:
    try:
        return process.children(recursive=True)
    except psutil.NoSuchProcess:
        return []


def _alive(processes: Iterable[psutil.Process]) -> set[psutil.Process]:
    """Return the processes that have not ended; a zombie has ended."""
    return {process for process in processes if process.is_running() and _status(process) != psutil.STATUS_ZOMBIE}


def _status(process: psutil.Process) -> str:
    try:
        return process.status()
    except psutil.NoSuchProcess:
        return psutil.STATUS_ZOMBIE


def _kill(processes: Iterable[psutil.Process]) -> None:
    for process in processes:
        try:
            process.kill()
        except psutil.Error:
            # It has ended, or killing it is not allowed; then the wait for its end times out.
            continue


def _resident(process: psutil.Process) -> int:
    """Return the resident memory of a process [byte]."""
    try:
        return process.memory_info().rss
    except psutil.NoSuchProcess:
        return 0


def _proportional(process: psutil.Process) -> int:
    """Return the resident memory of a process [byte]; shared pages are divided by the number of their users."""
    try:
        return getattr(process.memory_full_info(), "pss", None) or _resident(process)
    except psutil.NoSuchProcess:
        return 0
    except psutil.AccessDenied:
        return _resident(process)
