"""The block ROLLING (paper, D1): a hand pushes an object from behind until the object rests in a region."""

import numpy as np

from hybrid_tamp.authoring import (
    ANY,
    FLOOR,
    Binding,
    Block,
    Duration,
    FloatArray,
    Hyperparameter,
    Slot,
    State,
    Target,
    Token,
)
from hybrid_tamp.skills import (
    AT_REST,
    BODY,
    HORIZONTAL,
    IN_WORKSPACE,
    MOTION,
    ReachGoal,
    Region,
    StaticEndEffector,
    get_tokens,
)

from .classes import Rollable
from .control_predicates import CLEAR_OF_FLOOR, CONTROL_PREDICATES
from .predicates import BEHIND, INSIDE, LIES_ON_SIDE, ON_ROLLING_LINE, OUTSIDE, WITHIN_WORKSPACE
from .push import ROLL
from .resistance import (
    ABLE_TO_ROLL,
    ROLLS,
    ROLLS_STEADILY,
    SMALLEST_DECELERATION,
    STOPS,
    TOUCHES_AXIS,
    WIDE_ENOUGH,
    usual_deceleration,
)
from .tumbling_predicates import FEASIBLE_TUMBLING, POSTURE

_FEASIBLE = (
    LIES_ON_SIDE("object"),
    ON_ROLLING_LINE("object", "region"),
    WITHIN_WORKSPACE("hand", "object", "region"),
    *(fact("hand", "object") for fact in (ROLLS_STEADILY, ABLE_TO_ROLL, TOUCHES_AXIS)),
    *(fact("object") for fact in (ROLLS, STOPS, WIDE_ENOUGH)),
)


def _roles(binding: Binding) -> tuple[Token, ...]:
    return get_tokens(binding, "hand", "object", "region")


def _usual(binding: Binding, state: State) -> FloatArray:
    return np.asarray(usual_deceleration(get_tokens(binding, "object")[0]))


REACH_BEHIND = ReachGoal(
    targets=(Target("object", Rollable), Target("region", Region)),
    position=ROLL.standby,
    entry=(*_FEASIBLE, AT_REST("object")),
    arrived=(BEHIND("hand", "object", "region"), IN_WORKSPACE("hand")),
    # The reach has a fixed shape, which passes through large objects.
    lasting=(AT_REST("object"), OUTSIDE("hand", "object")),
    # The reach ends above the floor, and passes over the object.
    keeps=(CLEAR_OF_FLOOR,),
)


def _outcome(binding: Binding, state: State) -> State:
    """Return the state with the object at the centre of the region and the hand behind the object."""
    hand, thing, region = _roles(binding)
    rolled = (state[region, "position"] - state[thing, "position"]) * HORIZONTAL
    return state.replace({(token.name, "position"): state[token, "position"] + rolled for token in (hand, thing)})


ROLLING = Block(
    name="ROLLING",
    slots=(Slot("hand", StaticEndEffector), Slot("object", Rollable)),
    anchor="object",
    targets=(Target("region", Region),),
    entry=(*_FEASIBLE, BEHIND("hand", "object", "region"), AT_REST("object")),
    exit=(~INSIDE("object", ANY), INSIDE("object", "region"), AT_REST("object"), AT_REST("hand"), IN_WORKSPACE("hand")),
    invariants=(IN_WORKSPACE("hand"),),
    writes={"hand": MOTION, "object": BODY},
    # Rolling keeps the axis level and the centre on its line, so the feasibility facts do not change.
    # Objects that tumble are boxes, which do not roll.
    keeps=(LIES_ON_SIDE, ON_ROLLING_LINE, WITHIN_WORKSPACE, OUTSIDE, POSTURE, *FEASIBLE_TUMBLING, *CONTROL_PREDICATES),
    allowed_contacts=(("hand", "object"), ("object", FLOOR)),
    hyperparameters=(
        Hyperparameter("distance", "m", 0.0, 10.0, lambda b, s: ROLL.line(b, s)[1], "distance that the object rolls"),
        Hyperparameter("speed", "m/s", 0.05, 0.6, lambda b, s: np.asarray(0.4), "largest speed"),
        Hyperparameter("deceleration", "m/s^2", SMALLEST_DECELERATION, 0.3, _usual, "final deceleration"),
    ),
    duration=Duration(0.2, 40.0),
    policy=ROLL.policy,
    system=ROLL.system,
    outcome=_outcome,
    description="the hand pushes the object from behind until the object rests in the region",
)
