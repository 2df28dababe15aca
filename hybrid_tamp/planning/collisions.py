"""The independent check of plans and recordings: bodies must not collide, whatever chose the movements."""

from collections.abc import Mapping

import numpy as np

from hybrid_tamp.collision.checker import find_collisions
from hybrid_tamp.midlevel.predictions import Trace
from hybrid_tamp.model.collision import Collision
from hybrid_tamp.model.control import CONTROL_PERIOD
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray


def check_plan(task: Task, plan: TaskPlan, traces: Mapping[str, Trace]) -> tuple[Collision, ...]:
    """Return the collisions in the movements of a plan.

    Args:
        task: task of the plan.
        plan: plan with the times of the movements.
        traces: maps each instance that moves tokens to its movement, with one state for each control period.
    """
    return find_collisions(task, plan.instances, *lay_out(task, plan, traces))


def check_recording(task: Task, recording: Recording) -> tuple[Collision, ...]:
    """Return the collisions in a recording."""
    return find_collisions(task, recording.instances, recording.times, recording.trajectory)


def lay_out(task: Task, plan: TaskPlan, traces: Mapping[str, Trace]) -> tuple[FloatArray, State]:
    """Return the instants [s], shape ``(t,)``, and the states of all tokens, batch shape ``(t,)``, of a rollout.

    After the last state of its movement, a token stays where it is until its next movement begins.
    """
    count = round(plan.makespan / CONTROL_PERIOD) + 1
    layout = task.state.layout
    values = np.tile(task.state.values, (count, 1))
    for instance in sorted(plan.instances, key=lambda each: (each.start, each.name)):
        if instance.name not in traces:
            continue
        states = traces[instance.name].states
        writes = task.domain.block_by_name[instance.block].writes
        first = min(round(instance.start / CONTROL_PERIOD), count - 1)
        moved = min(len(states.values), count - first)
        for slot, token in instance.slots.items():
            for name in writes.get(slot, ()):
                columns, movement = layout.slices[token, name], states[token, name]
                values[first : first + moved, columns] = movement[:moved]
                values[first + moved :, columns] = movement[moved - 1]
    return np.arange(count, dtype=np.float64) * CONTROL_PERIOD, State(layout, values)
