"""The block ROLLING (paper, D1): a hand pushes an object from behind until the object rests in a region."""

import numpy as np

from hybrid_tamp.authoring import ANY, Binding, FloatArray, Hyperparameter, State, Target
from hybrid_tamp.skills import FREE_TO_MOVE, Region, conditions, get_token, make_pushing

from .classes import Rollable
from .control_predicates import LARGE_ENOUGH, ROUGH_ENOUGH
from .predicates import INSIDE, LEVEL_WITH, LIES_ON_SIDE, ON_ROLLING_LINE, OUTSIDE, WITHIN_WORKSPACE
from .push import ROLL
from .resistance import ROLLABLE_FACTS, SMALLEST_DECELERATION, usual_deceleration
from .tumbling_predicates import FEASIBLE_TUMBLING, POSTURE

_FEASIBLE = conditions((FREE_TO_MOVE, LEVEL_WITH, LIES_ON_SIDE, ON_ROLLING_LINE, WITHIN_WORKSPACE, *ROLLABLE_FACTS))


def _usual(binding: Binding, state: State) -> FloatArray:
    return np.asarray(usual_deceleration(get_token(binding, "object")))


REACH_BEHIND, ROLLING = make_pushing(
    "ROLLING",
    ROLL,
    Rollable,
    targets=(Target("region", Region),),
    effects=(~INSIDE("object", ANY), INSIDE("object", "region")),
    facts=_FEASIBLE,
    # The reach has a fixed shape, which passes through large objects.
    lasting=(OUTSIDE("hand", "object"),),
    keeps=(
        (),
        # Rolling keeps the axis level and the centre on its line, so the feasibility facts do not change.
        # Objects that tumble are boxes, which do not roll.
        (LIES_ON_SIDE, ON_ROLLING_LINE, WITHIN_WORKSPACE, POSTURE, *FEASIBLE_TUMBLING, ROUGH_ENOUGH, LARGE_ENOUGH),
    ),
    hyperparameters=(
        Hyperparameter("speed", "m/s", 0.05, 0.6, lambda b, s: np.asarray(0.4), "largest speed"),
        Hyperparameter("deceleration", "m/s^2", SMALLEST_DECELERATION, 0.3, _usual, "final deceleration"),
    ),
    description="the hand pushes the object from behind until the object rests in the region",
)
