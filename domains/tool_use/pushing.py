"""The block PUSHING (paper, D9), in which the head of an upright tool pushes an object in a straight line to a region.

First the tool moves until it touches the object. Then the tool pushes the object. Both movements are straight and have
the speed profile of human movements. The torque of the wrist is the friction force on the object times the height of
the hand above the pushing point.
"""

import numpy as np

from hybrid_tamp.authoring import (
    ANY,
    FLOOR,
    Binding,
    Block,
    Commands,
    ContinuousSystem,
    Course,
    Duration,
    FloatArray,
    Hyperparameter,
    Hyperparameters,
    Measure,
    Parameters,
    Policy,
    Slot,
    State,
    Target,
    Token,
    cross,
)
from hybrid_tamp.skills import (
    AT_REST,
    BODY,
    HORIZONTAL,
    IN_WORKSPACE,
    UP,
    HeldBody,
    Load,
    Region,
    Timetable,
    advance,
    attitude,
    dot,
    effective_mass,
    extent,
    get_tokens,
    heading,
    knocked,
    norm,
    point,
    side,
    steer,
    straight_profile,
    sweep_held,
)

from .classes import DexterousHand, Pushable, Pusher
from .feasibility import ABLE_TO_PUSH, PUSH_WITHIN_REACH, SQUARE_TO, resistance
from .geometry import way
from .predicates import HELD, IN_PUSH_STANCE, INSIDE, STANDS

_APPROACH = 0.8
"""Time until the tool touches the object [s]."""
_SHORTEST = 1.0
"""Shortest duration of a push [s]."""
_ASIDE = 0.01
"""Largest distance from the planned line while the tool steers an object that drifts off [m]."""
_CREEP = 0.01
"""Smallest speed at which the policy compensates the full friction force [m/s]."""
_TOUCH = 1e-6


def _roles(binding: Binding) -> tuple[Token, Token, Token, Token]:
    hand, tool, thing, region = get_tokens(binding, "hand", "tool", "object", "region")
    return hand, tool, thing, region


def _distance(binding: Binding, state: State, hyperparameters: Hyperparameters) -> FloatArray:
    """Return the distance of the push ``(...)`` [m]."""
    _, _, thing, region = _roles(binding)
    return np.maximum(way(state, thing, region)[1] + hyperparameters["beyond"], 0.0)


def _time(distance: FloatArray, hyperparameters: Hyperparameters) -> FloatArray:
    return np.maximum(distance / np.asarray(hyperparameters["speed"]), _SHORTEST)


def _gap(state: State, tool: Token, thing: Token, ahead: FloatArray) -> FloatArray:
    """Return the distance ``(...)`` [m] between the pushing point and the near side of the object."""
    face = point(state, tool, np.asarray(tool["pushing_point"]))
    return dot(state[thing, "position"] - face, ahead) - extent(state, thing, ahead)


def _policy(binding: Binding, start: State, parameters: Parameters) -> Policy:
    hand, tool, thing, region = _roles(binding)
    held, head, friction = HeldBody(hand, tool), np.asarray(tool["pushing_point"]), resistance(thing)
    ahead, _ = way(start, thing, region)
    across = cross(UP, ahead)
    axes = np.stack([ahead, across], axis=-2)
    upright = attitude(np.arctan2(ahead[..., 1], ahead[..., 0]), 0.0)
    face = point(start, tool, head)
    origin, line, gap = start[hand, "position"].copy(), start[thing, "position"].copy(), _gap(start, tool, thing, ahead)
    beside = dot(face - line, across)[..., None]
    distance = _distance(binding, start, parameters.hyperparameters)
    duration = _time(distance, parameters.hyperparameters)
    profile, still = straight_profile(), np.zeros(3)

    def reference(elapsed: FloatArray) -> tuple[FloatArray, ...]:
        nearer, approaching = advance(profile, elapsed, _APPROACH, gap)
        farther, speed = advance(profile, elapsed - _APPROACH, duration, distance)
        come, going = advance(profile, elapsed, _APPROACH)[0][..., None], approaching + speed
        position = origin + (nearer + farther)[..., None] * ahead
        resisting = friction * np.clip(speed / _CREEP, 0.0, 1.0)
        return come, position, going[..., None] * ahead, -resisting[..., None] * ahead

    timetable = Timetable(reference, start)

    def policy(elapsed: FloatArray, state: State) -> Commands:
        come, position, velocity, resisting = timetable(elapsed)
        remaining = distance - dot(state[thing, "position"] - line, ahead)
        way_off, drift = steer(state, thing, line, axes, remaining)
        position = position + come * (way_off[..., None] - beside) * across
        velocity = velocity + come * drift[..., None] * across
        load = Load(resisting, point(state, tool, head))
        return held.servo(state, (position, velocity), (upright, still), load)

    return policy


def _sweep(binding: Binding, start: State, parameters: Parameters) -> Course:
    """Return the course: the tool moves until it touches the object, and then moves on with the object."""
    hand, tool, thing, region = _roles(binding)
    ahead, _ = way(start, thing, region)
    beside = dot(point(start, tool, np.asarray(tool["pushing_point"])) - start[thing, "position"], cross(UP, ahead))
    came = _gap(start, tool, thing, ahead) * ahead - beside * cross(UP, ahead)
    pushed = _distance(binding, start, parameters.hyperparameters) * ahead
    still, upright = np.zeros(3), attitude(np.arctan2(ahead[1], ahead[0]), np.asarray(0.0))
    places = start[hand, "position"] + np.array([still, came, came + pushed])
    values = sweep_held(start, hand, tool, places, np.array([start[tool, "orientation"], upright, upright]))
    values[thing.name, "position"] = start[thing, "position"] + np.array([still, still, pushed])
    return Course.through(start, values, _ASIDE)


def _system(binding: Binding, start: State) -> ContinuousSystem:
    """Return the system in which the hand and the tool are one body. The object slides with friction and no bounce."""
    hand, tool, thing, _ = _roles(binding)
    held, head = HeldBody(hand, tool), np.asarray(tool["pushing_point"])
    friction, own_mass = resistance(thing), thing["mass"]

    def system(state: State, commands: Commands, dt: float) -> State:
        ahead, face = heading(state, tool), point(state, tool, head)
        velocity, spin = held.accelerated(state, commands, dt)
        closing = dot(velocity + cross(spin, face - state[hand, "position"]), ahead)
        braked = friction * dt
        sliding = dot(state[thing, "velocity"], ahead)
        alone = np.maximum(sliding - braked / own_mass, 0.0)
        gap = _gap(state, tool, thing, ahead)
        touches = (closing > alone) & (gap <= (closing - alone) * dt + _TOUCH)
        body = held.whole(state)
        mass = effective_mass(body, face, ahead)
        common = np.maximum((mass * closing + own_mass * sliding - braked) / (mass + own_mass), 0.0)
        impulse = np.where(touches, mass * (closing - common), 0.0)[..., None] * ahead
        velocity, spin = knocked(body, velocity, spin, state[hand, "position"], face, -impulse)
        slides = np.where(touches, common, alone)[..., None] * ahead
        changes = held.placed(state, velocity, spin, dt)
        changes = held.loosened(changes, state, held.grip_load(state, changes, dt, Load(-impulse / dt, face)))
        changes[thing.name, "velocity"] = slides
        changes[thing.name, "position"] = state[thing, "position"] + slides * dt
        return state.replace(changes)

    return system


def _torque_work(binding: Binding, state: State, commands: Commands) -> FloatArray:
    """Return the product ``(...)`` [N^2 m^3 / s] of the wrist's squared torque and the pushed object's speed."""
    hand, tool, thing, _ = _roles(binding)
    torque = dot(commands[hand.name, "torque"], side(state, tool))
    return np.asarray(torque**2 * norm(state[thing, "velocity"]))


def _ahead(binding: Binding, start: State) -> FloatArray:
    """Return the direction ``(3,)`` of the push."""
    _, _, thing, region = _roles(binding)
    return way(start, thing, region)[0]


def _outcome(binding: Binding, state: State) -> State:
    """Return the state with the object at the centre of the region and the tool in contact behind the object."""
    hand, tool, thing, region = _roles(binding)
    ahead, _ = way(state, thing, region)
    pushed = (state[region, "position"] - state[thing, "position"]) * HORIZONTAL
    came = pushed + _gap(state, tool, thing, ahead)[..., None] * ahead
    return state.replace(
        {
            (thing.name, "position"): state[thing, "position"] + pushed,
            (hand.name, "position"): state[hand, "position"] + came,
            (tool.name, "position"): state[tool, "position"] + came,
        }
    )


PUSHING = Block(
    name="PUSHING",
    slots=(Slot("hand", DexterousHand), Slot("object", Pushable), Slot("tool", Pusher)),
    anchor="hand",
    targets=(Target("region", Region),),
    entry=(
        ABLE_TO_PUSH("hand", "tool", "object"),
        SQUARE_TO("object", "region"),
        PUSH_WITHIN_REACH("hand", "tool", "object", "region"),
        HELD("tool", "hand"),
        IN_PUSH_STANCE("tool", "object", "region"),
        AT_REST("object"),
    ),
    exit=(
        ~INSIDE("object", ANY),
        INSIDE("object", "region"),
        HELD("tool", "hand"),
        ~STANDS("tool"),
        *map(AT_REST, ("object", "hand", "tool")),
    ),
    invariants=(HELD("tool", "hand"), IN_WORKSPACE("hand")),
    writes={"hand": BODY, "tool": BODY, "object": BODY},
    ends={"object": ("region",)},
    straight={"object": _ahead},
    allowed_contacts=(("hand", "tool"), ("tool", "object"), ("object", FLOOR)),
    hyperparameters=(
        # With wider bounds, a search would spend most of its time on pushes that end far outside the region.
        Hyperparameter("beyond", "m", -0.1, 0.1, lambda b, s: np.asarray(0.0), "distance beyond the region's centre"),
        Hyperparameter("speed", "m/s", 0.05, 0.4, lambda b, s: np.asarray(0.15), "mean speed of the push"),
    ),
    duration=Duration(_APPROACH, 40.0),
    policy=_policy,
    sweep=_sweep,
    system=_system,
    performance=(
        Measure(
            "torque_work",
            "N^2 m^3",
            -4.0,
            rate=_torque_work,
            description="integral of the wrist's squared torque over the pushed distance",
        ),
    ),
    outcome=_outcome,
    description="the tool pushes the object in a straight line until the object rests in the region",
)
