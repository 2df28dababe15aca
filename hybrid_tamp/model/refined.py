"""The refined plan: a task plan with jointly optimised hyperparameters (paper, Sec. II-D)."""

from collections.abc import Mapping
from dataclasses import dataclass

from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.predicate import Atom

GOAL = "goal"
"""Stands for the goal in place of the name of an instance."""

MeasureKey = tuple[str, str]
"""(instance, performance measure)."""


@dataclass(frozen=True)
class Tuned:
    """One hyperparameter of one instance, after optimisation.

    Attributes:
        instance: name of the instance.
        name: name of the hyperparameter.
        unit: its unit.
        lower: lower bound [unit].
        upper: upper bound [unit].
        default: its default value [unit].
        value: its value in the refined plan [unit].
        status: ``optimised``; ``fixed`` by its bounds; ``free``: without effect within its bounds and left at its
            default; or ``kept``: left at its default, because all conditions hold there and no measure can improve.
        moves: the performance measures that it affects, e.g. ``("STRIKING-1", "hand_speed")``.
        apart: its value if each action is optimised separately [unit], or None if that was not requested.
    """

    instance: str
    name: str
    unit: str
    lower: float
    upper: float
    default: float
    value: float
    status: str
    moves: tuple[MeasureKey, ...] = ()
    apart: float | None = None


@dataclass(frozen=True)
class Performance:
    """One performance measure of one instance.

    Attributes:
        instance: name of the instance.
        measure: name of the measure.
        unit: its unit.
        weight: value of one `scale` of the figure in a plan.
        scale: size of the figure that counts as one [unit].
        figure: expected figure [unit].
        measured: figure measured in a run [unit], or None.
    """

    instance: str
    measure: str
    unit: str
    weight: float
    scale: float
    figure: float
    measured: float | None = None


@dataclass(frozen=True)
class Shortfall:
    """The first condition of a plan that fails in the forward models.

    Attributes:
        where: name of the instance, or `GOAL`.
        atom: the condition.
        unit: unit of the margin.
        margin: its signed margin [unit].
    """

    where: str
    atom: Atom
    unit: str
    margin: float


@dataclass(frozen=True)
class Value:
    """The violation V (less is better) and then the value J (more is better) of hyperparameters."""

    violation: float
    value: float


@dataclass(frozen=True)
class Milestone:
    """A point of the convergence curve: the best V and J after a number of evaluations."""

    evaluations: int
    violation: float
    value: float


@dataclass(frozen=True)
class Retuning:
    """The result of further optimisation in physics, from the optimum of the forward models.

    Attributes:
        before: V and J of that optimum in physics.
        best: V and J of the final hyperparameters in physics, never worse.
        evaluations: number of runs in physics.
        seconds: time for it [s].
        stopped: why it ended.
        history: the convergence curve.
    """

    before: Value
    best: Value
    evaluations: int
    seconds: float
    stopped: str
    history: tuple[Milestone, ...]


@dataclass(frozen=True)
class RefinedPlan:
    """A task plan with optimised hyperparameters.

    Attributes:
        plan: the plan, its instances with all their hyperparameters.
        hyperparameters: all hyperparameters, in the order of the plan.
        performance: the expected performance measures.
        best: V and J of the plan by the forward models.
        defaults: V and J with the defaults.
        apart: V and J with each action optimised separately, in the plan's order; None if that was not requested.
        shortfall: the first condition that fails, in physics if the plan was optimised there; or None.
        expected: (instance or `GOAL`, atom) to the expected margin.
        optimiser: name of the optimiser; empty if there was nothing to optimise.
        evaluations: number of rollouts.
        seconds: time for it [s].
        stopped: why the optimiser ended.
        history: the convergence curve.
        physics: the result of further optimisation in physics, or None if that was not requested.
    """

    plan: TaskPlan
    hyperparameters: tuple[Tuned, ...]
    performance: tuple[Performance, ...]
    best: Value
    defaults: Value
    apart: Value | None
    shortfall: Shortfall | None
    expected: Mapping[tuple[str, Atom], float]
    optimiser: str
    evaluations: int
    seconds: float
    stopped: str
    history: tuple[Milestone, ...]
    physics: Retuning | None = None
