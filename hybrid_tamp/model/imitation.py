"""Imitation: what an agent was seen to do, in words of the domain, and how another agent did likewise."""

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
        token: what moved.
        start: from when [s].
        end: until when [s].
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
    """What an agent was seen to do, in words of the domain.

    Attributes:
        plan: the timeline of instances; tokens are in none while a movement is not explained.
        unexplained: the movements that no block explains, by time.
        violations: how the timeline, judged by the observation, breaks the law; the goal included.
        cost: number of instances and how well they fit; less is better.
    """

    plan: TaskPlan
    unexplained: tuple[Unexplained, ...]
    violations: tuple[Violation, ...]
    cost: float


@dataclass(frozen=True)
class FittedPrimitive:
    """How well a motor primitive fits what was shown.

    Attributes:
        rms: root mean square of the distance from it [unit].
        unit: unit of the distance.
    """

    rms: float
    unit: str


@dataclass(frozen=True)
class ImitationResult(Tabular):
    """The result of an imitation.

    Attributes:
        shown: name of the folder or file that shows the demonstration.
        segmentation: what was seen.
        roles: token that was seen to the token that took its role.
        primitives: block to the motor primitive that it was taught.
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
        """The instances that were seen, by time."""
        return tuple(sorted(self.segmentation.plan.instances, key=lambda i: (i.start, i.end, i.name)))

    @property
    def success(self) -> bool:
        """Whether the imitator reached the goal without breaking the law of assignment."""
        return self.run.success and not self.run.law
