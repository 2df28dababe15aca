"""Outcomes of planning: a plan and information about the planner, or the reason why there is no plan."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

from hybrid_tamp.errors import HybridTampError, LimitReached, NoPlan
from hybrid_tamp.model.closest_pair import ClosestPair
from hybrid_tamp.model.explanation import Explanation
from hybrid_tamp.model.plan import BlockInstance, Fewest, Step, TaskPlan
from hybrid_tamp.model.planned_network import PlannedNetwork
from hybrid_tamp.model.refined import RefinedPlan, Shortfall
from hybrid_tamp.model.tables import Rows, Tabular
from hybrid_tamp.model.task import Task

Status = Literal["solved", "unsolvable", "unknown", "limit"]

NOT_REFINED = "not_refined"
"""Kind of failure: plans exist, but no plan has hyperparameters that satisfy its conditions."""
BLOCKED = "blocked"
"""Kind of failure: every plan needs a movement that certainly hits a body that stays where it is."""
CLASS_UNKNOWN = "class_unknown"
"""Kind of failure: the goal requires a token to be a member of a class, but the membership is unknown."""
SAFETY = "safety"
"""Kind of failure: no plan satisfies the safety factors of the task, but the physical bounds do not exclude a plan."""

MESSAGES: Mapping[str, str] = {
    "unsolvable": "The planner has proven that no plan exists.",
    "not_found": "The planner found no plan, but has not proven that no plan exists.",
    "planner_crashed": "The planner crashed.",
    "plan_refused": "The planner returned an invalid plan, which was rejected.",
    CLASS_UNKNOWN: "It is unknown whether a plan exists, because the class of a token in the goal is unknown.",
    SAFETY: "No plan satisfies the safety factors of the task, but the physical bounds alone do not exclude a plan.",
    BLOCKED: "The planner has proven that no plan exists, because bodies block the movements of every plan.",
    NOT_REFINED: "Plans exist, but every plan that was found fails in the forward models of the blocks.",
}
"""Maps each kind of failure to a sentence for the user."""


@dataclass(frozen=True)
class PlannerFigures:
    """The planning engine, its run time, and how the plan was found.

    Attributes:
        name: name of the planning engine.
        seconds: total time of all attempts [s].
        way: description of how the plan was found.
        stages: maps each stage of planning to its time [s].
        fewest: what is known about the plan's number of actions; null if there is no plan or the makespan is minimised.
    """

    name: str
    seconds: float
    way: str = ""
    stages: Mapping[str, float] = field(default_factory=dict)
    fewest: Fewest | None = None

    @property
    def unproven(self) -> "PlannerFigures":
        """The figures without a proof that the plan has the fewest actions."""
        return self if self.fewest != "proven fewest" else replace(self, fewest="no shorter one found")


@dataclass(frozen=True)
class PlanningFailure:
    """The reason why planning found no plan.

    Attributes:
        kind: key of `MESSAGES`, ``time`` or ``memory`` for an exceeded limit, or a kind reported by the planner.
        detail: further details, e.g. why a plan was rejected, or empty.
    """

    kind: str
    detail: str = ""

    @classmethod
    def of(cls, reached: LimitReached) -> "PlanningFailure":
        """Return the failure for a limit that was reached."""
        return cls(reached.limit, str(reached))

    @property
    def message(self) -> str:
        """Description of the failure in one or two sentences."""
        return " ".join(filter(None, [MESSAGES.get(self.kind, ""), self.detail]))

    @property
    def status(self) -> Status:
        """Status of the outcome."""
        if self.kind in ("unsolvable", BLOCKED):
            return "unsolvable"
        return "limit" if self.kind in ("time", "memory") else "unknown"


@dataclass(frozen=True)
class Exclusion:
    """An excluded binding of a block. A plan with this binding fails for all values of the hyperparameters.

    Attributes:
        instance: block instance whose binding was excluded.
        shortfall: condition that no values of the hyperparameters satisfy.
        plan: plan that fails, with its hyperparameters and paths, or None if unknown.
    """

    instance: BlockInstance
    shortfall: Shortfall
    plan: TaskPlan | None = None

    @property
    def text(self) -> str:
        """Description of the binding and of the amount by which the condition fails."""
        roles = ", ".join(f"{role}={name}" for role, name in self.instance.roles.items())
        return f"{self.instance.block} with {roles}: {self.shortfall.text}"


@dataclass(frozen=True)
class PlanOutcome(Tabular):
    """The outcome of planning a task.

    Attributes:
        task: task that was planned. Its goal can have a choice.
        planner: figures of the planner.
        network: network that was used for planning.
        plan: plan of the task, or None. If a limit ended the planning, this is the best plan so far.
        failure: reason why there is no plan, or why the plan is not final; None if the plan is final.
        chosen: task with the ground goal that the plan achieves, or None if there is no plan.
        explanation: explanation of why the task has no plan, or None.
        refinement: plan with optimised hyperparameters, or None.
        excluded: bindings that were excluded before this plan was found, in the order of exclusion.
        closest_pairs: closest pair of bodies in each movement. Empty if the plan was not rolled out.
    """

    task: Task
    planner: PlannerFigures
    network: PlannedNetwork
    plan: TaskPlan | None = None
    failure: PlanningFailure | None = None
    chosen: Task | None = None
    explanation: Explanation | None = None
    refinement: RefinedPlan | None = None
    excluded: tuple[Exclusion, ...] = ()
    closest_pairs: tuple[ClosestPair, ...] = ()

    @property
    def rows(self) -> Rows:
        """Rows of the table that shows the plan, or the reasons why there is no plan."""
        found: Rows = [
            ("task", self.task.name),
            ("status", self.status),
            ("planner", self.planner.name),
            ("seconds", self.planner.seconds),
        ]
        if self.plan is not None:
            return [*found, ("makespan", f"{self.plan.makespan:.2f} s"), *self.plan.rows]
        if self.explanation is not None:
            return [*found, *self.explanation.rows]
        return [*found, ("no plan", self.failure and self.failure.message)]

    @property
    def status(self) -> Status:
        """Status of planning: a plan was found, no plan exists, the existence is unknown, or a limit was reached."""
        return "solved" if self.failure is None else self.failure.status

    @property
    def makespan(self) -> float | None:
        """End of the plan [s], or None if there is no plan."""
        return None if self.plan is None else self.plan.makespan

    @property
    def cost(self) -> float | None:
        """Number of PDDL actions of the plan, or None if there is no plan."""
        return None if self.plan is None else float(len(self.plan.actions))

    @property
    def order(self) -> tuple[tuple[str, str], ...]:
        """Pairs of instances. The second one starts only after the first one has reached its exit."""
        return () if self.plan is None else self.plan.order

    @property
    def steps(self) -> tuple[Step, ...]:
        """Steps of the plan. Empty if there is no plan."""
        return () if self.plan is None else tuple(self.plan.steps)

    @property
    def error(self) -> HybridTampError | None:
        """Exception that describes the failure of planning, or None if planning did not fail."""
        if self.failure is None:
            return None
        if self.status == "limit":
            return LimitReached(self.failure.message, limit=self.failure.kind)
        message = self.failure.message if self.explanation is None else self.explanation.text
        if self.failure.kind in (NOT_REFINED, BLOCKED):
            message = "\n".join([self.failure.message, *(f"  {each.text}" for each in self.excluded)])
        reasons = () if self.explanation is None else self.explanation.reasons
        probes = [reason.probe for reason in reasons if reason.probe]
        return NoPlan(message, proven=self.status == "unsolvable", kind=self.failure.kind, probes=probes)

    def required(self) -> TaskPlan:
        """Return the plan.

        Raises:
            NoPlan: if no plan exists or no plan was found.
            LimitReached: if a time or memory limit was reached.
        """
        if self.plan is None or self.failure is not None:
            raise self.error or NoPlan("no plan", proven=False, kind="not_found")
        return self.plan
