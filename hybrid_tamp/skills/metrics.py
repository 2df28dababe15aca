"""Metrics of a finished run."""

from collections.abc import Callable, Iterator, Mapping

from hybrid_tamp.model.plan import BlockInstance, split_mode
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task

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
