"""The block STRIKING (paper, D8): a hammering movement in which the tool's impact point hits the top of an object.

First the hand winds up, i.e. swings the tool back. Then a constant torque swings the hand and the tool about an elbow
for a planned time. No feedback controls the speed of the swing. The impact knocks the hand and the tool back as one
body, and the hand raises the tool slightly above the object.

The property `impulse` of the struck object is the impulse within one control period (`impact`), in the forward model as
in physics.
"""

import numpy as np

from hybrid_tamp.authoring import (
    FLOOR,
    Binding,
    Block,
    Commands,
    ContinuousSystem,
    Course,
    Duration,
    FloatArray,
    Hyperparameter,
    Measure,
    Parameters,
    Policy,
    Slot,
    State,
    Token,
    cross,
    rotate,
    sample_times,
)
from hybrid_tamp.skills import (
    AT_REST,
    BODY,
    DAMPING_RATIO,
    IN_WORKSPACE,
    UP,
    HeldBody,
    Timetable,
    advance,
    attitude,
    dot,
    effective_mass,
    get_tokens,
    in_body,
    keep_on,
    knocked,
    lean,
    norm,
    point,
    point_velocity,
    straight_profile,
    sweep_held,
    turn_between,
    turning_rate,
    yaw,
)

from .arc import WINDING_UP, Arc, in_plane, on_arc
from .classes import DexterousHand, Strikable, Striker
from .feasibility import ABLE_TO_STRIKE, FIRM_ENOUGH, STRIKE_WITHIN_REACH
from .geometry import LEVEL, butt, top
from .impact import bounced, impulse_within_period
from .predicates import HELD, IN_STRIKE_STANCE, STANDS, STRUCK, TILTED_UP
from .swing import LARGEST_RADIUS

_ABOVE = 0.15
"""Angle above the horizontal to which the hand raises the tool after the impact [rad]."""
_RAISING_RATE = 20.0
"""Natural frequency of the servo that raises the tool [rad/s]."""
_SWEPT = 12
"""Number of poses of a swing in its course."""
_TOUCH = 1e-6


def _roles(binding: Binding) -> tuple[Token, Token, Token]:
    hand, tool, thing = get_tokens(binding, "hand", "tool", "object")
    return hand, tool, thing


def _policy(binding: Binding, start: State, parameters: Parameters) -> Policy:
    hand, tool, thing = _roles(binding)
    held, arc = HeldBody(hand, tool), Arc(binding, start, parameters.hyperparameters)
    origin, from_angle, direction = start[hand, "position"].copy(), lean(start, tool), yaw(start, tool)
    profile = straight_profile()
    turn = arc.beginning - from_angle
    taken = start[thing, "impulse"][..., 0].copy()
    over = attitude(direction, LEVEL - _ABOVE)
    above = arc.hand_at(np.full_like(turn, LEVEL - _ABOVE))

    def reference(elapsed: FloatArray) -> tuple[FloatArray, ...]:
        done, speed = advance(profile, elapsed, arc.winding)
        wound = attitude(direction, from_angle + done * turn)
        rate = (speed * turn)[..., None] * arc.axis
        return origin + done[..., None] * arc.way, speed[..., None] * arc.way, wound, rate

    timetable = Timetable(reference, start)

    def policy(elapsed: FloatArray, state: State) -> Commands:
        position, velocity, wound, rate = timetable(elapsed)
        before = keep_on(state, hand, position, velocity)
        hit = ((state[thing, "impulse"][..., 0] > taken) | (elapsed > arc.latest))[..., None]
        period = arc.period(elapsed)
        swinging = (period >= 0)[..., None]
        spin = dot(state[tool, "angular_velocity"], arc.axis)
        driven = arc.swing.driven(hand, period)
        moving = np.where(swinging, on_arc(state, hand, tool, arc, spin, driven), before)
        moving = np.where(hit, keep_on(state, hand, above, 0.0), moving)
        turning = np.where(swinging, in_plane(state, tool, arc.axis, driven), turning_rate(state, tool, wound, rate))
        turning = np.where(hit, _raising(state, tool, over), turning)
        return held.wrench(state, moving, turning)

    return policy


def _sweep(binding: Binding, start: State, parameters: Parameters) -> Course:
    """Return the course: a wind-up, the swing up to the planned impact, and the way back above the object."""
    hand, tool, _ = _roles(binding)
    arc = Arc(binding, start, parameters.hyperparameters)
    done, _ = advance(straight_profile(), sample_times(arc.winding), arc.winding)
    from_angle = lean(start, tool)
    swung = np.linspace(arc.beginning, LEVEL, _SWEPT)[1:]
    angles = np.concatenate([from_angle + done * (arc.beginning - from_angle), swung, [LEVEL - _ABOVE]])
    wound = start[hand, "position"] + done[:, None] * arc.way
    places = np.concatenate([wound, arc.hand_at(swung), arc.hand_at(np.array([LEVEL - _ABOVE]))])
    return Course.through(start, sweep_held(start, hand, tool, places, attitude(yaw(start, tool), angles)))


def _raising(state: State, tool: Token, wanted: FloatArray) -> FloatArray:
    """Return the angular acceleration ``(..., 3)`` [rad/s^2] that gently turns the tool to an orientation."""
    error = turn_between(state[tool, "orientation"], wanted)
    brake = 2.0 * DAMPING_RATIO * _RAISING_RATE * state[tool, "angular_velocity"]
    return np.asarray(_RAISING_RATE**2 * error - brake)


def _system(binding: Binding, start: State) -> ContinuousSystem:
    """Return the system in which the hand and the tool are one body. An inelastic impact on the object knocks it back.

    If the hand holds the tool near its head, the far end of the handle may hit the object or the floor first. This
    contact also ends the swing.
    """
    hand, tool, thing = _roles(binding)
    held, striking, back = HeldBody(hand, tool), np.asarray(tool["impact_point"]), butt(tool)
    halves = np.asarray(thing["half_extents"])

    def system(state: State, commands: Commands, dt: float) -> State:
        impact = point(state, tool, striking)
        velocity, spin = held.accelerated(state, commands, dt)
        sinking = -(velocity + cross(spin, impact - state[hand, "position"]))[..., 2]
        above = impact - top(state, thing)
        over = (np.abs(in_body(state, thing, impact))[..., :2] <= halves[:2]).all(axis=-1)
        hit = over & (above[..., 2] >= -_TOUCH) & (above[..., 2] <= sinking * dt) & (sinking > _TOUCH)
        share = np.where(hit, np.maximum(above[..., 2], 0.0) / np.where(hit, sinking * dt, 1.0), 1.0)
        end = point(state, tool, back)
        barred = (np.abs(in_body(state, thing, end)) < halves).all(axis=-1) | (end[..., 2] < 0)
        share = np.where(barred, 0.0, share)[..., None]
        body = held.whole(state)
        changes = held.placed(state, velocity * share, spin * share, dt)
        # During the impact, the grip yields by a few millimetres only.
        ratio = np.where(hit | barred, 0.0, held.grip_load(state, changes, dt))
        changes = held.loosened(changes, state, ratio)
        impulse = np.zeros_like(sinking)
        if (hit | barred).any():
            whole = (effective_mass(body, impact, UP) * sinking)[..., None] * UP
            recoil = knocked(body, velocity, spin, state[hand, "position"], impact, whole)
            changes |= bounced(changes, (hand, tool), hit, recoil)
            changes |= bounced(changes, (hand, tool), barred, (np.zeros(3), np.zeros(3)))
            within = impulse_within_period(hand, tool, state, body, impact, sinking, UP)
            impulse = np.where(hit, within, 0.0)
        changes[thing.name, "impulse"] = np.maximum(state[thing, "impulse"], impulse[..., None])
        return state.replace(changes)

    return system


def _tip_speed_squared(binding: Binding, state: State) -> FloatArray:
    """Return the squared speed ``(...)`` [m^2/s^2] of the impact point along the normal of the striking face."""
    _, tool, _ = _roles(binding)
    return np.asarray(tip_speed(state, tool) ** 2)


def tip_speed(state: State, tool: Token) -> FloatArray:
    """Return the speed ``(...)`` [m/s] of the impact point along the striking face's normal, the tool's -z axis."""
    normal = rotate(state[tool, "orientation"], -UP)
    return dot(point_velocity(state, tool, np.asarray(tool["impact_point"])), normal)


def _hand_speed(binding: Binding, state: State) -> FloatArray:
    return norm(state[_roles(binding)[0], "velocity"])


def _offset(name: str, lower: float, upper: float, description: str) -> Hyperparameter:
    return Hyperparameter(name, "m", lower, upper, lambda binding, state: np.asarray(0.0), description)


STRIKING = Block(
    name="STRIKING",
    slots=(Slot("hand", DexterousHand), Slot("object", Strikable), Slot("tool", Striker)),
    anchor="hand",
    entry=(
        ABLE_TO_STRIKE("hand", "tool", "object"),
        FIRM_ENOUGH("hand", "tool", "object"),
        STRIKE_WITHIN_REACH("hand", "tool", "object"),
        HELD("tool", "hand"),
        IN_STRIKE_STANCE("hand", "tool", "object"),
        AT_REST("object"),
    ),
    exit=(
        STRUCK("object"),
        HELD("tool", "hand"),
        ~STANDS("tool"),
        # Without this condition, the block could end as soon as the impact has stopped the tool, before the tool rises.
        TILTED_UP("tool"),
        AT_REST("object"),
        AT_REST("hand"),
        AT_REST("tool"),
    ),
    invariants=(HELD("tool", "hand"), IN_WORKSPACE("hand")),
    waived={AT_REST("object"): "the impact shakes the object"},
    writes={"hand": BODY, "tool": BODY, "object": ("velocity", "impulse")},
    allowed_contacts=(("hand", "tool"), ("tool", "object"), ("object", FLOOR)),
    hyperparameters=(
        _offset(
            "swing_radius",
            0.0,
            LARGEST_RADIUS,
            "distance between the hand and the elbow of its swing; at 0 the hand only turns",
        ),
        _offset("target_x", -0.03, 0.03, "forward offset of the target from the centre of the object's top"),
        _offset("target_y", -0.03, 0.03, "leftward offset of the target from the centre of the object's top"),
    ),
    duration=Duration(WINDING_UP, 10.0),
    policy=_policy,
    sweep=_sweep,
    system=_system,
    performance=(
        Measure(
            "tip_speed_squared",
            "m^2/s^2",
            0.2,
            peak=_tip_speed_squared,
            description="square of the largest speed of the impact point along the normal of the striking face",
        ),
        Measure("hand_speed", "m/s", -0.1, peak=_hand_speed, description="largest speed of the hand"),
    ),
    description="the hand swings the tool until the tool's impact point hits the top of the object",
)
