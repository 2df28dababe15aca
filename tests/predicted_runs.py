"""Runs of plans in the forward models of the blocks."""

from collections.abc import Mapping

from hybrid_tamp.execution.execute import execute
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.refined import GOAL
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.protocol import open_backend


def predict(task: Task, plan: TaskPlan) -> Recording:
    """Run the plan in the forward models of its blocks."""
    with open_backend("analytic") as backend:
        return execute(task, plan, backend)


def margins_of(recording: Recording) -> Mapping[tuple[str, Atom], float | None]:
    """Return a mapping from pairs of (instance or `GOAL`, atom) to the recorded margins."""
    found = {(name, m.atom): m.measured for name, margins in recording.exits.items() for m in margins}
    return found | {(GOAL, margin.atom): margin.measured for margin in recording.goal}
