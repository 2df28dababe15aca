"""Metrics of a finished run."""

from collections.abc import Callable, Iterator, Mapping

from hybrid_tamp.model.plan import BlockInstance, split_mode
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.skills.handles import hand_in, location_on_handle
from hybrid_tamp.skills.vectors import norm

Measures = Callable[[Task, Recording, BlockInstance], Iterator[tuple[str, float]]]
"""``measures(task, recording, instance)`` yields a pair of (metric, value) for each metric of a block instance."""


def rows_of(recording: Recording, start: float, end: float) -> slice:
    """Return the slice of a recording's rows between two times [s]."""
    return slice(*(round(time / recording.timestep) for time in (start, end)))


def run_of(recording: Recording, start: float, end: float) -> State:
    """Return the measured states ``(t, n)`` between two times [s]."""
    return State(recording.layout, recording.states[rows_of(recording, start, end)])


def measure_instances(
    task: Task, recording: Recording, measures: Mapping[str, Measures]
) -> Mapping[tuple[str, str], float]:
    """Return the metrics of all instances. The result maps each pair of (instance, metric) to a value.

    Args:
        task: the task that was run.
        recording: the recorded run.
        measures: maps names of blocks to the measures of their instances. An action's name stands for all its modes.
    """
    return {
        (instance.name, name): value
        for instance in recording.instances
        for block in dict.fromkeys((instance.block, split_mode(instance.block)[0]))
        if block in measures
        for name, value in measures[block](task, recording, instance)
    }


def measure_grasp(role: str = "object") -> Measures:
    """Return the measures of a grasp: the place of the hand on the handle, and its largest slip along any axis.

    The slip is the distance that the hand moves in the frame of the object. It is measured at the ends of the later
    blocks in which the hand holds the object of the role.
    """

    def measures(task: Task, recording: Recording, instance: BlockInstance) -> Iterator[tuple[str, float]]:
        hand, thing = (task.token_by_name[instance.slots[each]] for each in ("hand", role))
        grasped = recording.at(instance.end)
        place = hand_in(grasped, hand, thing)
        later = [
            norm(hand_in(recording.at(other.end), hand, thing) - place)
            for other in _later(recording, instance)
            if other.slots.get(role) == thing.name and other.block != "RELEASING"
        ]
        yield "grasp_location [m]", float(location_on_handle(grasped, hand, thing))
        if later:
            yield "slip [m]", float(max(later))

    return measures


def _later(recording: Recording, grasp: BlockInstance) -> Iterator[BlockInstance]:
    """Yield the hand's instances after a grasp and before the hand's next grasp, in order of time."""
    for instance in sorted(recording.instances, key=lambda other: other.start):
        if instance.slots.get("hand") == grasp.slots["hand"] and instance.start >= grasp.end:
            if instance.block == grasp.block:
                return
            yield instance
