"""The domain's own measures of a finished run."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from hybrid_tamp.authoring import BlockInstance, Recording, State, Task, Token, angle_about

from .faces import edge_between, faces_of
from .tumbling_geometry import edge_axis, edge_position, tilt

_LOWERING = "TIPPING:lower"
_TOUCHDOWN = np.radians(3.0)
"""Touchdown is when a box first comes this close to lying flat [rad]."""
_AROUND = 0.1
"""How long before and after touchdown its angular speed is looked at [s]."""

CONTROLLED: Mapping[str, tuple[float, float]] = {
    "tilt [deg]": (85.0, 95.0),
    "slip [m]": (0.0, 0.05),
    "yaw [deg]": (0.0, 15.0),
    "touchdown [rad/s]": (0.0, 2.0),
}
"""Bounds of a controlled tumble. Pushed over by one hand, a box also ends on its next face, but it drops there."""


def metrics(task: Task, recording: Recording) -> Mapping[tuple[str, str], float]:
    """Return the measures of every rolling and of every tumble, each by the name of its instance and its own.

    Rolling: how far the object came, how truly it rolled (``roll_ratio``, radius times angle over distance, is 1
    without slip) and how far its centre was from the region's when the instance ended.
    Tumbling, of the instance that brought the box down: the tilt reached, how far the pivot edge moved and how far the
    box turned about the vertical since the tumble began, and the angular speed at touchdown.
    """
    found: dict[tuple[str, str], float] = {}
    for instance in recording.instances:
        if instance.block == "ROLLING":
            measures = _rolling(task, recording, instance)
        elif instance.block == _LOWERING:
            measures = _tumble(task, recording, instance)
        else:
            continue
        found |= {(instance.name, name): value for name, value in measures}
    return found


def _rows(recording: Recording, start: float, end: float) -> slice:
    return slice(*(round(time / recording.timestep) for time in (start, end)))


def _rolling(task: Task, recording: Recording, instance: BlockInstance) -> Iterator[tuple[str, float]]:
    thing = task.token_by_name[instance.slots["object"]]
    rows = _rows(recording, instance.start, instance.end)
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
    # The box goes on coming down, or to rest, after its hands have let go.
    run = State(recording.layout, recording.states[_rows(recording, start, instance.end + _AROUND)])
    (onto,) = faces_of(instance.targets["outcome"])
    edge = edge_between(instance.targets["before"], instance.targets["outcome"])
    yield from tumble_measures(run, thing, edge[0] if edge[1] == onto else edge[1], onto, recording.timestep)


def _beginning(instances: Sequence[BlockInstance], last: BlockInstance, thing: Token) -> float:
    """Return when the tumble that ends with an instance began: as the box was last tipped from lying flat [s]."""
    begins = [
        i.start
        for i in instances
        if i.block == "TIPPING:opposite" and i.slots["object"] == thing.name and i.start <= last.start
    ]
    return max(begins, default=last.start)


def tumble_measures(run: State, thing: Token, down: str, onto: str, timestep: float) -> Iterator[tuple[str, float]]:
    """Yield tilt, slip, yaw and touchdown speed of a box that turned from one face onto another.

    Args:
        run: measured states ``(t, n)``.
        thing: the box.
        down: the face on which it lay.
        onto: the face on which it was to come down.
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
