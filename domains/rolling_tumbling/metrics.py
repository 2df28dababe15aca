"""Metrics of rolling and tumbling in a finished run."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from hybrid_tamp.authoring import BlockInstance, Recording, State, Task, Token, angle_about
from hybrid_tamp.skills import measure_instances, rows_of, run_of

from .faces import edge_between, faces_of
from .tumbling_geometry import edge_axis, edge_position, tilt

_TOUCHDOWN = np.radians(3.0)
"""Largest deviation from the flat posture at which a box counts as touched down [rad]."""
_AROUND = 0.1
"""Time before and after touchdown [s] within which the largest angular speed is measured."""

CONTROLLED: Mapping[str, tuple[float, float]] = {
    "tilt [deg]": (85.0, 95.0),
    "slip [m]": (0.0, 0.05),
    "yaw [deg]": (0.0, 15.0),
    "touchdown [rad/s]": (0.0, 2.0),
}
"""Maps each metric to its bounds in a controlled tumble. The touchdown speed of a box that drops is too large."""


def metrics(task: Task, recording: Recording) -> Mapping[tuple[str, str], float]:
    """Return the metrics of every roll and every tumble. The result maps each pair of (instance, metric) to a value.

    The metrics of a roll are the distance covered, the final distance between the centres of object and region, and
    ``roll_ratio``. This ratio is the radius times the angle, divided by the distance; it is 1 without slip.
    The metrics of a tumble belong to the instance that lowers the box. They are the final tilt, the slip of the pivot
    edge, the yaw of the box and the angular speed at touchdown. Slip and yaw are measured over the whole tumble.
    """
    return measure_instances(task, recording, {"ROLLING": _rolling, "TIPPING:lower": _tumble})


def _rolling(task: Task, recording: Recording, instance: BlockInstance) -> Iterator[tuple[str, float]]:
    thing = task.token_by_name[instance.slots["object"]]
    rows = rows_of(recording, instance.start, instance.end)
    run = recording.trajectory
    path = run[thing, "position"][rows]
    if len(path) < 2:
        return
    travelled = float(np.linalg.norm(path[-1] - path[0]))
    angle = abs(float(angle_about(np.asarray(thing["axis_of_rotation"]), run[thing, "orientation"][rows])[-1]))
    region = run[instance.targets["region"], "position"][0]
    yield "distance [m]", travelled
    yield "final_distance [m]", float(np.linalg.norm((path[-1] - region)[:2]))
    if travelled > 1e-6:
        yield "roll_ratio", thing["radius_of_rotation"] * angle / travelled


def _tumble(task: Task, recording: Recording, instance: BlockInstance) -> Iterator[tuple[str, float]]:
    thing = task.token_by_name[instance.slots["object"]]
    start = _beginning(recording.instances, instance, thing)
    # The box may still move at the end of the instance.
    run = run_of(recording, start, instance.end + _AROUND)
    (onto,) = faces_of(instance.targets["outcome"])
    edge = edge_between(instance.targets["before"], instance.targets["outcome"])
    yield from tumble_measures(run, thing, edge[0] if edge[1] == onto else edge[1], onto, recording.timestep)


def _beginning(instances: Sequence[BlockInstance], last: BlockInstance, thing: Token) -> float:
    """Return the start [s] of the latest instance, not after `last`, in which hands tip the flat box."""
    begins = [
        i.start
        for i in instances
        if i.block == "TIPPING:opposite" and i.slots["object"] == thing.name and i.start <= last.start
    ]
    return max(begins, default=last.start)


def tumble_measures(run: State, thing: Token, down: str, onto: str, timestep: float) -> Iterator[tuple[str, float]]:
    """Yield the tilt, slip, yaw and touchdown speed of a box that hands turned from one face onto another.

    Args:
        run: measured states ``(t, n)``.
        thing: the box.
        down: the face on which the box lay.
        onto: the face on which the box should end.
        timestep: time between two states [s].
    """
    angle = tilt(run, thing, down, onto)
    edge = edge_position(run, thing, down, onto)[:, :2]
    axis = edge_axis(run, thing, down, onto)
    turned = np.arctan2(axis[-1, 1], axis[-1, 0]) - np.arctan2(axis[0, 1], axis[0, 0])
    speed = np.linalg.norm(run[thing, "angular_velocity"], axis=-1)
    arrived = np.flatnonzero(angle > np.pi / 2 - _TOUCHDOWN)
    around = round(_AROUND / timestep)
    yield "tilt [deg]", float(np.degrees(angle[-1]))
    yield "slip [m]", float(np.linalg.norm(edge[-1] - edge[0]))
    yield "yaw [deg]", float(np.degrees(abs((turned + np.pi) % (2 * np.pi) - np.pi)))
    if len(arrived):
        yield "touchdown [rad/s]", float(speed[max(0, arrived[0] - around) : arrived[0] + around].max())
