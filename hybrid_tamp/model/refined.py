"""The refined plan: a task plan whose hyperparameters were optimised together (paper, Sec. II-D)."""

from collections.abc import Mapping
from dataclasses import dataclass

from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.predicate import Atom

GOAL = "goal"
"""Stands in place of an instance's name where a condition is one of the goal."""

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
        default: what it was by default [unit].
        value: what it is now [unit].
        status: ``optimised``; ``fixed`` by its bounds; ``free``, without an effect over its whole bounds, left at its
            default; or ``kept`` there because the defaults meet every condition and no measure could be improved.
        moves: the performance measures on which it has an effect, e.g. ``("STRIKING-1", "hand_speed")``.
        apart: its value where each action is optimised on its own [unit], or None if that was not asked.
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
    """One performance measure of one instance as it is expected.

    Attributes:
        instance: name of the instance.
        measure: name of the measure.
        unit: its unit.
        weight: what one `scale` of it adds to the value of the plan.
        scale: size of the figure that counts as one [unit].
        figure: what is expected [unit].
        measured: what a run measured [unit], or None.
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
    """The first condition of a plan that the forward models cannot meet.

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
    """How good a choice of hyperparameters is: V first, then J (smaller, larger is better)."""

    violation: float
    value: float


@dataclass(frozen=True)
class Milestone:
    """The best after so many evaluations: a point of the convergence curve."""

    evaluations: int
    violation: float
    value: float


@dataclass(frozen=True)
class Retuning:
    """What came of going on in physics from the optimum that the forward models expect.

    Attributes:
        before: V and J of that optimum in physics.
        best: V and J in physics of the values that were kept, never worse.
        evaluations: runs that were made.
        seconds: how long it took [s].
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
        hyperparameters: each of them, in the order of the plan.
        performance: the measures that are expected.
        best: V and J of the plan as it is now, by the forward models as all else that is expected.
        defaults: V and J with the defaults.
        apart: V and J with each action optimised on its own, in the plan's order; None if that was not asked.
        shortfall: the first condition that is not met, in physics where it was tried there, or None.
        expected: (instance or `GOAL`, atom) to the margin expected.
        optimiser: by which optimiser, or empty if there was nothing to optimise.
        evaluations: rollouts that were made.
        seconds: how long it took [s].
        stopped: why the optimiser ended.
        history: the convergence curve.
        physics: what came of going on in physics, or None if that was not asked.
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
