"""Refined plans, which are task plans with jointly optimised hyperparameters (paper, Sec. II-D)."""

from collections.abc import Mapping
from dataclasses import dataclass

from hybrid_tamp.model.closest_pair import ClosestPair
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.predicate import Atom

GOAL = "goal"
"""Text that stands for the goal where the name of an instance is expected."""
CLEAR = "clear"
"""Name of the condition that a movement keeps its distance from a body that takes no part in the movement.

Its margin is the least distance during the movement minus the distance to keep (`Limits.clearance`).
"""
CHECKED = "checked"
"""Name of the condition that the libraries for distances and paths could check a movement."""
ON_TOP = "on_top"
"""Name of the condition that a body which moves along the top of a table stays on this table."""

MeasureKey = tuple[str, str]
"""Pair of (instance, performance measure)."""


@dataclass(frozen=True)
class Tuned:
    """A hyperparameter of an instance after optimisation.

    Attributes:
        instance: name of the instance.
        name: name of the hyperparameter.
        unit: unit of the hyperparameter.
        lower: lower bound [unit].
        upper: upper bound [unit].
        default: default value [unit].
        value: value in the refined plan [unit].
        status: ``optimised`` if the optimiser chose the value. ``fixed`` if the bounds are equal. ``free`` if the value
            is the default because the hyperparameter has no effect. ``kept`` if the value is the default because all
            conditions hold and no performance measure can improve.
        moves: performance measures that the hyperparameter affects, e.g. ``("STRIKING-1", "hand_speed")``.
        apart: value if each action is optimised separately [unit], or None if not requested.
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
    """A performance measure of an instance. Its value in a plan is ``weight * figure / scale``.

    Attributes:
        instance: name of the instance.
        measure: name of the measure.
        unit: unit of the figure.
        weight: weight of the measure in the value of the plan.
        scale: divisor of the figure [unit].
        figure: expected figure [unit].
        measured: figure that was measured in a run [unit], or None.
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
        where: name of the instance whose condition fails, or `GOAL`.
        atom: condition that fails.
        unit: unit of the margin.
        margin: signed margin of the condition [unit].
        remark: why nothing avoids a collision. Empty for other conditions.
        place: where a collision is deepest, or where a body leaves a table [m]. None for other conditions.
        proven: whether the binding fails with all hyperparameters and paths. A failed search proves nothing.
        kept: distance that the movement must keep from the other body [m]. Zero for other conditions.
        wherever: atom that says that the moved object begins in a place. The binding then fails at every position in
            the place. None if the binding fails at the predicted position.
    """

    where: str
    atom: Atom
    unit: str
    margin: float
    remark: str = ""
    place: tuple[float, float, float] | None = None
    proven: bool = False
    kept: float = 0.0
    wherever: Atom | None = None

    @property
    def text(self) -> str:
        """The condition and the amount by which it fails, e.g. ``inside(drum, goal) fails by at least 0.1 m``."""
        where = "" if self.place is None else f" at ({', '.join(f'{each + 0.0:.2f}' for each in self.place)})"
        if self.atom.predicate == CLEAR:
            hit = f"{self._hit}{where}"
            return f"{hit}, {self.remark}" if self.remark else hit
        if self.atom.predicate == CHECKED:
            return f"{self.where} could not be checked: {self.remark}"
        if self.atom.predicate == ON_TOP:
            thing, table = self.atom.arguments
            return f"{thing} leaves the top of {table}: it reaches {-self.margin:.3g} m beyond the edge{where}"
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"{self.atom.text} fails by at least {-self.margin:.3g}{unit}"

    @property
    def _hit(self) -> str:
        """The bodies that come too near to each other, and their least distance."""
        moving, other = self.atom.arguments
        distance = self.margin + self.kept
        if distance < 0:
            return f"{moving} hits {other}, {-distance:.3g} m deep"
        if not self.margin:
            return f"{moving} meets {other}"
        return f"{moving} comes within {distance:.3g} m of {other} but must keep {self.kept:.3g} m"


@dataclass(frozen=True)
class Value:
    """The violation V of conditions and the performance J of a plan. V is minimised first, and then J is maximised."""

    violation: float
    value: float


@dataclass(frozen=True)
class Milestone:
    """A point of the convergence curve, with the best V and J after a number of evaluations."""

    evaluations: int
    violation: float
    value: float


@dataclass(frozen=True)
class Retuning:
    """The result of further optimisation in physics, which starts from the optimum of the forward models.

    Attributes:
        before: V and J of the forward models' optimum, evaluated in physics.
        best: V and J of the final hyperparameters, evaluated in physics. Never worse than `before`.
        evaluations: number of runs in physics.
        seconds: duration of the optimisation [s].
        stopped: reason why the optimisation stopped.
        history: convergence curve of the optimisation.
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
        plan: plan with a value for every hyperparameter of every instance. If all conditions hold, its times are those
            of the rollout.
        hyperparameters: all hyperparameters, in the order of the plan.
        performance: expected performance measures.
        best: V and J of the plan in the forward models.
        defaults: V and J with the default values of all hyperparameters.
        apart: V and J if each action is optimised separately, in the order of the plan. None if not requested.
        shortfall: first condition that fails in the forward models, or in physics after an optimisation in physics.
            None if all conditions hold.
        expected: maps pairs of (instance or `GOAL`, atom) to the expected margin.
        optimiser: name of the optimiser. Empty if there was nothing to optimise.
        evaluations: number of rollouts.
        seconds: duration of the optimisation [s].
        stopped: reason why the optimiser stopped.
        history: convergence curve of the optimisation.
        physics: result of further optimisation in physics, or None if not requested.
        closest_pairs: closest pair of bodies in each movement. Empty if the plan was not rolled out.
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
    closest_pairs: tuple[ClosestPair, ...] = ()
