"""The outcome of planning a task: the plan and its origin, or why there is none."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from hybrid_tamp.errors import HybridTampError, LimitReached, NoPlan
from hybrid_tamp.model.explanation import Explanation
from hybrid_tamp.model.plan import BlockInstance, Step, TaskPlan
from hybrid_tamp.model.planned_network import PlannedNetwork
from hybrid_tamp.model.refined import RefinedPlan, Shortfall
from hybrid_tamp.model.tables import Rows, Tabular
from hybrid_tamp.model.task import Task

Status = Literal["solved", "unsolvable", "unknown", "limit"]

NOT_REFINED = "not_refined"
"""The kind of failure if plans exist, but no hyperparameters satisfy any of them."""
CLASS_UNKNOWN = "class_unknown"
"""The kind of failure if the goal needs a class and it is unknown whether a token is a member of it."""

MESSAGES: Mapping[str, str] = {
    "unsolvable": "No plan exists; the planner has proven it.",
    "not_found": "The planner found no plan, but has not proven that there is none.",
    "planner_crashed": "The planner crashed.",
    "plan_refused": "The planner returned a wrong plan, which was refused.",
    CLASS_UNKNOWN: "It is unknown whether a plan exists: the goal names a token whose class has not been tried.",
    NOT_REFINED: "Plans exist, but the forward models of the blocks cannot carry out any that was found.",
}
"""Kind of failure to the sentence that explains it."""


@dataclass(frozen=True)
class PlannerFigures:
    """The planning engine, its time, and how it found the plan.

    Attributes:
        name: name of the engine.
        seconds: time of all attempts together [s].
        way: how the plan was found.
        stages: stage of planning to the time it took [s].
    """

    name: str
    seconds: float
    way: str = ""
    stages: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class PlanningFailure:
    """Why planning gave no plan.

    Attributes:
        kind: a key of `MESSAGES`; ``time`` or ``memory`` if that limit was reached; or the kind that the planner gave.
        detail: more detail, e.g. why a plan was refused; or empty.
    """

    kind: str
    detail: str = ""

    @property
    def message(self) -> str:
        """The failure in one or two sentences."""
        return " ".join(filter(None, [MESSAGES.get(self.kind, ""), self.detail]))

    @property
    def status(self) -> Status:
        """The status of the outcome."""
        if self.kind == "unsolvable":
            return "unsolvable"
        return "limit" if self.kind in ("time", "memory") else "unknown"


@dataclass(frozen=True)
class Exclusion:
    """A binding of a block that was excluded because no hyperparameters satisfy the plan that contains it.

    Attributes:
        instance: the instance whose binding was excluded.
        shortfall: the condition that no hyperparameters satisfy.
    """

    instance: BlockInstance
    shortfall: Shortfall

    @property
    def text(self) -> str:
        """The binding and by how much the condition fails."""
        roles = ", ".join(f"{role}={name}" for role, name in self.instance.roles.items())
        short = self.shortfall
        unit = "" if short.unit == "1" else f" {short.unit}"
        return f"{self.instance.block} with {roles}: {short.atom.text} fails by {-short.margin:.3g}{unit} at best"


@dataclass(frozen=True)
class PlanOutcome(Tabular):
    """The outcome of planning a task.

    Attributes:
        task: the task; if its goal leaves a choice, `chosen` has the ground goal that the plan reaches.
        planner: figures of the planner.
        network: the network that was planned on.
        plan: the plan, or None.
        failure: why there is no plan, or None.
        chosen: the task with the ground goal that the plan reaches; None if there is no plan.
        explanation: why the task has no plan, or None if it was not explained.
        refinement: how the hyperparameters of the plan were optimised, or None.
        excluded: the bindings that were excluded before this plan, in order.
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

    @property
    def rows(self) -> Rows:
        """The outcome as a table: the steps of the plan, or why there is none."""
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
        """Whether there is a plan, there provably is none, it is unknown, or a limit was reached."""
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
    def steps(self) -> tuple[Step, ...]:
        """The steps of the plan; empty if there is no plan."""
        return () if self.plan is None else tuple(self.plan.steps)

    @property
    def error(self) -> HybridTampError | None:
        """Why there is no plan, as an exception; None if there is one."""
        if self.failure is None:
            return None
        if self.status == "limit":
            return LimitReached(self.failure.message, limit=self.failure.kind)
        message = self.failure.message if self.explanation is None else self.explanation.text
        if self.failure.kind == NOT_REFINED:
            message = "\n".join([self.failure.message, *(f"  {each.text}" for each in self.excluded)])
        reasons = () if self.explanation is None else self.explanation.reasons
        probes = [reason.probe for reason in reasons if reason.probe]
        return NoPlan(message, proven=self.status == "unsolvable", kind=self.failure.kind, probes=probes)

    def required(self) -> TaskPlan:
        """Return the plan.

        Raises:
            NoPlan: there is none, or none was found.
            LimitReached: the planner reached a limit.
        """
        if self.plan is None:
            raise self.error or NoPlan("no plan", proven=False, kind="not_found")
        return self.plan
