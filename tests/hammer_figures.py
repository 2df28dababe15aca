"""Fig. 6: the best grasp of a hammer as a function of the final location of the block, for scripts/figure6 and tests.

The closed form describes a rigid hammer in SI units. A grasp is at the distance g from the end of the handle near the
head. The distance of the hand from the centre of mass is a = g - x(handle_to), and lambda = a + x(impact point):

    contact  = overlap of [g - w/2, g + w/2] with the handle [0, L], over w
    torque   = F (a + x(pushing point)), F = mu m_block 9.81, over the distance d = x - 0.1
    omega    = sqrt(2 tau phi / I), I = I_c + I_w + m (a + R)^2 + m_hand R^2
    v_tip    = omega (lambda + R), v_hand = omega R
    recoil   = P/M - P off (a m/M) / J, P = v_tip / (1/M + off^2/J), the speed of the hand after the blow, with
               M = m + m_hand, J = I_c + I_w + m m_hand a^2/M, off = lambda - a m/M
    J        = contact - 4 torque^2 d [push] + 0.2 v_tip^2 + weight v_hand [strike]

where R is the distance of the hand from the elbow. If several grasps have the same value, the grasp nearest to the
middle of the handle is chosen, because the middle is the default of the optimisers.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from ruamel.yaml import YAML
from texts import load_task_text

import hybrid_tamp
from hybrid_tamp.midlevel.action_by_action import optimise_apart
from hybrid_tamp.midlevel.objective import Evaluator, Objective, RollOut
from hybrid_tamp.midlevel.optimiser import Budget, Optimum
from hybrid_tamp.midlevel.predictions import Rollout
from hybrid_tamp.midlevel.registry import find_optimiser
from hybrid_tamp.midlevel.rollout import Rollouts
from hybrid_tamp.midlevel.scores import Scores
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray

PROBLEMS = Path(__file__).resolve().parent.parent / "problems"
FILES = {"push": "hammer_push", "strike": "hammer_strike", "both": "hammer_push_then_strike"}
LOCATIONS = tuple(round(0.1 * n, 1) for n in range(1, 11))
"""Final locations of the block [m]."""
START = 0.1
"""Initial location of the block [m]."""
TABLE = {
    "push": (3.0, 3.0, 3.0, 3.0, 2.9, 1.8, 1.1, 0.6, 0.2, 0.0),
    "strike": (12.0,) * 10,
    "both": (12.0, 11.6, 9.3, 8.0, 7.0, 6.2, 5.6, 5.0, 4.5, 4.0),
}
"""Expected best grasps [cm]. For the first location of `push`, all grasps with full contact are equally good."""
GRASP = ("GRASPING-1", "grasp_location")
LONG: Mapping[str, Any] = {
    "mass": 0.8,
    "inertia": [0.0004, 0.0042, 0.0042],
    "handle_from": [-0.22, 0, 0],
    "handle_to": [-0.01, 0, 0],
    "impact_point": [0.035, 0, -0.05],
    "pushing_point": [0.035, 0, 0.05],
}
"""Changes of the task file for a longer and heavier hammer."""
_LONG_PARTS: list[dict[str, Any]] = [
    {"kind": "box", "half_extents": [0.13, 0.012, 0.012], "position": [-0.10, 0, 0]},
    {"kind": "box", "half_extents": [0.02, 0.02, 0.035], "position": [0.035, 0, 0]},
    {"kind": "sphere", "radius": 0.0145, "position": [0.035, 0, 0.0355]},
    {"kind": "sphere", "radius": 0.0145, "position": [0.035, 0, -0.0355]},
]
_FIXED = {"STRIKING.target_x": 0.0, "STRIKING.target_y": 0.0, "PUSHING.speed": 0.15}


def figure_task(kind: str, x: float, *, radius: float = 0.0, hand_weight: float = -0.1, long: bool = False) -> Task:
    """Return a bundled task with the block's final location and the other hyperparameters fixed.

    Args:
        kind: ``push``, ``strike`` or ``both``.
        x: final location of the block [m].
        radius: distance of the hand from the elbow about which it swings [m].
        hand_weight: weight of the hand's speed in a strike.
        long: whether the task has the longer hammer.
    """
    yaml = YAML()
    file = yaml.load((PROBLEMS / f"{FILES[kind]}.yaml").read_text(encoding="utf-8"))
    moved = file["tokens"]["goal" if "goal" in file["tokens"] else "block"]
    moved["pose"]["position"][0] = x
    fixed = {"STRIKING.swing_radius": radius, **_FIXED, "PUSHING.beyond": 0.0}
    weights = {"STRIKING.hand_speed": hand_weight}
    file["midlevel"] = {"hyperparameters": fixed, "weights": weights}
    if long:
        file["tokens"]["hammer"]["properties"].update(LONG)
        file["tokens"]["hammer"]["shape"]["parts"] = _LONG_PARTS
        file["tokens"]["hammer"]["pose"]["position"][2] = 0.055
    text = StringIO()
    yaml.dump(file, text)
    return load_task_text(text.getvalue(), f"{FILES[kind]} at {x}")


@cache
def figure_plan(kind: str) -> TaskPlan:
    """Return the plan of a kind. The plan is the same for every final location, so a push may have the length zero."""
    found = hybrid_tamp.plan(figure_task(kind, 0.5)).required()
    return replace(found, instances=tuple(replace(instance, hyperparameters={}) for instance in found.instances))


@dataclass(frozen=True, eq=False)
class Scan:
    """Grasps ``(n,)`` [m] and their results."""

    grasps: FloatArray
    scores: Scores
    equal: float = 0.0
    """Largest difference of values between equally good grasps; it covers rounding."""
    middle: float | None = None
    """Middle of the handle [m]. If None, the grasps cover the whole handle."""

    @property
    def _good(self) -> NDArray[np.bool_]:
        met = self.scores.violation <= np.min(self.scores.violation)
        high = np.max(self.scores.value[met]) - self.equal
        return np.asarray(self.scores.best() | (met & (self.scores.value >= high)))

    @property
    def best(self) -> float:
        """The best grasp [m]. If several grasps are equally good, the grasp nearest to the middle of the handle."""
        middle = (self.grasps[0] + self.grasps[-1]) / 2 if self.middle is None else self.middle
        away = np.abs(self.grasps - middle)
        return float(self.grasps[np.argmin(np.where(self._good, away, np.inf))])

    @property
    def tie(self) -> tuple[float, float]:
        """The smallest and the largest of the equally good best grasps [m]."""
        best = self.grasps[self._good]
        return float(best.min()), float(best.max())


class Figure:
    """A task, and methods that search for its best grasp."""

    def __init__(self, task: Task, kind: str, roll_out: RollOut | None = None) -> None:
        self.task, self.plan = task, figure_plan(kind)
        self.objective = Objective(task, self.plan, roll_out or Rollouts(task, self.plan))
        self.part = self.objective.space.only([".".join(GRASP)])
        self.evaluate = Evaluator(self.objective, self.part)

    def sampled(self, count: int) -> Scan:
        """Evaluate `count` grasps along the whole handle."""
        grasps = np.linspace(self.part.lower[0], self.part.upper[0], count)
        return Scan(grasps, self.evaluate(grasps[:, None]))

    def searched(self, evaluations: int = 289) -> Optimum:
        """Find the best grasp with CMA-ES."""
        optimise = find_optimiser("cma", batch=48)
        return optimise(self.evaluate, self.part, Budget(evaluations), np.random.default_rng(self.task.seed))

    def apart(self) -> tuple[float, float]:
        """Return the best grasp [m] for GRASPING on its own, and the value of the whole plan with this grasp."""
        point = optimise_apart(self.evaluate.objective, self.part.names)
        grasp = point[self.objective.keys.index(GRASP)]
        return float(grasp), float(self.evaluate(np.array([[grasp]])).value[0])


def scores_of(task: Task, rollout: Rollout, blocks: Sequence[str], hand_weight: float | None = None) -> Scores:
    """Return scores from the measures of some blocks. `hand_weight` replaces the weight of the hand's speed."""
    value = np.zeros(len(rollout.value))
    for (instance, name), figure in rollout.figures.items():
        block = task.domain.block_by_name[instance.rpartition("-")[0]]
        measure = next(m for m in block.performance if m.name == name)
        weight = hand_weight if name == "hand_speed" and hand_weight is not None else measure.weight
        value = value + (weight * figure / measure.scale if block.name in blocks else 0.0)
    return Scores(rollout.violation, value)


def closed_form(
    task: Task, kind: str, x: float, grasps: FloatArray, radius: float = 0.0, recoil: bool = False
) -> FloatArray:
    """Return the values J of grasps ``(n,)`` [m] by the equations in the docstring of the module.

    If `recoil` is true, the speed of the hand after the blow counts as well.
    """
    hand, hammer, block = (task.token_by_name[name] for name in ("hand", "hammer", "block"))
    width, length = hand["contact_width"], hammer["handle_to"][0] - hammer["handle_from"][0]
    overlap = np.minimum(grasps + width / 2, length) - np.maximum(grasps - width / 2, 0.0)
    value = overlap / width
    away = grasps - hammer["handle_to"][0]
    measures = {m.name: m.weight for each in task.domain.blocks for m in each.performance}
    if kind != "strike":
        torque = block["friction"] * block["mass"] * 9.81 * (away + hammer["pushing_point"][0])
        value = value + measures["torque_work"] * torque**2 * (x - START)
    if kind != "push":
        inertia = hammer["inertia"][1] + hand["wrist_inertia"] + hammer["mass"] * (away + radius) ** 2
        omega = np.sqrt(2 * hand["strike_torque"] * hand["strike_angle"] / (inertia + hand["mass"] * radius**2))
        tip = omega * (away + hammer["impact_point"][0] + radius)
        hand_speed = omega * radius
        if recoil:
            own = hammer["inertia"][1] + hand["wrist_inertia"]
            hand_speed = np.maximum(hand_speed, np.abs(recoil_of(task, away, tip, own) - hand_speed))
        value = value + measures["tip_speed_squared"] * tip**2 + measures["hand_speed"] * hand_speed
    return np.asarray(value)


def recoil_of(task: Task, away: FloatArray, tip: FloatArray, own: float) -> FloatArray:
    """Return the speed [m/s] with which a blow at a tip speed [m/s] throws back a hand at rest.

    Args:
        task: task with a hand and a hammer.
        away: distance of the hand from the hammer's centre of mass ``(n,)`` [m].
        tip: speed of the impact point ``(n,)`` [m/s].
        own: moments of inertia of hammer and wrist together [kg m^2].
    """
    hand, hammer = task.token_by_name["hand"], task.token_by_name["hammer"]
    mass = hammer["mass"] + hand["mass"]
    behind = away * hammer["mass"] / mass
    inertia = own + hammer["mass"] * hand["mass"] / mass * away**2
    off = away + hammer["impact_point"][0] - behind
    impulse = tip / (1 / mass + off**2 / inertia)
    return np.asarray(np.abs(impulse * (1 / mass - off * behind / inertia)))


def closed_form_best(task: Task, kind: str, x: float, radius: float = 0.0, recoil: bool = False) -> float:
    """Return the best grasp [m] by the closed form, to 0.01 mm."""
    hammer = task.token_by_name["hammer"]
    grasps = np.linspace(0.0, hammer["handle_to"][0] - hammer["handle_from"][0], 15001)
    value = closed_form(task, kind, x, grasps, radius, recoil)
    return Scan(grasps, Scores(np.zeros(len(grasps)), value)).best
