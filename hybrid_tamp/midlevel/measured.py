"""Conversion of measured runs to rollouts, so that an `Objective` can score measured runs."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np

from hybrid_tamp.midlevel.predictions import Condition, Interval, Key, Rollout, weigh_plan
from hybrid_tamp.model.facts import fact_margin
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.refined import GOAL
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray

_Name = TypeVar("_Name")


def measure_run(task: Task, recording: Recording, whole: bool = True) -> Rollout:
    """Convert a recording to the rollout of a population with one candidate.

    If the run failed, its violation is infinite. ``whole`` says whether the run covers the whole plan. If not, the goal
    atoms are left out.
    """
    conditions: list[Condition] = []
    figures: dict[Key, FloatArray] = {}
    for instance in recording.instances:
        conditions += _conditions(task, recording, instance)
        figures |= {(instance.name, name): figure for name, figure in _figures(task, recording, instance)}
    for atom in task.goal if whole else ():
        margin = np.array([task.margin(atom, recording.state(-1))])
        conditions.append(Condition(GOAL, atom, task.domain.predicate_by_name[atom.predicate], margin))
    final = State(recording.layout, recording.states[-1:])
    value = weigh_plan(task, recording.instances, figures, final)
    failed = {recording.failure.instance: np.array([True])} if recording.failure else {}
    intervals = {
        i.name: Interval(*(np.array([time]) for time in (i.start, i.active.end, i.end))) for i in recording.instances
    }
    return Rollout(tuple(conditions), figures, value, final, intervals, failed)


def merge_rollouts(runs: Sequence[Rollout]) -> Rollout:
    """Merge the rollouts of single candidates into the rollout of a population. Values that a run lacks are NaN."""
    margins = [{(c.where, c.atom, c.throughout): c.margin for c in run.conditions} for run in runs]
    longest = max(runs, key=lambda run: len(run.conditions))
    conditions = [replace(c, margin=_concatenate(margins, (c.where, c.atom, c.throughout))) for c in longest.conditions]
    figures = {key: _concatenate([run.figures for run in runs], key) for key in _keys(run.figures for run in runs)}
    times = [[{name: at[side] for name, at in run.intervals.items()} for run in runs] for side in range(3)]
    failed = [{name: where.astype(float) for name, where in run.failed.items()} for run in runs]
    return Rollout(
        conditions=tuple(conditions),
        figures=figures,
        value=np.concatenate([run.value for run in runs]),
        final=State(runs[0].final.layout, np.concatenate([run.final.values for run in runs])),
        intervals={name: Interval(*(_concatenate(each, name) for each in times)) for name in _keys(times[0])},
        failed={name: _concatenate(failed, name) == 1.0 for name in _keys(failed)},
    )


def _keys(tables: Iterable[Mapping[_Name, object]]) -> list[_Name]:
    """Return the keys of all tables in order, without duplicates."""
    return list(dict.fromkeys(key for table in tables for key in table))


def _concatenate(tables: Sequence[Mapping[_Name, FloatArray]], key: _Name) -> FloatArray:
    """Concatenate the entries of all tables for a key. Each entry has shape ``(1,)``, and missing entries are NaN."""
    return np.concatenate([table.get(key, np.array([np.nan])) for table in tables])


def _conditions(task: Task, recording: Recording, instance: BlockInstance) -> Iterator[Condition]:
    block, binding = task.domain.block_by_name[instance.block], task.bind(instance.roles)
    sides = [(block.measured_exits, instance.end)]
    if instance.start > 0:
        sides.insert(0, (block.predicted_entries, instance.start))
    for literals, time in sides:
        state = recording.at(time)
        for literal in literals:
            static = literal.predicate.static
            measured = fact_margin(literal, task.state, state, binding) if static else literal.margin(state, binding)
            margin = np.array([float(measured)])
            yield Condition(instance.name, literal.ground(binding), literal.predicate, margin)
    run = _run_until_exit(recording, instance)
    for literal in block.invariants:
        margin = np.array([np.min(literal.margin(run, binding), initial=np.inf)])
        yield Condition(instance.name, literal.ground(binding), literal.predicate, margin, throughout=True)


def _rows_until_exit(recording: Recording, instance: BlockInstance) -> tuple[int, int]:
    """Return the row at the start of an instance, and the row at which its exit conditions hold (or else its end)."""
    end = instance.end if instance.reached is None else min(instance.reached, instance.end)
    first, last = (round(time / recording.timestep) for time in (instance.start, end))
    return first, last


def _run_until_exit(recording: Recording, instance: BlockInstance) -> State:
    first, last = _rows_until_exit(recording, instance)
    return State(recording.layout, recording.states[first + 1 : last + 1])


def _figures(task: Task, recording: Recording, instance: BlockInstance) -> Iterator[tuple[str, FloatArray]]:
    """Yield (measure, figure) for each measure. The figure covers an instance until its exit conditions hold."""
    block, binding = task.domain.block_by_name[instance.block], task.bind(instance.roles)
    first, last = _rows_until_exit(recording, instance)
    run = _run_until_exit(recording, instance)
    commands = {
        (token, action): recording.commanded(token, action)[first:last]
        for token, action, _ in recording.commands_layout
    }
    chosen = {name: np.asarray(value) for name, value in instance.hyperparameters.items()}
    for measure in block.performance:
        if measure.end is not None:
            before, after = recording.state(first), recording.state(last)
            figure = float(measure.at_end(block.name, binding, before, after, chosen))
        elif measure.peak is not None:
            figure = float(np.max(measure.during(block.name, binding, run, commands), initial=-np.inf))
        else:
            figure = float(np.sum(measure.during(block.name, binding, run, commands))) * recording.timestep
        yield measure.name, np.array([figure])
