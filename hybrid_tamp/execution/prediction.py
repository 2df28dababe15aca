"""What the blocks' own forward models expect of a plan, beside what was measured."""

from collections.abc import Mapping
from dataclasses import replace

from hybrid_tamp.execution.loop import execute
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.recording import AtomMargin, Recording
from hybrid_tamp.model.refined import GOAL
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.analytic import AnalyticBackend


def predict(task: Task, plan: TaskPlan) -> Recording:
    """Run the plan on the blocks' own forward models, by the same executor."""
    with AnalyticBackend() as backend:
        return execute(task, plan, backend)


def with_predictions(measured: Recording, expected: Mapping[tuple[str, Atom], float | None]) -> Recording:
    """Return the measured recording with what was predicted beside its margins.

    Args:
        measured: the recording.
        expected: (instance or `GOAL`, atom) to the margin; a condition without one stays without a prediction.
    """

    def merged(where: str, margins: tuple[AtomMargin, ...]) -> tuple[AtomMargin, ...]:
        return tuple(replace(margin, predicted=expected.get((where, margin.atom))) for margin in margins)

    exits = {instance: merged(instance, margins) for instance, margins in measured.exits.items()}
    return replace(measured, exits=exits, goal=merged(GOAL, measured.goal))


def margins_of(recording: Recording) -> Mapping[tuple[str, Atom], float | None]:
    """Return (instance or `GOAL`, atom) to the margin that a recording has of it."""
    found = {(name, m.atom): m.measured for name, margins in recording.exits.items() for m in margins}
    return found | {(GOAL, margin.atom): margin.measured for margin in recording.goal}
