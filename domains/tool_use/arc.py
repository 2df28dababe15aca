"""The path of the hand and the tool in a strike: a wind-up, followed by an arc about an elbow."""

import numpy as np

from hybrid_tamp.authoring import CONTROL_PERIOD, Binding, FloatArray, Hyperparameters, State, Token, cross
from hybrid_tamp.skills import (
    DAMPING_RATIO,
    ORIENTATION_RATE,
    UP,
    dot,
    get_tokens,
    hand_in,
    heading,
    keep_on,
    lean,
    norm,
    side,
)

from .geometry import strike_place, top
from .swing import Swing, swing_of

WINDING_UP = 0.4
"""Shortest duration of a wind-up [s]."""
_WINDING_SPEED = 0.4
"""Distance of a wind-up divided by its duration beyond `WINDING_UP` [m/s]."""
_FOLLOWING_THROUGH = 1.5
"""Longest duration of a swing that misses its target, divided by the planned duration."""


def along(ahead: FloatArray, angle: FloatArray) -> FloatArray:
    """Return the direction ``(..., 3)`` from the handle to the head at a swing angle ``(...)`` [rad]."""
    return np.asarray(-np.sin(angle)[..., None] * ahead - np.cos(angle)[..., None] * UP)


class Arc:
    """The path of the hand and the tool in one strike. A wind-up is followed by a swing about an elbow."""

    def __init__(self, binding: Binding, start: State, hyperparameters: Hyperparameters) -> None:
        hand, tool, thing = get_tokens(binding, "hand", "tool", "object")
        self.radius = np.asarray(hyperparameters["swing_radius"])
        self.ahead = heading(start, tool)
        across = cross(UP, self.ahead)
        x, y = (np.asarray(hyperparameters[name])[..., None] for name in ("target_x", "target_y"))
        target = top(start, thing) + x * self.ahead + y * across
        self.axis = across
        self.elbow = strike_place(start, hand, tool, target) - self.radius[..., None] * self.ahead
        self.swing: Swing = swing_of(hand, tool, hand_in(start, hand, tool)[..., 0], self.radius)
        self.beginning = self.swing.wound_up(hand)
        self.way = self.hand_at(self.beginning) - start[hand, "position"]
        shortest = (WINDING_UP + norm(self.way) / _WINDING_SPEED) / CONTROL_PERIOD
        # The swing begins half a period after the wind-up ends, so rounding never decides in which period it begins.
        self.winding = (np.ceil(shortest) - 0.5) * CONTROL_PERIOD
        self.latest = self.winding + _FOLLOWING_THROUGH * self.swing.duration(hand)

    def period(self, elapsed: FloatArray) -> FloatArray:
        """Return the number ``(...)`` of control periods since the beginning of the swing, negative before it."""
        return np.asarray(np.floor((elapsed - self.winding) / CONTROL_PERIOD))

    def hand_at(self, angle: FloatArray) -> FloatArray:
        """Return the position ``(..., 3)`` [m] of the hand at a swing angle ``(...)`` [rad]."""
        return np.asarray(self.elbow + self.radius[..., None] * along(self.ahead, angle))


def on_arc(state: State, hand: Token, tool: Token, arc: Arc, spin: FloatArray, driven: FloatArray) -> FloatArray:
    """Return the acceleration ``(..., 3)`` [m/s^2] that keeps a hand on its arc about the elbow.

    `spin` [rad/s] and `driven` [rad/s^2] are the angular speed and angular acceleration of the swing, both ``(...)``.
    """
    arm = arc.radius[..., None] * along(arc.ahead, lean(state, tool))
    velocity = spin[..., None] * cross(arc.axis, arm)
    acceleration = driven[..., None] * cross(arc.axis, arm) - (spin**2)[..., None] * arm
    return keep_on(state, hand, arc.elbow + arm, velocity, acceleration)


def in_plane(state: State, tool: Token, axis: FloatArray, driven: FloatArray) -> FloatArray:
    """Return the angular acceleration ``(..., 3)`` [rad/s^2] that swings a tool in the plane of the swing."""
    spin = state[tool, "angular_velocity"]
    out_of_plane = spin - dot(spin, axis)[..., None] * axis
    back = ORIENTATION_RATE**2 * cross(side(state, tool), axis)
    return np.asarray(driven[..., None] * axis + back - 2.0 * DAMPING_RATIO * ORIENTATION_RATE * out_of_plane)
