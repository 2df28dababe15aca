"""Trees of processes: their memory, and their end, of which nothing is left.

Engines start processes of their own, some in new sessions, some as orphans. A tree is therefore known by
descent, by memory of what was seen in it, and by a mark in the environment, which children inherit.
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
_PATIENCE = 5.0  # For killed processes to vanish [s].
_PAUSE = 0.002  # Between two looks at them [s].


def make_environment(mark: str, temporary: Path) -> dict[str, str]:
    """Return the environment of a planner's process.

    It finds the modules that this process finds. It gives equal answers to equal requests, which sets of
    strings do not do otherwise. Its temporary files land in its own directory; Java has to be told extra.
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
        """Look at the tree and return how much memory it takes [MiB], shared pages counted at each process."""
        self._seen = _alive({*self._seen, *_descendants(self._root)})
        return sum(map(_resident, self._seen)) / _MIB

    def exact_memory(self) -> float:
        """Return the memory of the processes last seen [MiB], each shared page counted once.

        It takes longer than `memory`, and equals it where the system does not account for shared pages.
        """
        return sum(map(_proportional, self._seen)) / _MIB

    def kill(self, *, search: bool) -> None:
        """Kill every process of the tree and wait until they are gone.

        Args:
            search: look for the mark at all processes of the machine, too. What left the tree before it
                was first seen can be found in no other way.

        Raises:
            TimeoutError: if a process does not go, e.g. because it hangs in the kernel.
        """
        deadline = time.monotonic() + _PATIENCE
        while self._members(search):
            if time.monotonic() > deadline:
                raise TimeoutError(f"cannot end the planner's processes {[each.pid for each in self._seen]}")
            _kill(self._seen)
            time.sleep(_PAUSE)

    def _members(self, search: bool) -> set[psutil.Process]:
        """Look at the tree thoroughly and return its processes."""
        found = {child for process in self._seen for child in _descendants(process)}
        self._seen = _alive({*self._seen, *found, *(self._marked() if search else ())})
        return self._seen

    def _marked(self) -> Iterator[psutil.Process]:
        for process in psutil.process_iter():
            try:
                if process.environ().get(MARK) == self._mark:
                    yield process
            except (psutil.Error, OSError):
                # It has gone meanwhile, or it is another user's and so none of ours.
                continue


def adopt_orphans() -> None:
    """Make descendants that lose their parent children of this process, where the system can do that."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_SET_CHILD_SUBREAPER, 1, 0, 0, 0)


def kill_descendants() -> None:
    """Kill all processes that descend from this one, and leave no zombie.

    It ends when none is left, or else after some time: whoever waits for this process sees to the rest.
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
    """Take note of the end of every child that has ended."""
    try:
        while os.waitpid(-1, os.WNOHANG) != (0, 0):
            pass
    except ChildProcessError:
        # There is none left.
        return


def _descendants(process: psutil.Process) -> list[psutil.Process]:
    try:
        return process.children(recursive=True)
    except psutil.NoSuchProcess:
        return []


def _alive(processes: Iterable[psutil.Process]) -> set[psutil.Process]:
    """Return the processes that have not ended; a zombie has."""
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
            # It ended by itself, or it may not be ended, which the wait for its end will show.
            continue


def _resident(process: psutil.Process) -> int:
    """Return the pages of a process in memory [byte]."""
    try:
        return process.memory_info().rss
    except psutil.NoSuchProcess:
        return 0


def _proportional(process: psutil.Process) -> int:
    """Return the pages of a process in memory, shared ones divided by the number of their users [byte]."""
    try:
        return getattr(process.memory_full_info(), "pss", None) or _resident(process)
    except psutil.NoSuchProcess:
        return 0
    except psutil.AccessDenied:
        return _resident(process)
