"""Imitation: the observed plan of an agent, and the run of another agent that imitates it."""

from collections.abc import Mapping
from dataclasses import dataclass

from hybrid_tamp.model.conditions import Violation
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.run_result import RunResult
from hybrid_tamp.model.tables import Rows, Tabular


@dataclass(frozen=True)
class Unexplained:
    """A movement that no block of the domain explains.

    Attributes:
        token: the token that moved.
        start: start of the movement [s].
        end: end of the movement [s].
    """

    token: str
    start: float
    end: float

    @property
    def text(self) -> str:
        """The movement in words."""
        return f"{self.token} moves from {self.start:.2f} s to {self.end:.2f} s, which no block explains"


@dataclass(frozen=True)
class Segmentation:
    """An observation as a timeline of block instances.

    Attributes:
        plan: the timeline; a token is in no instance during an unexplained movement.
        unexplained: the movements that no block explains, by time.
        violations: where the timeline breaks the law or misses the goal, judged by the observed margins.
        cost: cost of the number of instances and of their misfit; less is better.
    """

    plan: TaskPlan
    unexplained: tuple[Unexplained, ...]
    violations: tuple[Violation, ...]
    cost: float


@dataclass(frozen=True)
class FittedPrimitive:
    """The fit of a motor primitive to a demonstration.

    Attributes:
        rms: root mean square distance [unit].
        unit: unit of the distance.
    """

    rms: float
    unit: str


@dataclass(frozen=True)
class ImitationResult(Tabular):
    """The result of an imitation.

    Attributes:
        shown: name of the folder or file of the demonstration.
        segmentation: the observation as a timeline.
        roles: observed token to the token that took its role.
        primitives: maps each taught block to the fit of its motor primitive.
        run: the result of the imitator's run.
    """

    shown: str
    segmentation: Segmentation
    roles: Mapping[str, str]
    primitives: Mapping[str, FittedPrimitive]
    run: RunResult

    @property
    def rows(self) -> Rows:
        """The imitation as a table."""
        seen = [each.text for each in self.instances]
        return [("seen", seen), ("roles", self.roles), ("taught", list(self.primitives)), *self.run.rows]

    @property
    def instances(self) -> tuple[BlockInstance, ...]:
        """The observed instances, by time."""
        return tuple(sorted(self.segmentation.plan.instances, key=lambda i: (i.start, i.end, i.name)))

    @property
    def success(self) -> bool:
        """Whether the imitator reached the goal without breaking the law of assignment."""
        return self.run.success and not self.run.law
