"""Results of a run and of a replay."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from hybrid_tamp.model.closest_pair import ClosestPair
from hybrid_tamp.model.collision import Collision
from hybrid_tamp.model.conditions import Violation
from hybrid_tamp.model.outcome import PlanOutcome
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.recording import AtomMargin, Recording
from hybrid_tamp.model.refined import Performance, Value
from hybrid_tamp.model.tables import Rows, Tabular, cell
from hybrid_tamp.model.task import Task


@dataclass(frozen=True)
class ExecutedInstance:
    """A block instance that ran.

    Attributes:
        instance: block instance with measured start and end.
        exits: margins of the exit conditions at the end of the instance.
    """

    instance: BlockInstance
    exits: tuple[AtomMargin, ...]


@dataclass(frozen=True)
class OutOfBounds:
    """A metric of a run that is outside the bounds of the domain.

    Attributes:
        metric: name of the instance and of the metric, with its unit.
        value: value of the metric.
        lower: least value of a successful run.
        upper: greatest value of a successful run.
    """

    metric: str
    value: float
    lower: float
    upper: float

    @property
    def text(self) -> str:
        """The metric, its value and its bounds in one line."""
        return f"{self.metric} must be between {self.lower:g} and {self.upper:g}, got {self.value:.4g}"


@dataclass(frozen=True)
class Compared:
    """The value of a plan with one choice of hyperparameters.

    Attributes:
        hyperparameters: ``optimised`` or ``defaults``.
        predicted: V and J in the forward models.
        measured: V and J in the physics of the run; null if the run failed.
    """

    hyperparameters: Literal["optimised", "defaults"]
    predicted: Value
    measured: Value | None


@dataclass(frozen=True)
class RunResult(Tabular):
    """The result of one run.

    Attributes:
        outcome: outcome of planning, with the plan that was run.
        recording: recording of the run, with measured and predicted margins.
        metrics: maps each metric (name with unit) to its value. Includes metrics of the domain and general metrics.
        wall_seconds: wall-clock time for planning and running [s].
        versions: maps each software package on which the result depends to its version.
        performance: predicted and measured performance measures.
        law: violations of the law of assignment in the recording.
        comparison: values with optimised hyperparameters and with the defaults. Empty if not requested.
        closest_pairs: closest pair of bodies in each movement, with planned and measured distances.
        collisions: collisions in the recording, by an independent check. A run that stopped early is not checked.
    """

    outcome: PlanOutcome
    recording: Recording
    metrics: Mapping[str, float]
    wall_seconds: float
    versions: Mapping[str, str]
    performance: tuple[Performance, ...]
    law: tuple[Violation, ...]
    comparison: tuple[Compared, ...] = ()
    closest_pairs: tuple[ClosestPair, ...] = ()
    collisions: tuple[Collision, ...] = ()

    @property
    def task(self) -> Task:
        """Task that was run."""
        return self.outcome.task

    @property
    def replans(self) -> int:
        """Number of plans that were discarded before the plan of the run."""
        return len(self.outcome.excluded)

    @property
    def out_of_bounds(self) -> tuple[OutOfBounds, ...]:
        """The metrics that are outside the bounds of the domain."""
        return tuple(
            OutOfBounds(metric, value, lower, upper)
            for name, (lower, upper) in self.task.domain.bounds.items()
            for metric, value in self.metrics.items()
            if metric.endswith(f".{name}") and not lower <= value <= upper
        )

    @property
    def success(self) -> bool:
        """Whether the plan ran to its end, the goal held there, and every metric is within its bounds."""
        return self.recording.success and not self.out_of_bounds

    @property
    def blocks(self) -> tuple[ExecutedInstance, ...]:
        """Block instances that ran."""
        exits = self.recording.exits
        return tuple(ExecutedInstance(each, exits.get(each.name, ())) for each in self.recording.instances)

    @property
    def rows(self) -> Rows:
        """Rows of the table that shows the result."""
        return [
            ("task", self.task.name),
            ("success", self.success),
            ("goal", [f"{each.atom.text}: {cell(each.measured)}" for each in self.recording.goal]),
            ("failure", self.recording.failure and self.recording.failure.reason),
            ("blocks", [f"{i.start:.2f} to {i.end:.2f} s  {i.name}" for i in self.recording.instances]),
            ("performance", {f"{each.measure} of {each.instance}": each.measured for each in self.performance}),
            ("metrics", self.metrics),
            ("out of bounds", [each.text for each in self.out_of_bounds]),
            ("law", self.law),
            ("collisions", [each.text for each in self.collisions]),
            ("replans", self.replans),
            ("backend", self.recording.backend),
            ("seconds", self.wall_seconds),
        ]


@dataclass(frozen=True)
class StateDifference:
    """The first difference between two runs.

    Attributes:
        time: first instant at which the states differ [s].
        token: name of the token with the largest difference.
        property: property of the token with the largest difference.
        size: largest absolute difference of the property's components, in the unit of the property.
    """

    time: float
    token: str
    property: str
    size: float


@dataclass(frozen=True)
class ReplayResult(Tabular):
    """The result of a replay.

    Attributes:
        identical: whether all states are bit-identical.
        steps: number of simulated control periods.
        first_difference: first difference between the states, or None.
        refusal: reason why the backend rejected a recorded command, or empty.
    """

    identical: bool
    steps: int
    first_difference: StateDifference | None = None
    refusal: str = ""

    @property
    def rows(self) -> Rows:
        """Rows of the table that shows the comparison."""
        first = self.first_difference
        where = first and f"{first.property} of {first.token} by {first.size:.3g} at {first.time:.3f} s"
        return [
            ("identical", self.identical),
            ("steps", self.steps),
            ("first difference", where),
            ("refusal", self.refusal),
        ]
