"""Candidates of the mid-level planner run in physics, and scored as rollouts are."""

from collections.abc import Sequence
from functools import partial

import numpy as np

from hybrid_tamp.midlevel.measured import measure_run, merge_rollouts
from hybrid_tamp.midlevel.rollout import Chosen, Rollout
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.workers.processes import map_in_processes


class PhysicsRollouts:
    """A way to roll out (`midlevel.objective.RollOut`) that runs each candidate in a physics backend.

    Each process gets an equal share of the candidates, in their order. What all of a share have in common is run
    once; each then goes on from a snapshot. A run from there is the same to the bit as one from the start, so
    the result does not depend on how many processes there are.

    Attributes:
        task: the task; with its domain it travels to the processes.
        plan: the plan whose hyperparameters are varied.
        backend: name of the physics backend.
        processes: processes that run at once.
    """

    def __init__(self, task: Task, plan: TaskPlan, backend: str = "pybullet", processes: int = 1) -> None:
        self.task = task
        self.plan = plan
        self.backend = backend
        self.processes = processes

    def __call__(self, chosen: Chosen, count: int, until: str | None = None) -> Rollout:
        """Run a population.

        Args:
            chosen: (instance, hyperparameter) to its values ``(n,)``; others are as the plan says, or initial values.
            count: size n of the population.
            until: the instance with whose end the runs end; what comes later is left out.

        Raises:
            InputError: the backend cannot simulate the task.
        """
        values = [{key: float(each[candidate]) for key, each in chosen.items()} for candidate in range(count)]
        plans = [self.plan.set_hyperparameters(each) for each in values]
        shares = [[plans[i] for i in share] for share in np.array_split(np.arange(count), self.processes) if len(share)]
        run = partial(_run, self.task, backend=self.backend, until=until)
        found = map_in_processes(run, shares, self.processes)
        return merge_rollouts([rollout for share in found for rollout in share])


def _run(task: Task, plans: Sequence[TaskPlan], backend: str, until: str | None) -> list[Rollout]:
    """Run plans one after the other, in a process of this machine."""
    from hybrid_tamp.execution.loop import execute_variants
    from hybrid_tamp.physics.protocol import open_backend

    with open_backend(backend) as physics:
        recordings = execute_variants(task, plans, physics, until)
        return [measure_run(task, recording, whole=until is None) for recording in recordings]
