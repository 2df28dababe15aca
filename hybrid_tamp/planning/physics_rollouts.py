"""Physics rollouts of the mid-level planner's candidates, scored like rollouts on forward models."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from hybrid_tamp.midlevel.measured import measure_run, merge_rollouts
from hybrid_tamp.midlevel.predictions import Chosen, Rollout
from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.workers.processes import map_in_processes


@dataclass(frozen=True, eq=False)
class PhysicsRollouts:
    """Rollout function (`midlevel.objective.RollOut`) that runs each candidate in a physics backend.

    The candidates are divided equally among the processes, in order. Each process runs the common beginning of its
    candidates once and continues each candidate from a snapshot. A continued run is bit-identical to a run from the
    start, so the result does not depend on the number of processes.

    Attributes:
        task: task of the plan. The task is sent to the processes together with its domain.
        plan: plan whose hyperparameters are varied.
        backend: name of the physics backend.
        processes: number of parallel processes.
        deadline: deadline of the command. Every process checks it.
    """

    task: Task
    plan: TaskPlan
    backend: str = "pybullet"
    processes: int = 1
    deadline: Deadline = NEVER

    def __call__(self, chosen: Chosen, count: int, until: str | None = None) -> Rollout:
        """Run every candidate of a population (see `midlevel.objective.RollOut`).

        Raises:
            InputError: if the backend cannot simulate the task.
            LimitReached: if the deadline passes.
        """
        values = [{key: float(each[candidate]) for key, each in chosen.items()} for candidate in range(count)]
        plans = [self.plan.set_hyperparameters(each) for each in values]
        shares = [[plans[i] for i in share] for share in np.array_split(np.arange(count), self.processes) if len(share)]
        run = partial(_run, self.task, backend=self.backend, until=until, deadline=self.deadline)
        found = map_in_processes(run, shares, self.processes)
        return merge_rollouts([rollout for share in found for rollout in share])


def _run(task: Task, plans: Sequence[TaskPlan], backend: str, until: str | None, deadline: Deadline) -> list[Rollout]:
    """Run plans in sequence in one process."""
    from hybrid_tamp.execution.execute import execute_variants
    from hybrid_tamp.physics.protocol import open_backend

    with open_backend(backend) as physics:
        recordings = execute_variants(task, plans, physics, until, deadline)
        return [measure_run(task, recording, whole=until is None) for recording in recordings]
