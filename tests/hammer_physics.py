"""Fig. 6 in PyBullet: what comes of grasps all along the handle.

Push then strike is run for every location; its push, which comes first, is what a push alone would be, to the bit. A
strike alone is run at one location: where the block lies does not matter to it.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from hammer_figures import GRASP, LOCATIONS, figure_plan, figure_task

from hybrid_tamp.midlevel.rollout import GOAL, Rollout
from hybrid_tamp.rehearsal import Rehearsal

STRIKE_AT = 0.5
"""Where a strike alone is run [m]."""
MOVING_AT, RADIUS = 0.4, 0.2
"""Where the strike with a moving hand is run, and how far the hand is from the elbow [m]."""
_LAST = "STRIKING-1"
_BEFORE_STRIKE = ("REACHING-1", "GRASPING-1", "CARRYING-1", "PUSHING-1")


def _part_violation(rollout: Rollout, names: tuple[str, ...]) -> list[float]:
    """Return the violation of some instances' conditions; infinite where one of them failed or never ended."""
    total = np.zeros(len(rollout.value))
    for condition in rollout.conditions:
        if condition.where in names and condition.where != GOAL:
            total = total + condition.violation
    for name, where in rollout.failed.items():
        if name in names:
            total = np.where(where, np.inf, total)
    return [float(each) if np.isfinite(each) else float("inf") for each in total]


def scan(kind: str, x: float, grasps: int, processes: int, radius: float = 0.0) -> dict[str, Any]:
    """Run grasps all along the handle, until the strike has ended; return their figures."""
    task = figure_task(kind, x, radius=radius)
    hammer = task.token_by_name["hammer"]
    places = np.linspace(0.0, hammer["handle_to"][0] - hammer["handle_from"][0], grasps)
    rollout = Rehearsal(task, figure_plan(kind), processes=processes)({GRASP: places}, grasps, until=_LAST)
    return {
        "grasps": places.tolist(),
        "violation": _part_violation(rollout, tuple(i.name for i in figure_plan(kind).instances)),
        "push_violation": _part_violation(rollout, _BEFORE_STRIKE),
        "figures": {"/".join(key): figure.tolist() for key, figure in rollout.figures.items()},
    }


def campaign(grasps: int, processes: int) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield everything that the figure needs from PyBullet."""
    yield "moving", scan("both", MOVING_AT, grasps, processes, RADIUS)
    yield "strike", scan("strike", STRIKE_AT, grasps, processes)
    for x in LOCATIONS:
        yield f"both {x}", scan("both", x, grasps, processes)


def keep(path: Path, name: str, data: dict[str, Any]) -> None:
    """Add a scan to a file, a line each."""
    import json

    with path.open("a", encoding="utf-8") as file:
        file.write(json.dumps({"name": name, **data}) + "\n")
