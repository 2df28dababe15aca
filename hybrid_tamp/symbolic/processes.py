"""Trees of processes: their memory, and their end, of which nothing is left.

Engines start processes of their own, some in new sessions, some as orphans. A tree is therefore known by
descent, by memory of whom was seen in it, and by a mark in the environment that children inherit.
"""

import ctypes
import os
import sys
import time
from collections.abc import Iterator

import psutil

MARK = "HYBRID_TAMP_PLANNER"
"""The environment variable that marks the processes of one planner."""

_MIB = 2**20
_SET_CHILD_SUBREAPER = 36  # PR_SET_CHILD_SUBREAPER in <linux/prctl.h>
_PATIENCE = 5.0  # For processes to vanish that were killed [s].
_PAUSE = 0.002  # Between two looks at them [s].


class ProcessTree:
    """The processes that descend from one, as another process sees them."""

    def __init__(self, root: int, mark: str) -> None:
        """Watch the tree under a process.

        Args:
            root: the process, a child of this one.
            mark: the value of `MARK` in the environment of the root.
        """
        self._root = psutil.Process(root)
        self._mark = mark
        self._seen: set[psutil.Process] = {self._root}

    def memory(self) -> float:
        """Look at the tree and return the memory that it takes [MiB], pages that are shared counted at each."""
        self._look()
        return sum(map(_resident, self._seen)) / _MIB

    def exact_memory(self) -> float:
        """Return the memory of the processes last seen [MiB], pages that are shared counted in parts.

        It takes longer than `memory`. Where the system does not count shared pages in parts, both agree.
        """
        return sum(map(_proportional, self._seen)) / _MIB

    def kill(self, *, search: bool) -> None:
        """Kill every process of the tree and wait until they are gone.

        Args:
            search: look at all processes of the machine for the mark, too. Whoever left the tree before
                it was first seen is found in no other way.

        Raises:
            TimeoutError: if a process does not go, e.g. because it hangs in the kernel.
        """
        deadline = time.monotonic() + _PATIENCE
        while True:
            self._look()
            if search:
                self._seen.update(self._marked())
            if not self._seen:
                return
            if time.monotonic() > deadline:
                raise TimeoutError(f"could not end the planner's processes {[each.pid for each in self._seen]}")
            _kill(self._seen)
            time.sleep(_PAUSE)

    def _look(self) -> None:
        """Take in new descendants, also those of orphans, and forget who is gone."""
        orphans = [process for process in self._seen if _is_orphan(process, self._seen)]
        for process in {self._root, *orphans}:
            self._seen.update(_descendants(process))
        self._seen = {process for process in self._seen if _is_alive(process)}

    def _marked(self) -> Iterator[psutil.Process]:
        for process in psutil.process_iter():
            try:
                if process.environ().get(MARK) == self._mark and _is_alive(process):
                    yield process
            except (psutil.Error, OSError):
                # Gone meanwhile, or of another user and so none of ours.
                continue
