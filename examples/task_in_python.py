"""Example of a task that is built in Python, saved as a task file and planned.

Run the example with ``python examples/task_in_python.py``. It writes ``two_drums.yaml``.
"""

import math
import sys
from pathlib import Path
from typing import Any

import hybrid_tamp
from hybrid_tamp.authoring import Cylinder


def make_task() -> hybrid_tamp.Task:
    """Return a task in which one hand rolls two drums into two regions."""
    hand: dict[str, Any] = {
        "classes": ["STATIC END-EFFECTOR"],
        "properties": {
            "radius": 0.035,
            "length": 0.16,
            "mass": 1.5,
            "maximal_force": 300,
            "workspace_lower": [-0.8, -0.8, 0.0],
            "workspace_upper": [1.4, 0.8, 1.2],
        },
        "pose": {"position": [0.25, -0.45, 0.30]},
    }
    tokens = {"hand": hand}
    for number, y in enumerate((-0.3, 0.3), start=1):
        tokens[f"drum {number}"] = {
            "classes": ["ROLLABLE"],
            "properties": {"axis_of_rotation": [0, 0, 1], "radius_of_rotation": 0.10, "mass": 5, "friction": 0.6},
            "shape": Cylinder(kind="cylinder", radius=0.10, length=0.30),
            "pose": {"position": [0, y, 0.10], "rpy": [math.pi / 2, 0, 0]},
        }
        tokens[f"region {number}"] = {
            "classes": ["REGION"],
            "properties": {"radius": 0.02},
            "pose": {"position": [0.7, y, 0]},
        }
    return hybrid_tamp.make_task(
        "rolling_tumbling",
        tokens,
        goal=[{"inside": ["drum 1", "region 1"]}, {"inside": ["drum 2", "region 2"]}],
        agents={"robot": ["hand"]},
        name="two_drums",
    )


def main(folder: Path) -> hybrid_tamp.TaskPlan:
    """Save the task as a file, plan this file, and print and return the plan."""
    path = folder / "two_drums.yaml"
    hybrid_tamp.save_task(make_task(), path)
    plan = hybrid_tamp.plan(path).required()
    print(plan)
    return plan


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
