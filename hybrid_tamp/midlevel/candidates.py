"""The few candidates that are left in the end, the whole plan rolled out for each of them."""

from dataclasses import dataclass

import numpy as np

from hybrid_tamp.midlevel.objective import Objective
from hybrid_tamp.midlevel.rollout import Rollout
from hybrid_tamp.model.refined import Value
from hybrid_tamp.motion.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Candidates:
    """A few candidates: the defaults first, and each action optimised on its own last.

    Attributes:
        rollout: what comes of them.
        points: the candidates, shape ``(n, d)``.
        chosen: the best of them.
    """

    rollout: Rollout
    points: FloatArray
    chosen: int

    @classmethod
    def of(cls, objective: Objective, *points: FloatArray) -> "Candidates":
        """Roll the whole plan out for points ``(d,)``, and choose the best."""
        rollout = objective.rollout(np.array(points))
        chosen = np.lexsort((-rollout.value, objective.missed(rollout)))[0]
        return cls(rollout, np.array(points), int(chosen))

    @property
    def point(self) -> FloatArray:
        """The best, shape ``(d,)``."""
        return np.asarray(self.points[self.chosen])

    @property
    def violation(self) -> float:
        """V of the best."""
        return self.value(self.chosen).violation

    def value(self, candidate: int) -> Value:
        """Return V and J of one."""
        return Value(float(self.rollout.violation[candidate]), float(self.rollout.value[candidate]))

    def replace_best(self, objective: Objective, point: FloatArray) -> "Candidates":
        """Return these candidates with a point ``(d,)`` as the best, in place of the optimum that was found."""
        points = np.vstack([self.points[:1], point, self.points[2:]])
        return Candidates(objective.rollout(points), points, 1)
