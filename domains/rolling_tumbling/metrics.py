"""The domain's own measures of a finished run."""

from collections.abc import Mapping

import numpy as np

from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.poses import angle_about


def metrics(task: Task, recording: Recording) -> Mapping[str, float]:
    """Return for each rolling how far the object came, how truly it rolled and how far off it ended.

    ``roll_ratio`` is radius times angle over distance: 1 for rolling without slip. ``final_distance [m]`` is that of
    the object's centre to the region's when the instance ended.
    """
    found: dict[str, float] = {}
    for instance in recording.instances:
        if instance.block != "ROLLING":
            continue
        thing = task.token_by_name[instance.slots["object"]]
        rows = slice(*(round(t / recording.timestep) for t in (instance.start, instance.end)))
        run = recording.trajectory
        path = run[thing, "position"][rows]
        if len(path) < 2:
            continue
        travelled = float(np.linalg.norm(path[-1] - path[0]))
        angle = abs(float(angle_about(np.asarray(thing["axis_of_rotation"]), run[thing, "orientation"][rows])[-1]))
        region = run[instance.targets["region"], "position"][0]
        found[f"{instance.name}.distance [m]"] = travelled
        found[f"{instance.name}.final_distance [m]"] = float(np.linalg.norm((path[-1] - region)[:2]))
        if travelled > 1e-6:
            found[f"{instance.name}.roll_ratio"] = thing["radius_of_rotation"] * angle / travelled
    return found
