"""Results of imitation: the observed plan of one agent, and the run of another agent that imitates this plan."""

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
        token: name of the token that moved.
        start: start of the movement [s].
        end: end of the movement [s].
    """

    token: str
    start: float
    end: float

    @property
    def text(self) -> str:
        """Description of the movement."""
        return f"no block explains the movement of {self.token} from {self.start:.2f} s to {self.end:.2f} s"


@dataclass(frozen=True)
class Segmentation:
    """An observation that was segmented into block instances.

    Attributes:
        plan: timeline of the block instances. A token is in no instance during an unexplained movement.
        unexplained: movements that no block explains, sorted by time.
        violations: violations of the law of assignment in the observation, including goal atoms that do not hold.
        cost: cost of the segmentation. More instances, and instances that fit the observation less, increase the cost.
    """

    plan: TaskPlan
    unexplained: tuple[Unexplained, ...]
    violations: tuple[Violation, ...]
    cost: float


@dataclass(frozen=True)
class FittedPrimitive:
    """The fit of a motor primitive to a demonstration.

    Attributes:
        rms: root mean square of the distance between primitive and demonstration [unit].
        unit: unit of the distance.
    """

    rms: float
    unit: str


@dataclass(frozen=True)
class ImitationResult(Tabular):
    """The result of an imitation.

    Attributes:
        shown: name of the folder or file of the demonstration.
        segmentation: segmented observation.
        roles: maps each observed token to the token that takes its role in the imitation.
        primitives: maps each taught block to the fit of its motor primitive.
        run: result of the run of the imitating agent.
    """

    shown: str
    segmentation: Segmentation
    roles: Mapping[str, str]
    primitives: Mapping[str, FittedPrimitive]
    run: RunResult

    @property
    def rows(self) -> Rows:
        """Rows of the table that shows the imitation."""
        seen = [each.text for each in self.instances]
        return [("seen", seen), ("roles", self.roles), ("taught", list(self.primitives)), *self.run.rows]

    @property
    def instances(self) -> tuple[BlockInstance, ...]:
        """Observed instances, sorted by time."""
        return tuple(sorted(self.segmentation.plan.instances, key=lambda i: (i.start, i.end, i.name)))

    @property
    def success(self) -> bool:
        """Whether the imitating agent reached the goal without a violation of the law of assignment."""
        return self.run.success and not self.run.law
