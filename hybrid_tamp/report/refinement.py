"""What the mid-level planner did, for programs."""

from collections.abc import Iterable, Mapping
from math import isfinite

from pydantic import Field

from hybrid_tamp.model.refined import Milestone, Performance, RefinedPlan, Retuning, Shortfall, Tuned, Value
from hybrid_tamp.report.entries import Document


class ValueEntry(Document):
    """How good a choice of hyperparameters is: the violation first, then the value."""

    violation: float | None = Field(
        description="sum of what conditions miss, each in units of its scale; 0 if all hold, null if not finite"
    )
    value: float | None = Field(description="weighted sum of the performance measures, maximised; null if not finite")


class HyperparameterEntry(Document):
    """One hyperparameter of one instance."""

    instance: str
    name: str
    unit: str
    lower: float
    upper: float
    default: float
    value: float
    status: str = Field(
        description="optimised; fixed by its bounds; free: without an effect over its bounds; or kept at its default"
    )
    moves: list[str] = Field(description="performance measures on which it has an effect")
    apart: float | None = Field(description="its value where each action is optimised on its own")


class PerformanceEntry(Document):
    """One performance measure of one instance."""

    instance: str
    measure: str
    unit: str
    weight: float
    predicted: float | None
    measured: float | None = None


class MilestoneEntry(Document):
    """The best after so many evaluations."""

    evaluations: int
    violation: float | None
    value: float | None


class RoundEntry(Document):
    """A plan that was given up, because no hyperparameters meet a condition of it."""

    block: str
    roles: dict[str, str]
    where: str
    atom: str
    margin: float
    unit: str


class PhysicsEntry(Document):
    """What came of going on in physics from the optimum that the forward models expect."""

    before: ValueEntry | None = Field(description="that optimum in physics, null if its run failed")
    best: ValueEntry | None = Field(description="the values that were kept, in physics, null if every run failed")
    evaluations: int
    seconds: float
    stopped: str
    history: list[MilestoneEntry]


class RefinementEntry(Document):
    """How the hyperparameters of a plan were optimised."""

    optimiser: str = Field(description="empty if there was nothing to optimise")
    evaluations: int
    seconds: float
    stopped: str
    best: ValueEntry
    defaults: ValueEntry
    apart: ValueEntry | None = Field(description="where each action is optimised on its own")
    hyperparameters: list[HyperparameterEntry]
    performance: list[PerformanceEntry]
    history: list[MilestoneEntry] = Field(description="the convergence curve")
    rounds: list[RoundEntry] = Field(description="plans that were given up before this one")
    physics: PhysicsEntry | None = Field(default=None, description="the last refinement, null if none was asked for")


GivenUp = Iterable[tuple[str, Mapping[str, str], Shortfall]]
"""Of each plan that was given up: the block to blame, its roles, and the condition that is not met."""


def refinement_entry(refined: RefinedPlan, given_up: GivenUp = ()) -> RefinementEntry:
    """Return what the mid-level planner did, as data."""
    return RefinementEntry(
        optimiser=refined.optimiser,
        evaluations=refined.evaluations,
        seconds=refined.seconds,
        stopped=refined.stopped,
        best=_value(refined.best),
        defaults=_value(refined.defaults),
        apart=None if refined.apart is None else _value(refined.apart),
        hyperparameters=[_hyperparameter(tuned) for tuned in refined.hyperparameters],
        performance=[_performance(each) for each in refined.performance],
        history=_history(refined.history),
        rounds=[
            RoundEntry(block=block, roles=dict(roles), **{**short.__dict__, "atom": short.atom.text})
            for block, roles, short in given_up
        ],
        physics=refined.physics and _physics(refined.physics),
    )


def _physics(retuning: Retuning) -> PhysicsEntry:
    values = {"before": retuning.before, "best": retuning.best}
    run = {name: _value(value) if isfinite(value.violation) else None for name, value in values.items()}
    return PhysicsEntry(**{**retuning.__dict__, **run, "history": _history(retuning.history)})


def _history(history: Iterable[Milestone]) -> list[MilestoneEntry]:
    return [
        MilestoneEntry(evaluations=m.evaluations, violation=_finite(m.violation), value=_finite(m.value))
        for m in history
    ]


def _value(value: Value) -> ValueEntry:
    return ValueEntry(violation=_finite(value.violation), value=_finite(value.value))


def _hyperparameter(tuned: Tuned) -> HyperparameterEntry:
    return HyperparameterEntry(**{**tuned.__dict__, "moves": [".".join(measure) for measure in tuned.moves]})


def _performance(each: Performance) -> PerformanceEntry:
    return PerformanceEntry(
        instance=each.instance,
        measure=each.measure,
        unit=each.unit,
        weight=each.weight,
        predicted=_finite(each.figure),
        measured=_finite(each.measured),
    )


def _finite(value: float | None) -> float | None:
    """JSON has neither infinity nor NaN."""
    return None if value is None or value != value or abs(value) == float("inf") else value
