"""The path of hand and tool in a strike: an arc about an elbow, from winding up to the impact."""

import numpy as np

from hybrid_tamp.authoring import Binding, FloatArray, Hyperparameters, State, Token, cross

from ..common.roles import get_tokens
from ..common.servos import DAMPING_RATIO, ORIENTATION_RATE
from ..common.vectors import UP
from .geometry import dot, hand_in_tool, heading, norm, side, strike_place, swing_angle, top
from .holding import keeping
from .swing import Swing, swing_of

WINDING_UP = 0.4
"""Time to wind up if the hand stays in its place [s]."""
_WINDING_SPEED = 0.4
"""Mean speed of the hand to where the swing begins [m/s]."""
_FOLLOWING_THROUGH = 1.5
"""Longest swing without an impact, as a multiple of the planned duration."""


def along(ahead: FloatArray, angle: FloatArray) -> FloatArray:
    """Return the direction ``(..., 3)`` from handle to head at an angle of the swing ``(...)`` [rad]."""
    return np.asarray(-np.sin(angle)[..., None] * ahead - np.cos(angle)[..., None] * UP)


class Arc:
    """The path of hand and tool in one strike: the elbow, and the angles where the swing begins and ends."""

    def __init__(self, binding: Binding, start: State, hyperparameters: Hyperparameters) -> None:
        hand, tool, thing = get_tokens(binding, "hand", "tool", "object")
        self.radius = np.asarray(hyperparameters["swing_radius"])
        self.ahead = heading(start, tool)
        across = cross(UP, self.ahead)
        x, y = (np.asarray(hyperparameters[name])[..., None] for name in ("target_x", "target_y"))
        target = top(start, thing) + x * self.ahead + y * across
        self.axis = across
        self.elbow = strike_place(start, hand, tool, target) - self.radius[..., None] * self.ahead
        self.swing: Swing = swing_of(hand, tool, hand_in_tool(start, hand, tool)[..., 0], self.radius)
        self.beginning = self.swing.wound_up(hand)
        self.way = self.hand_at(self.beginning) - start[hand, "position"]
        self.winding = WINDING_UP + norm(self.way) / _WINDING_SPEED
        self.latest = self.winding + _FOLLOWING_THROUGH * self.swing.duration(hand)

    def hand_at(self, angle: FloatArray) -> FloatArray:
        """Return the place of the hand ``(..., 3)`` [m] at an angle ``(...)`` [rad]."""
        return np.asarray(self.elbow + self.radius[..., None] * along(self.ahead, angle))


def on_arc(state: State, hand: Token, tool: Token, arc: Arc, spin: FloatArray, driven: FloatArray) -> FloatArray:
    """Return the acceleration ``(..., 3)`` [m/s^2] of a hand on its arc about the elbow."""
    arm = arc.radius[..., None] * along(arc.ahead, swing_angle(state, tool))
    velocity = spin[..., None] * cross(arc.axis, arm)
    acceleration = driven[..., None] * cross(arc.axis, arm) - (spin**2)[..., None] * arm
    return keeping(state, hand, arc.elbow + arm, velocity, acceleration)


def in_plane(state: State, tool: Token, axis: FloatArray, driven: FloatArray) -> FloatArray:
    """Return the angular acceleration ``(..., 3)`` [rad/s^2] of a swing that keeps to its plane."""
    spin = state[tool, "angular_velocity"]
    out_of_plane = spin - dot(spin, axis)[..., None] * axis
    back = ORIENTATION_RATE**2 * cross(side(state, tool), axis)
    return np.asarray(driven[..., None] * axis + back - 2.0 * DAMPING_RATIO * ORIENTATION_RATE * out_of_plane)
