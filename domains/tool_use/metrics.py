"""Metrics of tool use in a finished run, measured and predicted in closed form."""

from collections.abc import Iterator, Mapping

import numpy as np

from hybrid_tamp.authoring import BlockInstance, Recording, Task, Token
from hybrid_tamp.skills import dot, hand_in, measure_grasp, measure_instances, norm, rows_of, run_of, side

from .feasibility import resistance
from .striking import tip_speed
from .swing import swing_of

_MOVING = 0.02
"""Smallest speed at which a pushed object counts as moving [m/s]."""


def metrics(task: Task, recording: Recording) -> Mapping[tuple[str, str], float]:
    """Return the metrics of every grasp, push and strike. The result maps each pair of (instance, metric) to a value.

    - Grasp: the grasp location, and the largest slip of the hand in the tool's frame.
    - Push: the mean torque of the wrist about the tool's y axis while the object moves, measured and predicted.
    - Strike: the largest speed of the impact point along the normal of the striking face, measured and predicted.
    """
    return measure_instances(
        task, recording, {"GRASPING": measure_grasp("tool"), "PUSHING": _push, "STRIKING": _strike}
    )


def _tokens(task: Task, instance: BlockInstance) -> tuple[Token, Token]:
    return task.token_by_name[instance.slots["hand"]], task.token_by_name[instance.slots["tool"]]


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
