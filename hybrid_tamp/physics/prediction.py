"""What the blocks' own forward models expect of a plan, beside what was measured."""

from collections.abc import Mapping
from dataclasses import replace

from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.recording import AtomMargin, Recording
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.analytic import AnalyticBackend
from hybrid_tamp.physics.execution import execute


def predict(task: Task, plan: TaskPlan) -> Recording:
    """Run the plan on the blocks' own forward models, by the same executor."""
    with AnalyticBackend() as backend:
        return execute(task, plan, backend)


def with_predictions(measured: Recording, predicted: Recording) -> Recording:
    """Return the measured recording with the other's margins as its predicted ones.

    A condition that the prediction never came to, because it failed before, stays without one.
    """
    exits = {
        instance: _merged(margins, predicted.exits.get(instance, ())) for instance, margins in measured.exits.items()
    }
    return replace(measured, exits=exits, goal=_merged(measured.goal, predicted.goal))


def _merged(mine: tuple[AtomMargin, ...], theirs: tuple[AtomMargin, ...]) -> tuple[AtomMargin, ...]:
    expected: Mapping[str, float | None] = {margin.atom: margin.measured for margin in theirs}
    return tuple(replace(margin, predicted=expected.get(margin.atom)) for margin in mine)
