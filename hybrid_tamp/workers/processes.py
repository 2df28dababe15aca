"""Call a function in several processes."""

import os
from collections.abc import Callable, Sequence
from typing import TypeVar

_Item = TypeVar("_Item")
_Result = TypeVar("_Result")


def map_in_processes(function: Callable[[_Item], _Result], items: Sequence[_Item], processes: int) -> list[_Result]:
    """Apply a function to items in parallel and return the results in the order of the items.

    If there is only one item or `processes` is 1, the current process does the work.

    Args:
        function: function of one item. The function, the items and the results must be picklable.
        items: the items.
        processes: maximum number of processes.
    """
    count = min(processes, len(items))
    if count <= 1:
        return [function(item) for item in items]
    # Imported here because joblib is slow to import.
    from joblib import Parallel, delayed

    found: list[_Result] = Parallel(n_jobs=count, backend="loky")(delayed(function)(item) for item in items)
    return found


def count_processors() -> int:
    """Return the number of processors available to this process."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
