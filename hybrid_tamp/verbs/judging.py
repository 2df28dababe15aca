"""Evaluation of a run, and comparison of optimised hyperparameters with their defaults in the same physics."""

from dataclasses import replace
from math import isfinite

from hybrid_tamp.execution.execute import add_predictions, execute
from hybrid_tamp.midlevel.measured import measure_run
from hybrid_tamp.model.closest_pair import ClosestPair
from hybrid_tamp.model.collision import Collision
from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.outcome import PlanOutcome
from hybrid_tamp.model.recording import Failure, Recording
from hybrid_tamp.model.refined import Value
from hybrid_tamp.model.run_result import Compared, RunResult
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.protocol import Backend
from hybrid_tamp.planning.closest_pairs import measure_pairs
from hybrid_tamp.planning.collisions import check_recording
from hybrid_tamp.planning.isolation import ChildEnded, Note, run_isolated
from hybrid_tamp.report.measures import run_measures
from hybrid_tamp.report.versions import versions


def judge(
    outcome: PlanOutcome, recording: Recording, seconds: float, comparison: tuple[Compared, ...] = ()
) -> RunResult:
    """Return the result of a run: its recording, metrics, performance measures and violations of the law of assignment.

    Args:
        outcome: the outcome of planning, with the refined plan that was executed.
        recording: the recording of the run.
        seconds: wall-clock time from planning to the end of the run [s].
        comparison: the values with optimised hyperparameters and with the defaults, or empty.
    """
    assert outcome.refinement is not None, "a plan must be refined before it is executed"
    task = outcome.task
    recording, pairs, collisions = _compare_bodies(add_predictions(recording, outcome.refinement.expected), outcome)
    own = task.domain.measure(task, recording)
    metrics = {".".join(key): value for key, value in own.items()} | dict(run_measures(outcome.required(), recording))
    figures = {key: float(figure[0]) for key, figure in measure_run(task, recording).figures.items()}
    return RunResult(
        outcome=outcome,
        recording=recording,
        metrics={name: value for name, value in metrics.items() if isfinite(value)},
        wall_seconds=seconds,
        versions=versions(),
        performance=tuple(
            replace(each, measured=figures.get((each.instance, each.measure)))
            for each in outcome.refinement.performance
        ),
        law=tuple([] if recording.failure else check_law(task, recording.plan, recording.at)),
        comparison=comparison,
        closest_pairs=pairs,
        collisions=collisions,
    )


def _compare_bodies(
    recording: Recording, outcome: PlanOutcome
) -> tuple[Recording, tuple[ClosestPair, ...], tuple[Collision, ...]]:
    """Return the recording, its closest pairs and its collisions. A run that cannot be checked counts as failed."""

    def compare(note: Note) -> tuple[tuple[ClosestPair, ...], tuple[Collision, ...]]:
        note("the check of the recording")
        pairs = measure_pairs(outcome.task, recording, outcome.closest_pairs)
        return pairs, () if recording.failure else check_recording(outcome.task, recording)

    try:
        return recording, *run_isolated(compare, NEVER)
    except ChildEnded as ended:
        last = max(recording.instances, key=lambda each: each.end)
        failure = Failure(len({each.end for each in recording.instances}), last.name, str(ended))
        return replace(recording, failure=recording.failure or failure), outcome.closest_pairs, ()


def compare_runs(
    outcome: PlanOutcome, recording: Recording, physics: Backend, deadline: Deadline
) -> tuple[Compared, ...]:
    """Run a plan with the default hyperparameters, and return the values of both runs.

    Args:
        outcome: the outcome of planning, with optimised hyperparameters.
        recording: the recording of the run with optimised hyperparameters.
        physics: the backend in which this plan was run.
        deadline: deadline of the command.

    Raises:
        LimitReached: the deadline passes.
    """
    assert outcome.refinement is not None, "a plan must be refined before it is executed"
    task, refined = outcome.task, outcome.refinement
    defaults = {(each.instance, each.name): each.default for each in refined.hyperparameters}
    other = execute(task, refined.plan.set_hyperparameters(defaults), physics, deadline=deadline)
    return (
        Compared("optimised", refined.best, _measure(task, recording)),
        Compared("defaults", refined.defaults, _measure(task, other)),
    )


def _measure(task: Task, recording: Recording) -> Value | None:
    """Return the violation and the value of a run, or None if the run failed."""
    if recording.failure is not None:
        return None
    rollout = measure_run(task, recording)
    return Value(float(rollout.violation[0]), float(rollout.value[0]))
