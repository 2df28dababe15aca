"""Call a function in several processes."""

import os
from collections.abc import Callable, Sequence
from typing import TypeVar

_Item = TypeVar("_Item")
_Result = TypeVar("_Result")


def map_in_processes(function: Callable[[_Item], _Result], items: Sequence[_Item], processes: int) -> list[_Result]:
    """Return the results of a function for some items, in their order.

    A single item or a single process is handled in this process.

    Args:
        function: the function; it is pickled, and so are the items and the results.
        items: its arguments.
        processes: largest number of processes at once.
    """
    count = min(processes, len(items))
    if count <= 1:
        return [function(item) for item in items]
    # joblib is slow to import and used only here.
    from joblib import Parallel, delayed

    found: list[_Result] = Parallel(n_jobs=count, backend="loky")(delayed(function)(item) for item in items)
    return found


def count_processors() -> int:
    """Return the number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
