"""Small random tasks of every bundled domain, to compare the planner's proofs with an exhaustive search.

Each domain has tasks that need one movement, and tasks without a plan. Rolling, tumbling and tool use have tasks in
which one object must be moved twice. Such tasks are 110 of 300 consecutive seeds, counted from a multiple of 10.
"""

from collections.abc import Callable

import numpy as np

from hybrid_tamp.model.task import Task
from random_tasks import small_lifting, small_rolling, small_tools, small_tumbling

Maker = Callable[[int, str, np.random.Generator], Task]
_ROLLING = (small_rolling.small_rolling, small_rolling.KINDS)
_TUMBLING = (small_tumbling.small_tumbling, small_tumbling.KINDS)
_TOOLS = (small_tools.small_tools, small_tools.KINDS)
_LIFTING = (small_lifting.small_lifting, small_lifting.KINDS)
_TURNS: tuple[tuple[Maker, tuple[str, ...]], ...] = (
    _ROLLING,
    _TUMBLING,
    _TOOLS,
    _LIFTING,
    _TUMBLING,
    _TOOLS,
    _ROLLING,
    _TUMBLING,
    _TOOLS,
    _LIFTING,
)
"""Pairs of (function that makes tasks, kinds of tasks) for ten consecutive seeds. Kinds take turns."""


def small_task(seed: int) -> Task:
    """Return the small random task of a seed. The name of the task contains its kind."""
    tens, ones = divmod(seed, len(_TURNS))
    maker, kinds = _TURNS[ones]
    number = tens * _TURNS.count(_TURNS[ones]) + _TURNS[:ones].count(_TURNS[ones])
    return maker(seed, kinds[number % len(kinds)], np.random.default_rng(seed))
