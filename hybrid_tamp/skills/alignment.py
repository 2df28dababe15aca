"""Directions along which hands lie at their places, and turns of hands towards these directions.

A hand is a cylinder along its z axis, so two opposite directions are equally good. A hand that can turn lies along the
nearer of the two. A hand that cannot turn keeps its orientation.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from hybrid_tamp.model.predicate import Value
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import (
    cross,
    normalized,
    quaternion_conjugate,
    quaternion_from_rotation_vector,
    quaternion_multiply,
    rotation_vector,
)
from hybrid_tamp.skills.classes import can_turn
from hybrid_tamp.skills.servos import TurnReference
from hybrid_tamp.skills.vectors import dot, norm, z_axis

ALIGNED = float(np.radians(6.0))
"""Largest angle between the axis of a hand that can turn and the line along which the hand lies [rad]."""


def nearer_direction(state: State, hand: Token, along: FloatArray) -> FloatArray:
    """Return the unit vector ``(..., 3)`` along a line, or its opposite if this is nearer to the axis of the hand."""
    return np.asarray(along * np.where(dot(along, z_axis(state, hand)) < 0.0, -1.0, 1.0)[..., None])


def angle_to(state: State, hand: Token, direction: FloatArray) -> FloatArray:
    """Return the angle ``(...)`` [rad] between the axis of a hand and a unit vector ``(..., 3)``."""
    present = z_axis(state, hand)
    return np.arctan2(norm(cross(present, direction)), dot(present, direction))


def turn_to(state: State, hand: Token, direction: FloatArray) -> FloatArray:
    """Return the orientation ``(..., 4)`` of a hand after the smallest turn of its axis to a unit vector ``(..., 3)``.

    The hand does not turn about its own axis. The direction must not be opposite to the axis.
    """
    present = z_axis(state, hand)
    # The half-way quaternion of the two unit vectors. Its scalar part is at least 1 for angles up to 90 degrees.
    turn = normalized(np.concatenate([cross(present, direction), 1.0 + dot(present, direction)[..., None]], axis=-1))
    return quaternion_multiply(turn, state[hand, "orientation"])


@dataclass(frozen=True)
class Alignment:
    """How a hand lies at a place.

    Attributes:
        along: ``along(state, hand, *values)`` returns the unit vector ``(..., 3)`` of the line along which the hand
            lies.
        most: largest angle between the axis of a hand and this line [rad].
    """

    along: Callable[..., FloatArray]
    most: float

    def direction(self, state: State, hand: Token, *values: Value) -> FloatArray:
        """Return the unit vector ``(..., 3)`` along the line that is nearer to the present axis of the hand."""
        return nearer_direction(state, hand, self.along(state, hand, *values))

    def angle(self, state: State, hand: Token, *values: Value) -> FloatArray:
        """Return the angle ``(...)`` [rad] between the present axis of the hand and the line, at most 90 degrees."""
        return angle_to(state, hand, self.direction(state, hand, *values))

    def orientation(self, state: State, hand: Token, *values: Value) -> FloatArray:
        """Return the orientation ``(..., 4)`` of the hand at its place."""
        if not can_turn(hand):
            return state[hand, "orientation"]
        return turn_to(state, hand, self.direction(state, hand, *values))

    def deviation(self, state: State, hand: Token, *values: Value) -> FloatArray:
        """Return the angle ``(...)`` [rad] by which the hand stays off the line, or zero for a hand that can turn."""
        return np.zeros(state.values.shape[:-1]) if can_turn(hand) else self.angle(state, hand, *values)

    def limit(self, margin: FloatArray, most: float, state: State, hand: Token, *values: Value) -> FloatArray:
        """Return a margin ``(...)`` of a place that is negative if a hand that can turn does not lie along the line.

        Args:
            margin: margin of the place ``(...)``.
            most: largest value of the margin.
            state: the state.
            hand: the hand.
            *values: further arguments of `along`.
        """
        if not can_turn(hand):
            return margin
        return np.minimum(margin, most * (1.0 - self.angle(state, hand, *values) / self.most))


def turn_along(
    begun: FloatArray, wanted: FloatArray, share: Callable[[FloatArray], tuple[FloatArray, FloatArray]]
) -> TurnReference:
    """Return the reference of a hand that turns from one orientation to another one about a fixed axis.

    Args:
        begun: first orientation ``(..., 4)``.
        wanted: last orientation ``(..., 4)``.
        share: maps the elapsed time ``(...)`` [s] to the share of the turn and the rate of this share [1/s].
    """
    begun = begun.copy()
    whole = rotation_vector(quaternion_multiply(wanted, quaternion_conjugate(begun)))

    def reference(elapsed: FloatArray) -> tuple[FloatArray, FloatArray]:
        done, rate = share(elapsed)
        turned = quaternion_from_rotation_vector(whole * done[..., None])
        return quaternion_multiply(turned, begun), whole * rate[..., None]

    return reference
