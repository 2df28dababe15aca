"""Runs of plans on the blocks' own forward models, by the executor."""

from collections.abc import Mapping

from hybrid_tamp.execution.execute import execute
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.refined import GOAL
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.protocol import open_backend


def predict(task: Task, plan: TaskPlan) -> Recording:
    """Run the plan on the blocks' own forward models."""
    with open_backend("analytic") as backend:
        return execute(task, plan, backend)


def margins_of(recording: Recording) -> Mapping[tuple[str, Atom], float | None]:
    """Return the recorded margins by (instance or `GOAL`, atom)."""
    found = {(name, m.atom): m.measured for name, margins in recording.exits.items() for m in margins}
    return found | {(GOAL, margin.atom): margin.measured for margin in recording.goal}
