"""Servos that turn a hand's basic action, a force, into positions and velocities."""

import numpy as np

from hybrid_tamp.model.block import Commands
from hybrid_tamp.model.state import FloatArray, State
from hybrid_tamp.model.token import Token

STIFFNESS = 8000.0
"""Stiffness of the position servo [N/m]."""
DAMPING_RATIO = 0.9
"""Damping of the position servo as a share of critical damping."""


def damping(mass: float, stiffness: float = STIFFNESS) -> float:
    """Return the damping coefficient [N s/m] of a servo on a mass [kg]."""
    return float(2.0 * DAMPING_RATIO * np.sqrt(stiffness * mass))


def position_servo(hand: Token, state: State, position: FloatArray, velocity: FloatArray | float = 0.0) -> FloatArray:
    """Return the force ``(..., 3)`` [N] that drives a hand to a moving reference.

    Args:
        hand: a token with a mass.
        state: current state.
        position: reference position ``(..., 3)`` [m].
        velocity: reference velocity ``(..., 3)`` [m/s].
    """
    stiffness = STIFFNESS * (position - state[hand, "position"])
    return stiffness + damping(hand["mass"]) * (velocity - state[hand, "velocity"])


def free_motion(state: State, hand: Token, force: FloatArray, dt: float) -> State:
    """Advance a gravity-compensated hand that touches nothing, as a point mass (semi-implicit Euler)."""
    velocity = state[hand, "velocity"] + force / hand["mass"] * dt
    position = state[hand, "position"] + velocity * dt
    return state.replace({(hand.name, "velocity"): velocity, (hand.name, "position"): position})


def force_on(hand: Token, state: State, commands: Commands) -> FloatArray:
    """Return the commanded force on a hand ``(..., 3)`` [N]; zero where nothing is commanded."""
    return commands.get((hand.name, "force"), np.zeros_like(state[hand, "position"]))
