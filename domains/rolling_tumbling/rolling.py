"""The block ROLLING (paper, D1): a hand pushes an object from behind until the object rests in a region.

At a remaining distance e, the hand moves at the speed ``v = min(speed, sqrt(2 deceleration e))``, so that the object
stops after the chosen distance. A further force of the hand compensates the rolling resistance. Perpendicular to the
rolling direction, the hand follows the object's centre.
"""

import numpy as np

from hybrid_tamp.authoring import (
    ANY,
    FLOOR,
    GRAVITY,
    Binding,
    Block,
    Commands,
    ContinuousSystem,
    Duration,
    FloatArray,
    Hyperparameter,
    Hyperparameters,
    Parameters,
    Policy,
    Slot,
    State,
    Target,
    Token,
    cross,
    integrate,
)

from ..common.classes import Region, StaticEndEffector
from ..common.predicates import AT_REST, IN_WORKSPACE
from ..common.reaching import ReachGoal
from ..common.roles import BODY, MOTION, get_tokens
from ..common.servos import force_on, position_servo
from ..common.vectors import HORIZONTAL, UP, dot
from .classes import Rollable
from .control_predicates import CLEAR_OF_FLOOR, CONTROL_PREDICATES
from .geometry import STANDOFF, standby, touching, way, working_height
from .predicates import BEHIND, INSIDE, LIES_ON_SIDE, ON_ROLLING_LINE, OUTSIDE, WITHIN_WORKSPACE
from .resistance import (
    ABLE_TO_ROLL,
    ROLLS,
    ROLLS_STEADILY,
    SMALLEST_DECELERATION,
    STOPS,
    TOUCHES_AXIS,
    WIDE_ENOUGH,
    slowing,
    usual_deceleration,
)
from .tumbling_predicates import FEASIBLE_TUMBLING, POSTURE

_APPROACH_GAIN = 4.0
_APPROACH_SPEED = 0.15
_SPEED_RATE = 200.0
"""Rate at which the hand's speed converges to the wanted speed [1/s]."""
_FEASIBLE = (
    LIES_ON_SIDE("object"),
    ON_ROLLING_LINE("object", "region"),
    WITHIN_WORKSPACE("hand", "object", "region"),
    *(fact("hand", "object") for fact in (ROLLS_STEADILY, ABLE_TO_ROLL, TOUCHES_AXIS)),
    *(fact("object") for fact in (ROLLS, STOPS, WIDE_ENOUGH)),
)


def _roles(binding: Binding) -> tuple[Token, ...]:
    return get_tokens(binding, "hand", "object", "region")


def _standby_position(binding: Binding, state: State) -> FloatArray:
    return standby(state, *_roles(binding))


REACH_BEHIND = ReachGoal(
    targets=(Target("object", Rollable), Target("region", Region)),
    position=_standby_position,
    entry=(*_FEASIBLE, AT_REST("object")),
    arrived=(BEHIND("hand", "object", "region"), IN_WORKSPACE("hand")),
    # The reach has a fixed shape, which passes through large objects.
    lasting=(AT_REST("object"), OUTSIDE("hand", "object")),
    # The reach ends above the floor, and passes over the object.
    keeps=(CLEAR_OF_FLOOR,),
)


def _initial_distance(binding: Binding, state: State) -> FloatArray:
    _, thing, region = _roles(binding)
    return way(state, thing, region)[1]


def _usual(binding: Binding, state: State) -> FloatArray:
    return np.asarray(usual_deceleration(get_tokens(binding, "object")[0]))


def _expected(binding: Binding, state: State, hyperparameters: Hyperparameters) -> float:
    """Return the expected total duration [s] of the approach, the constant speed and the constant deceleration."""
    speed, braked = float(hyperparameters["speed"]), float(hyperparameters["deceleration"])
    distance = float(hyperparameters["distance"])
    braking = min(distance, speed**2 / (2 * braked))
    return float((distance - braking) / speed + np.sqrt(2 * braking / braked) + 0.5)


def _policy(binding: Binding, start: State, parameters: Parameters) -> Policy:
    hand, thing, region = _roles(binding)
    direction, _ = way(start, thing, region)
    origin = start[thing, "position"].copy()
    chosen = parameters.hyperparameters
    distance, speed, braked = (np.asarray(chosen[name]) for name in ("distance", "speed", "deceleration"))
    resistance = GRAVITY * thing["mass"] * thing["rolling_friction"] / thing["radius_of_rotation"]
    braking = np.minimum(1.5 * thing["mass"] * braked, resistance)
    rate, servo = _SPEED_RATE * hand["mass"], position_servo(hand)

    def policy(elapsed: FloatArray, state: State) -> Commands:
        centre = state[thing, "position"]
        remaining = distance - dot(centre - origin, direction)
        wanted = np.minimum(speed, np.sqrt(2 * braked * np.maximum(remaining, 0.0)))
        gap = dot(centre - state[hand, "position"], direction) - touching(state, hand, thing, direction)
        closing = np.where(remaining > 0, np.clip(_APPROACH_GAIN * gap, 0.0, _APPROACH_SPEED), 0.0)
        velocity = dot(state[hand, "velocity"], direction)
        push = rate * (wanted + closing - velocity)
        # While the object slows down, it needs a smaller force. Otherwise, a heavy object would lag behind the hand.
        bearing = resistance - np.where(wanted < speed, braking, 0.0)
        push = push + np.where((remaining > 0) & (gap < STANDOFF / 2), bearing, 0.0)
        # The hand controls its speed along the rolling direction, and its position perpendicular to that direction.
        beside = centre.copy()
        beside[..., 2] = working_height(state, hand, thing)
        across = servo(state, beside)
        across = across - dot(across, direction)[..., None] * direction
        return {(hand.name, "force"): across + push[..., None] * direction}

    return policy


def _system(binding: Binding, start: State) -> ContinuousSystem:
    """Return the system of a hand that pushes a solid cylinder. The cylinder rolls without slip and does not bounce."""
    hand, thing, region = _roles(binding)
    mass, radius = hand["mass"], thing["radius_of_rotation"]
    inertia = 1.5 * thing["mass"]  # m + I / R^2 of a solid cylinder
    whole = mass + inertia
    deceleration = slowing(thing)

    def system(state: State, commands: Commands, dt: float) -> State:
        direction, _ = way(state, thing, region)
        # The direction is fixed here, because `way` reverses the direction once the object has passed the region.
        moving = dot(state[thing, "velocity"], direction)
        direction = np.where((moving < -1e-9)[..., None], -direction, direction)
        pushed = touching(state, hand, thing, direction)

        hand_velocity = state[hand, "velocity"] + force_on(hand, state, commands) / mass * dt
        along = dot(hand_velocity, direction)
        rolling = np.maximum(0.0, np.abs(moving) - deceleration * dt)
        gap = dot(state[thing, "position"] - state[hand, "position"], direction) - pushed
        touches = (gap <= (along - rolling) * dt + 1e-6) & (along > rolling)
        common = np.maximum(0.0, (mass * along + inertia * rolling) / whole)
        rolling = np.where(touches, common, rolling)
        hand_velocity = hand_velocity + (np.where(touches, common, along) - along)[..., None] * direction

        velocity = rolling[..., None] * direction
        spin = cross(UP, velocity) / radius
        return state.replace(
            {
                (hand.name, "velocity"): hand_velocity,
                (hand.name, "position"): state[hand, "position"] + hand_velocity * dt,
                (thing.name, "velocity"): velocity,
                (thing.name, "position"): state[thing, "position"] + velocity * dt,
                (thing.name, "angular_velocity"): spin,
                (thing.name, "orientation"): integrate(state[thing, "orientation"], spin, dt),
            }
        )

    return system


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
        Hyperparameter("distance", "m", 0.0, 10.0, _initial_distance, "distance that the object rolls"),
        Hyperparameter("speed", "m/s", 0.05, 0.6, lambda b, s: np.asarray(0.4), "largest speed"),
        Hyperparameter("deceleration", "m/s^2", SMALLEST_DECELERATION, 0.3, _usual, "final deceleration"),
    ),
    duration=Duration(0.2, 40.0, _expected),
    policy=_policy,
    system=_system,
    outcome=_outcome,
    description="the hand pushes the object from behind until the object rests in the region",
)
