"""Process trees. The memory of a tree can be measured, and all its processes can be killed.

Engines start subprocesses. Some of these run in new sessions or become orphans. So a process is a member of a tree if
it is a descendant of the root, was a member before, or has the tree's mark in its environment. Children inherit the
mark.
"""

import ctypes
import os
import sys
import time
from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import Path

import psutil

from hybrid_tamp.symbolic.engines.registry import with_java

MARK = "HYBRID_TAMP_PLANNER"
"""Environment variable that marks the processes of one planner."""

_MIB = 2**20
_SET_CHILD_SUBREAPER = 36  # PR_SET_CHILD_SUBREAPER in <linux/prctl.h>
_PAUSE = 0.002  # Time between two checks [s].
_CHECKS = 2500  # Number of checks, during 5 s, until killed processes must have ended.


def make_environment(mark: str, temporary: Path) -> dict[str, str]:
    """Return the environment variables of a planner process.

    The planner process imports the same modules as this process. String hashes are fixed, so equal requests get equal
    answers. Temporary files go to the given directory, which Java gets as an option.
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
    """A child process and its descendants."""

    def __init__(self, root: int, mark: str) -> None:
        """Start to observe the tree of the process with ID `root`. Its processes have `MARK` set to `mark`."""
        self._root = psutil.Process(root)
        self._mark = mark
        self._seen = {self._root}

    def memory(self) -> float:
        """Update the tree and return its memory [MiB]. A shared page is counted once per process."""
        self._seen = _alive({*self._seen, *_descendants(self._root)})
        return sum(map(_resident, self._seen)) / _MIB

    def exact_memory(self) -> float:
        """Return the memory of the processes that the last update found [MiB]. A shared page is counted once."""
        # This method is slow. If the system does not account for shared pages, the result equals that of `memory`.
        return sum(map(_proportional, self._seen)) / _MIB

    def kill(self, *, search: bool) -> None:
        """Kill every process of the tree and wait until all have ended.

        Args:
            search: Whether to search all processes of the machine for the mark. Only this search finds processes that
                left the tree between two updates.

        Raises:
            TimeoutError: If a process does not end within 5 s, e.g. because it hangs in the kernel.
        """
        for _ in range(_CHECKS):
            if not self._members(search):
                return
            _kill(self._seen)
            time.sleep(_PAUSE)
        raise TimeoutError(f"cannot kill the planner's processes {[each.pid for each in self._seen]}")

    def _members(self, search: bool) -> set[psutil.Process]:
        """Update the tree with the descendants of all members. Return its processes."""
        found = {child for process in self._seen for child in _descendants(process)}
        self._seen = _alive({*self._seen, *found, *(self._marked() if search else ())})
        return self._seen

    def _marked(self) -> Iterator[psutil.Process]:
        for process in psutil.process_iter():
            # A process that has ended or belongs to another user is not part of this tree.
            with suppress(psutil.Error, OSError):
                if process.environ().get(MARK) == self._mark:
                    yield process


def adopt_orphans() -> None:
    """Let this process adopt its orphaned descendants, if the operating system supports this."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_SET_CHILD_SUBREAPER, 1, 0, 0, 0)


def kill_descendants() -> None:
    """Kill all descendants of this process and leave no zombie. Return after at most 5 s."""
    # The parent of this process kills any descendant that is left.
    for _ in range(_CHECKS):
        descendants = _descendants(psutil.Process())
        if not descendants:
            return
        _kill(descendants)
        _reap()
        time.sleep(_PAUSE)


def _reap() -> None:
    """Reap every child that has ended."""
    with suppress(ChildProcessError):  # No child is left.
        while os.waitpid(-1, os.WNOHANG) != (0, 0):
            pass


def _descendants(process: psutil.Process) -> list[psutil.Process]:
    try:
        return process.children(recursive=True)
    except psutil.NoSuchProcess:
        return []


def _alive(processes: Iterable[psutil.Process]) -> set[psutil.Process]:
    """Return the processes that have not ended. Zombies are left out."""
    return {process for process in processes if process.is_running() and _status(process) != psutil.STATUS_ZOMBIE}


def _status(process: psutil.Process) -> str:
    try:
        return process.status()
    except psutil.NoSuchProcess:
        return psutil.STATUS_ZOMBIE


def _kill(processes: Iterable[psutil.Process]) -> None:
    for process in processes:
        # The process may have ended, or this user may not kill it. In the second case, `ProcessTree.kill` times out.
        with suppress(psutil.Error):
            process.kill()


def _resident(process: psutil.Process) -> int:
    """Return the resident memory of a process in bytes."""
    try:
        return process.memory_info().rss
    except psutil.NoSuchProcess:
        return 0


def _proportional(process: psutil.Process) -> int:
    """Return the resident memory of a process in bytes. A page that n processes share counts as 1/n page."""
    try:
        return getattr(process.memory_full_info(), "pss", None) or _resident(process)
    except psutil.NoSuchProcess:
        return 0
    except psutil.AccessDenied:
        return _resident(process)
