"""Servos that control a hand's pose with its basic actions: a force and, for some hands, a torque."""

from collections.abc import Callable
from typing import Protocol

import numpy as np

from hybrid_tamp.model.control import Commands, ContinuousSystem
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_conjugate, quaternion_multiply
from hybrid_tamp.skills.roles import get_token

STIFFNESS = 8000.0
"""Stiffness of the position servo [N/m]."""
DAMPING_RATIO = 0.9
"""Ratio of the servos' damping to critical damping, for both position and orientation."""

ORIENTATION_RATE = 40.0
"""Natural frequency of the orientation servo [rad/s]."""

Servo = Callable[[State, FloatArray, FloatArray | float], Commands]
"""``servo(state, position, velocity)`` returns the commands that make a hand follow a reference ``(..., 3)``."""


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
    """Return the system of a hand without contacts, as a gravity-compensated point mass (semi-implicit Euler)."""
    hand = get_token(binding, "hand")

    def system(state: State, commands: Commands, dt: float) -> State:
        velocity = driven_velocity(hand, state, commands, dt)
        position = state[hand, "position"] + velocity * dt
        return state.replace({(hand.name, "velocity"): velocity, (hand.name, "position"): position})

    return system


def force_on(hand: Token, state: State, commands: Commands) -> FloatArray:
    """Return the commanded force on a hand ``(..., 3)`` [N], or zero if no force is commanded."""
    force = commands.get((hand.name, "force"))
    return np.zeros_like(state[hand, "position"]) if force is None else force


def driven_velocity(hand: Token, state: State, commands: Commands, dt: float) -> FloatArray:
    """Return the velocity ``(..., 3)`` [m/s] of a gravity-compensated hand without contacts after a time step [s]."""
    return np.asarray(state[hand, "velocity"] + force_on(hand, state, commands) / hand["mass"] * dt)
