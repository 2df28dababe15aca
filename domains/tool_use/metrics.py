"""Metrics of tool use in a finished run, measured and predicted in closed form."""

from collections.abc import Iterator, Mapping

import numpy as np

from hybrid_tamp.authoring import BlockInstance, Recording, Task, Token
from hybrid_tamp.skills import dot, hand_in, location_on_handle, measure_instances, norm, rows_of, run_of, side

from .feasibility import resistance
from .striking import tip_speed
from .swing import swing_of

_MOVING = 0.02
"""Smallest speed at which a pushed object counts as moving [m/s]."""
_WITH_TOOL = ("CARRYING", "PUSHING", "STRIKING")


def metrics(task: Task, recording: Recording) -> Mapping[tuple[str, str], float]:
    """Return the metrics of every grasp, push and strike. The result maps each pair of (instance, metric) to a value.

    - Grasp: the grasp location and the largest slip of the hand in the tool's frame. The slip is measured at the ends
      of the later blocks in which the hand holds the tool.
    - Push: the mean torque of the wrist about the tool's y axis while the object moves, measured and predicted.
    - Strike: the largest speed of the impact point along the normal of the striking face, measured and predicted.
    """
    return measure_instances(task, recording, {"GRASPING": _grasp, "PUSHING": _push, "STRIKING": _strike})


def _tokens(task: Task, instance: BlockInstance) -> tuple[Token, Token]:
    return task.token_by_name[instance.slots["hand"]], task.token_by_name[instance.slots["tool"]]


def _grasp(task: Task, recording: Recording, instance: BlockInstance) -> Iterator[tuple[str, float]]:
    hand, tool = _tokens(task, instance)
    grasped = recording.at(instance.end)
    place = hand_in(grasped, hand, tool)
    later = [
        norm(hand_in(recording.at(other.end), hand, tool) - place)
        for other in _later(recording, instance)
        if other.block.startswith(_WITH_TOOL)
    ]
    yield "grasp_location [m]", float(location_on_handle(grasped, hand, tool))
    if later:
        yield "slip [m]", float(max(later))


def _later(recording: Recording, grasp: BlockInstance) -> Iterator[BlockInstance]:
    """Yield the hand's instances after a grasp and before the hand's next grasp, in order of time."""
    for instance in sorted(recording.instances, key=lambda other: other.start):
        if instance.slots.get("hand") == grasp.slots["hand"] and instance.start >= grasp.end:
            if instance.block == grasp.block:
                return
            yield instance


def _push(task: Task, recording: Recording, instance: BlockInstance) -> Iterator[tuple[str, float]]:
    hand, tool = _tokens(task, instance)
    thing, run = task.token_by_name[instance.slots["object"]], run_of(recording, instance.start, instance.end)
    torque = recording.commanded(hand.name, "torque")[rows_of(recording, instance.start, instance.end)]
    moving = norm(run[thing, "velocity"]) > _MOVING
    if moving.any():
        about = dot(torque, side(run, tool))[moving]
        yield "torque [N m]", float(np.abs(np.mean(about)))
        lever = tool["pushing_point"][0] - hand_in(recording.at(instance.start), hand, tool)[0]
        yield "torque_predicted [N m]", float(resistance(thing) * lever)


def _strike(task: Task, recording: Recording, instance: BlockInstance) -> Iterator[tuple[str, float]]:
    hand, tool = _tokens(task, instance)
    run = run_of(recording, instance.start, instance.end)
    if len(run.values):
        held_at = hand_in(recording.at(instance.start), hand, tool)[0]
        swing = swing_of(hand, tool, held_at, instance.hyperparameters["swing_radius"])
        yield "tip_speed [m/s]", float(tip_speed(run, tool).max())
        yield "tip_speed_predicted [m/s]", float(swing.tip_speed)
