"""Fig. 6 in PyBullet: the results of grasps along the whole handle.

A push followed by a strike is run for every location. The results of a push alone are taken from this run, because both
pushes are bit-identical. A strike alone is run at one location, because its result does not depend on the location.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from hammer_figures import GRASP, LOCATIONS, Scan, figure_plan, figure_task

from hybrid_tamp.midlevel.predictions import Rollout
from hybrid_tamp.midlevel.scores import Scores
from hybrid_tamp.model.refined import GOAL
from hybrid_tamp.planning.physics_rollouts import PhysicsRollouts

STRIKE_AT = 0.5
"""Location of the block for a strike alone [m]."""
MOVING_AT, RADIUS = 0.4, 0.2
"""Location of the block for a strike with a moving hand, and distance of the hand from the elbow [m]."""
EQUAL = 1e-3
"""Largest difference of values that count as equal, because even a push of length zero has a small torque."""
Near = tuple[Sequence[float], float]
"""Places on the handle, as distances from the head [m], and the largest distance of a grasp from these places [m]."""
_LAST = "STRIKING-1"
_BEFORE_STRIKE = ("REACHING-1", "GRASPING-1", "CARRYING-1", "PUSHING-1")


def _part_violation(rollout: Rollout, names: tuple[str, ...]) -> list[float]:
    """Return the violation of the conditions of some instances. It is infinite if an instance failed or did not end."""
    total = np.zeros(len(rollout.value))
    for condition in rollout.conditions:
        if condition.where in names and condition.where != GOAL:
            total = total + condition.violation
    for name, where in rollout.failed.items():
        if name in names:
            total = np.where(where, np.inf, total)
    return [float(each) if np.isfinite(each) else float("inf") for each in total]


def scan(
    kind: str, x: float, grasps: int, processes: int, radius: float = 0.0, near: Near | None = None
) -> dict[str, Any]:
    """Run a plan with grasps along the handle until the strike has ended, and return the results.

    Args:
        kind: ``strike`` or ``both``.
        x: final location of the block [m].
        grasps: number of equidistant grasps along the whole handle.
        processes: number of processes.
        radius: distance of the hand from the elbow about which it swings [m].
        near: places and the largest distance of a grasp from one of these places, or None for all grasps.
    """
    task = figure_task(kind, x, radius=radius)
    hammer = task.token_by_name["hammer"]
    places = np.linspace(0.0, hammer["handle_to"][0] - hammer["handle_from"][0], grasps)
    middle = float(places.mean())
    if near is not None:
        wanted, within = near
        apart = np.abs(places[:, None] - np.asarray(wanted)).min(axis=1)
        places = places[apart <= within + 1e-9]
    rollout = PhysicsRollouts(task, figure_plan(kind), processes=processes)({GRASP: places}, len(places), until=_LAST)
    return {
        "grasps": places.tolist(),
        "middle": middle,
        "violation": _part_violation(rollout, tuple(i.name for i in figure_plan(kind).instances)),
        "push_violation": _part_violation(rollout, _BEFORE_STRIKE),
        "figures": {"/".join(key): figure.tolist() for key, figure in rollout.figures.items()},
    }


def campaign(
    path: Path, grasps: int, processes: int, near: Mapping[str, Sequence[float]], within: float
) -> Iterator[str]:
    """Run the scans that the figure needs and that are not in the file, and yield the name of each scan.

    Args:
        path: file of the scans.
        grasps: number of equidistant grasps along the whole handle.
        processes: number of processes.
        near: maps the name of each scan to the best grasps of the forward models [m].
        within: largest distance of a grasp from a best grasp of the forward models [m].
    """
    known = read(path)
    wanted = [(f"both {x}", "both", x, 0.0) for x in LOCATIONS]
    wanted += [("strike", "strike", STRIKE_AT, 0.0), ("moving", "both", MOVING_AT, RADIUS)]
    for name, kind, x, radius in wanted:
        if name not in known:
            data = scan(kind, x, grasps, processes, radius, (near[name], within))
            with path.open("a", encoding="utf-8") as file:
                file.write(json.dumps({"name": name, **data}) + "\n")
        yield name


def read(path: Path) -> dict[str, Any]:
    """Return a mapping from names to the scans in a file. If the file does not exist, the mapping is empty."""
    if not path.exists():
        return {}
    lines = map(json.loads, path.read_text(encoding="utf-8").splitlines())
    return {line["name"]: line for line in lines}


def measured(data: dict[str, Any], kind: str, weights: Mapping[str, float]) -> Scan:
    """Return the scores of one kind in a scan. A scan of a push and a strike also contains those of a push."""
    counted = {"push": ("contact", "torque_work"), "strike": ("contact", "tip_speed_squared", "hand_speed")}
    names = counted.get(kind, tuple(dict.fromkeys(name for each in counted.values() for name in each)))
    figures = {key.partition("/")[2]: np.array(values, dtype=float) for key, values in data["figures"].items()}
    value = np.sum([weights[name] * figures[name] for name in names], axis=0)
    violation = data["push_violation" if kind == "push" else "violation"]
    return Scan(np.array(data["grasps"]), Scores(np.array(violation, dtype=float), value), EQUAL, data["middle"])
