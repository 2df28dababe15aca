"""Read the initial poses of the tokens of a task file."""

import math
from typing import Any

import numpy as np

from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import normalized, quaternion_from_rpy
from hybrid_tamp.taskfile.entries import Pose
from hybrid_tamp.taskfile.places import Faults, KeyPath, shown


def read_pose(outline: Token, entry: dict[str, Any], path: KeyPath, faults: Faults) -> dict[str, FloatArray]:
    """Return the varying properties that the pose of a token gives, and record the faults of the pose.

    Args:
        outline: token with its classes. A pose is required if they have a position.
        entry: entry of the token.
        path: path of the entry.
        faults: the faults found so far.

    Returns:
        A mapping with the ``position`` [m], shape ``(3,)``, and the ``orientation``, shape ``(4,)``, if given.
    """
    here = (*path, "pose")
    if not faults.sound(here):
        return {}
    varying = {one.name for one in outline.varying}
    if entry.get("pose") is None:
        if "position" in varying:
            wanted = f"missing key 'pose' in token {shown(outline.name)}: the initial pose"
            faults.at(here, wanted, remedy="write pose: {position: [x, y, z]}")
        return {}
    pose = Pose.model_validate(entry["pose"])
    values = {"position": np.asarray(pose.position, dtype=float), "orientation": _orientation(pose)}
    given = {key: value for key, value in values.items() if value is not None}
    for key in given:
        if key not in varying:
            faults.at(here, f"no class of token {shown(outline.name)} has the property {key}", remedy=f"remove {key}")
    return {key: value for key, value in given.items() if key in varying}


def _orientation(pose: Pose) -> FloatArray | None:
    if pose.quaternion is not None:
        unit = abs(math.hypot(*pose.quaternion) - 1.0) < 1e-15
        return np.array(pose.quaternion) if unit else normalized(pose.quaternion)
    return None if pose.rpy is None else quaternion_from_rpy(pose.rpy)
