"""The results of a run (measured and predicted margins, breaches of the law, the domain's metrics) and of a replay."""

from collections.abc import Mapping
from dataclasses import dataclass

from hybrid_tamp.model.conditions import Violation
from hybrid_tamp.model.outcome import PlanOutcome
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.recording import AtomMargin, Recording
from hybrid_tamp.model.refined import Performance
from hybrid_tamp.model.tables import Rows, Tabular, cell
from hybrid_tamp.model.task import Task


@dataclass(frozen=True)
class ExecutedInstance:
    """One block instance that ran.

    Attributes:
        instance: the instance, with its measured start and end.
        exits: its exit conditions at its end.
    """

    instance: BlockInstance
    exits: tuple[AtomMargin, ...]


@dataclass(frozen=True)
class RunResult(Tabular):
    """The result of one run.

    Attributes:
        outcome: the outcome of planning, with the plan that was run.
        recording: the recording, with measured and predicted margins.
        metrics: the domain's metrics and those of every run, name (with unit) to value.
        wall_seconds: time for all the work [s].
        versions: versions of the software that the result depends on.
        performance: performance measures, predicted and measured.
        law: breaches of the law of assignment by the recording.
    """

    outcome: PlanOutcome
    recording: Recording
    metrics: Mapping[str, float]
    wall_seconds: float
    versions: Mapping[str, str]
    performance: tuple[Performance, ...]
    law: tuple[Violation, ...]

    @property
    def task(self) -> Task:
        """The task that was run."""
        return self.outcome.task

    @property
    def replans(self) -> int:
        """Number of plans that were discarded before the plan of the run."""
        return len(self.outcome.excluded)

    @property
    def success(self) -> bool:
        """Whether the plan ran to its end and the goal held there."""
        return self.recording.success

    @property
    def blocks(self) -> tuple[ExecutedInstance, ...]:
        """The block instances that ran."""
        exits = self.recording.exits
        return tuple(ExecutedInstance(each, exits.get(each.name, ())) for each in self.recording.instances)

    @property
    def rows(self) -> Rows:
        """The result as a table."""
        return [
            ("task", self.task.name),
            ("success", self.success),
            ("goal", [f"{each.atom.text}: {cell(each.measured)}" for each in self.recording.goal]),
            ("failure", self.recording.failure and self.recording.failure.reason),
            ("blocks", [f"{i.start:.2f} to {i.end:.2f} s  {i.name}" for i in self.recording.instances]),
            ("performance", {f"{each.measure} of {each.instance}": each.measured for each in self.performance}),
            ("metrics", self.metrics),
            ("law", self.law),
            ("replans", self.replans),
            ("backend", self.recording.backend),
            ("seconds", self.wall_seconds),
        ]


@dataclass(frozen=True)
class StateDifference:
    """The first difference between two runs.

    Attributes:
        time: first instant at which a state differs [s].
        token: a token that differs there.
        property: its property that differs most.
        size: largest absolute difference of its components, in the property's unit.
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
        first_difference: the first difference of a state, or None.
        refusal: why the backend refused a logged command; empty if it did not.
    """

    identical: bool
    steps: int
    first_difference: StateDifference | None = None
    refusal: str = ""

    @property
    def rows(self) -> Rows:
        """The comparison as a table."""
        first = self.first_difference
        where = first and f"{first.property} of {first.token} by {first.size:.3g} at {first.time:.3f} s"
        return [
            ("identical", self.identical),
            ("steps", self.steps),
            ("first difference", where),
            ("refusal", self.refusal),
        ]
