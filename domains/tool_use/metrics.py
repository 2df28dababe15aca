"""The domain's own measures of a finished run, beside what the closed forms predict of them."""

from collections.abc import Iterator, Mapping

import numpy as np

from hybrid_tamp.authoring import BlockInstance, FloatArray, Recording, State, Task, Token

from .feasibility import resistance
from .geometry import dot, hand_in_tool, location, norm, side
from .striking import tip_speed
from .swing import swing_of

_MOVING = 0.02
"""Speed from which on a thing that is pushed counts as moving [m/s]."""
_WITH_TOOL = ("CARRYING", "PUSHING", "STRIKING")


def metrics(task: Task, recording: Recording) -> Mapping[tuple[str, str], float]:
    """Return the measures of every grasp, push and strike, each by the name of its instance and its own.

    Grasp: where it is when the grasp ends, and how far the hand was from there at most, in the tool's frame, at the
    end of a later block that holds the tool. Push: mean torque of the wrist about the tool's y axis while the object
    moves, and the one that follows from the grasp. Strike: largest speed of the impact point along its normal, and
    the one that follows from the grasp.
    """
    found: dict[tuple[str, str], float] = {}
    for instance in recording.instances:
        if instance.block == "GRASPING":
            measures = _grasp(task, recording, instance)
        elif instance.block == "PUSHING":
            measures = _push(task, recording, instance)
        elif instance.block == "STRIKING":
            measures = _strike(task, recording, instance)
        else:
            continue
        found |= {(instance.name, name): value for name, value in measures}
    return found


def _tokens(task: Task, instance: BlockInstance) -> tuple[Token, Token]:
    return task.token_by_name[instance.slots["hand"]], task.token_by_name[instance.slots["tool"]]


def _rows(recording: Recording, instance: BlockInstance) -> slice:
    return slice(*(round(time / recording.timestep) for time in (instance.start, instance.end)))


def _grasp(task: Task, recording: Recording, instance: BlockInstance) -> Iterator[tuple[str, float]]:
    hand, tool = _tokens(task, instance)
    grasped = recording.at(instance.end)
    place = hand_in_tool(grasped, hand, tool)
    later = [
        norm(hand_in_tool(recording.at(other.end), hand, tool) - place)
        for other in _later(recording, instance)
        if other.block.startswith(_WITH_TOOL)
    ]
    yield "grasp_location [m]", float(location(grasped, hand, tool))
    if later:
        yield "slip [m]", float(max(later))


def _later(recording: Recording, grasp: BlockInstance) -> Iterator[BlockInstance]:
    """Yield what the hand does next, up to its next grasp, in order."""
    for instance in sorted(recording.instances, key=lambda other: other.start):
        if instance.slots.get("hand") == grasp.slots["hand"] and instance.start >= grasp.end:
            if instance.block == grasp.block:
                return
            yield instance


def _push(task: Task, recording: Recording, instance: BlockInstance) -> Iterator[tuple[str, float]]:
    hand, tool = _tokens(task, instance)
    thing, rows = task.token_by_name[instance.slots["object"]], _rows(recording, instance)
    run = State(recording.layout, recording.states[rows])
    torque = _commanded(recording, hand, "torque")[rows]
    moving = norm(run[thing, "velocity"]) > _MOVING
    if moving.any():
        about = dot(torque, side(run, tool))[moving]
        yield "torque [N m]", float(np.abs(np.mean(about)))
        lever = tool["pushing_point"][0] - hand_in_tool(recording.at(instance.start), hand, tool)[0]
        yield "torque_predicted [N m]", float(resistance(thing) * lever)


def _strike(task: Task, recording: Recording, instance: BlockInstance) -> Iterator[tuple[str, float]]:
    hand, tool = _tokens(task, instance)
    run = State(recording.layout, recording.states[_rows(recording, instance)])
    if len(run.values):
        held_at = hand_in_tool(recording.at(instance.start), hand, tool)[0]
        swing = swing_of(hand, tool, held_at, instance.hyperparameters["swing_radius"])
        yield "tip_speed [m/s]", float(tip_speed(run, tool).max())
        yield "tip_speed_predicted [m/s]", float(swing.tip_speed)


def _commanded(recording: Recording, hand: Token, action: str) -> FloatArray:
    """Return the commands of one basic action, ``(t, size)``."""
    start = 0
    for token, name, size in recording.commands_layout:
        if (token, name) == (hand.name, action):
            return recording.commands[:, start : start + size]
        start += size
    raise KeyError(f"{action} on {hand.name}")
