"""Servos that control a hand's pose with its basic actions: a force and, for some hands, a torque."""

from collections.abc import Callable, Mapping
from typing import Protocol

import numpy as np

from hybrid_tamp.model.control import Commands, ContinuousSystem, Policy
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import integrate, quaternion_conjugate, quaternion_multiply, rotation_vector
from hybrid_tamp.skills.classes import can_turn
from hybrid_tamp.skills.roles import get_token

STIFFNESS = 8000.0
"""Stiffness of the position servo [N/m]."""
DAMPING_RATIO = 0.9
"""Ratio of the servos' damping to critical damping, for both position and orientation."""

ORIENTATION_RATE = 40.0
"""Natural frequency of the orientation servo [rad/s]."""

WRIST_STIFFNESS = 100.0
"""Stiffness of the wrist of a hand that presses on an object [N m/rad]. Friction twists a softer hand."""
_FASTEST_WRIST = 150.0
"""Largest natural frequency of a wrist's servo [rad/s]. Above 249 rad/s, the servo would be unstable at 240 Hz."""

Servo = Callable[[State, FloatArray, FloatArray | float], Commands]
"""``servo(state, position, velocity)`` returns the commands that make a hand follow a reference ``(..., 3)``."""


TurnReference = Callable[[FloatArray], tuple[FloatArray, FloatArray | float]]
"""Maps the elapsed time ``(...)`` [s] to an orientation ``(..., 4)`` and an angular velocity ``(..., 3)`` [rad/s]."""


class ForceServo(Protocol):
    """A function that computes the force with which a hand follows a moving reference."""

    def __call__(self, state: State, position: FloatArray, velocity: FloatArray | float = 0.0) -> FloatArray:
        """Return the force ``(..., 3)`` [N].

        Args:
            state: current state.
            position: reference position ``(..., 3)`` [m].
            velocity: reference velocity ``(..., 3)`` [m/s].
        """
        ...


def damping(mass: float, stiffness: float = STIFFNESS) -> float:
    """Return the damping coefficient [N s/m] of a position servo for a mass [kg] and a stiffness [N/m]."""
    return float(2.0 * DAMPING_RATIO * np.sqrt(stiffness * mass))


def position_servo(hand: Token) -> ForceServo:
    """Return the feedback law for the force with which a hand follows a moving reference."""
    brake = damping(hand["mass"])

    def force(state: State, position: FloatArray, velocity: FloatArray | float = 0.0) -> FloatArray:
        stiffness = STIFFNESS * (position - state[hand, "position"])
        return stiffness + brake * (velocity - state[hand, "velocity"])

    return force


def turn_between(orientation: FloatArray, wanted: FloatArray) -> FloatArray:
    """Return the rotation vector ``(..., 3)`` [rad] of a small rotation from `orientation` to `wanted`."""
    error = quaternion_multiply(wanted, quaternion_conjugate(orientation))
    return np.asarray(np.copysign(2.0, error[..., 3:]) * error[..., :3])


def turning_rate(state: State, token: Token, wanted: FloatArray, velocity: FloatArray | float = 0.0) -> FloatArray:
    """Return the angular acceleration ``(..., 3)`` [rad/s^2] that turns a token towards a reference orientation.

    Args:
        state: current state.
        token: the token that turns.
        wanted: reference orientation ``(..., 4)``.
        velocity: reference angular velocity ``(..., 3)`` [rad/s].
    """
    error = turn_between(state[token, "orientation"], wanted)
    brake = 2.0 * DAMPING_RATIO * ORIENTATION_RATE * (velocity - state[token, "angular_velocity"])
    return np.asarray(ORIENTATION_RATE**2 * error + brake)


def turn_wrists(policy: Policy, references: Mapping[Token, TurnReference]) -> Policy:
    """Return a policy that also turns hands. Hands that cannot turn are ignored.

    The torque ``(..., 3)`` [N m] is I (omega^2 e + 2 zeta omega (w' - w)), where e is the rotation vector to the
    reference, w' - w is the error of the angular velocity, and I is the inertia of the wrist. The stiffness I omega^2
    is `WRIST_STIFFNESS`, but omega has an upper limit.

    Args:
        policy: policy that moves the hands.
        references: maps each hand to its reference.
    """
    wrists = [(hand, read, *_wrist_gains(hand)) for hand, read in references.items() if can_turn(hand)]
    if not wrists:
        return policy

    def turning(elapsed: FloatArray, state: State) -> Commands:
        commands = policy(elapsed, state)
        for hand, read, stiffness, brake in wrists:
            wanted, spin = read(elapsed)
            error = rotation_vector(quaternion_multiply(wanted, quaternion_conjugate(state[hand, "orientation"])))
            commands[hand.name, "torque"] = stiffness * error + brake * (spin - state[hand, "angular_velocity"])
        return commands

    return turning


def keep_orientation(orientation: FloatArray) -> TurnReference:
    """Return the reference of a hand that keeps an orientation ``(..., 4)``."""
    kept = orientation.copy()
    return lambda elapsed: (kept, 0.0)


def _wrist_gains(hand: Token) -> tuple[float, float]:
    """Return the stiffness [N m/rad] and the damping coefficient [N m s/rad] of the servo of a hand's wrist."""
    inertia = float(hand["wrist_inertia"])
    rate = min(float(np.sqrt(WRIST_STIFFNESS / inertia)), _FASTEST_WRIST)
    return inertia * rate**2, inertia * 2.0 * DAMPING_RATIO * rate


def hand_servo(hand: Token, start: State) -> Servo:
    """Return a servo for all basic actions of a hand. A hand with a wrist torque keeps its initial orientation.

    For a token without basic actions, the servo returns no commands. The arguments of the servo are the state, a
    position ``(..., 3)`` [m] and a velocity ``(..., 3)`` [m/s].
    """
    actions = {action.name for action in hand.basic_actions}
    force = position_servo(hand) if "force" in actions else None
    upright = start[hand, "orientation"].copy()

    def servo(state: State, position: FloatArray, velocity: FloatArray | float) -> Commands:
        commands: Commands = {}
        if force is not None:
            commands[hand.name, "force"] = force(state, position, velocity)
        if "torque" in actions:
            commands[hand.name, "torque"] = hand["wrist_inertia"] * turning_rate(state, hand, upright)
        return commands

    return servo


def hand_system(binding: Binding, start: State) -> ContinuousSystem:
    """Return the system of a hand without contacts: a gravity-compensated mass that turns (semi-implicit Euler)."""
    hand = get_token(binding, "hand")

    def system(state: State, commands: Commands, dt: float) -> State:
        velocity = driven_velocity(hand, state, commands, dt)
        position = state[hand, "position"] + velocity * dt
        changes = {(hand.name, "velocity"): velocity, (hand.name, "position"): position}
        return state.replace(changes | turn_hand(hand, state, commands, dt))

    return system


def turn_hand(hand: Token, state: State, commands: Commands, dt: float) -> dict[tuple[str, str], FloatArray]:
    """Return a hand's new orientation ``(..., 4)`` and angular velocity ``(..., 3)`` [rad/s] after a time step [s].

    The result is empty for a hand without a wrist. Contacts do not turn the hand in this model.
    """
    if not can_turn(hand):
        return {}
    torque = commands.get((hand.name, "torque"))
    spin = state[hand, "angular_velocity"]
    if torque is not None:
        spin = spin + torque / hand["wrist_inertia"] * dt
    orientation = integrate(state[hand, "orientation"], spin, dt)
    return {(hand.name, "angular_velocity"): spin, (hand.name, "orientation"): orientation}


def force_on(hand: Token, state: State, commands: Commands) -> FloatArray:
    """Return the commanded force on a hand ``(..., 3)`` [N], or zero if no force is commanded."""
    force = commands.get((hand.name, "force"))
    return np.zeros_like(state[hand, "position"]) if force is None else force


def driven_velocity(hand: Token, state: State, commands: Commands, dt: float) -> FloatArray:
    """Return the velocity ``(..., 3)`` [m/s] of a gravity-compensated hand without contacts after a time step [s]."""
    return np.asarray(state[hand, "velocity"] + force_on(hand, state, commands) / hand["mass"] * dt)
