"""Search near the default point, for plans whose default hyperparameters violate conditions and that have no value.

All points that satisfy all conditions are then equally good. A single batch of candidates that differ from the default
point in one variable often contains such a point, and costs much less than a search over the whole space.
"""

from collections.abc import Collection

import numpy as np

from hybrid_tamp.midlevel.objective import Objective
from hybrid_tamp.midlevel.scores import Scores
from hybrid_tamp.motion.arrays import FloatArray

_HALVINGS = 11
"""Number of distances from the default on each side. The largest one is half of the variable's range."""


def sample_nearby(objective: Objective, instances: Collection[str]) -> tuple[FloatArray, Scores]:
    """Return candidates that differ from the default point in one variable of some instances, and their scores.

    The candidates are ordered by their distance from the default point. Candidates out of bounds are left out.

    Args:
        objective: objective of the plan.
        instances: names of the instances whose variables are changed.

    Returns:
        Points of shape ``(n, d)``, of which the first one is the default point, and their scores.
    """
    space = objective.space
    start = space.to_unit(space.default)
    points, offsets = [start], 0.5 ** np.arange(_HALVINGS, 0, -1)
    varying = set(space.varying)
    columns = [i for i, key in enumerate(objective.keys) if key[0] in instances and space.names[i] in varying]
    for offset in offsets:
        for column in columns:
            for other in (start[column] + offset, start[column] - offset):
                if 0.0 <= other <= 1.0:
                    points.append(np.where(np.arange(len(start)) == column, other, start))
    found = space.from_unit(np.array(points))
    found[0] = space.default
    return found, objective(found)
