"""The speed and impulse, in closed form, of a tool that a constant torque swings through an angle."""

from dataclasses import dataclass

import numpy as np

from hybrid_tamp.authoring import CONTROL_PERIOD, GRAVITY, FloatArray, Token

from .geometry import LEVEL

LARGEST_RADIUS = 0.3
"""Largest distance between the hand and the elbow [m]."""
_CELLS = 256
"""Number of intervals into which `largest_impulse` divides each range."""
_COASTING = 0.2
"""Number of control periods in which the tool coasts at its final speed before the planned impact."""


@dataclass(frozen=True, eq=False)
class Swing:
    """A swing of a hand and a tool about an elbow. All fields have the shape ``(...)``.

    Attributes:
        inertia: moment of inertia of the hand and the tool about the elbow [kg m^2].
        rate: final angular speed omega [rad/s], given by the work of the torque: tau phi = I omega^2 / 2.
        lever: distance between the elbow and the impact point, measured along the handle [m].
        impulse: impulse of an inelastic impact [N s].
        weight_torque: largest torque with which the wrist bears the weight of the tool [N m].
    """

    inertia: FloatArray
    rate: FloatArray
    lever: FloatArray
    impulse: FloatArray
    weight_torque: FloatArray

    @property
    def tip_speed(self) -> FloatArray:
        """Speed of the impact point along the normal of the striking face [m/s]."""
        return np.asarray(self.rate * self.lever)

    def periods(self, hand: Token) -> FloatArray:
        """Return the number of control periods, at least 1, in which roughly the strike torque accelerates the tool."""
        exact = self.inertia * self.rate / (hand["strike_torque"] * CONTROL_PERIOD)
        return np.asarray(np.maximum(np.round(exact), 1.0))

    def drive(self, hand: Token) -> FloatArray:
        """Return the constant angular acceleration [rad/s^2] with which the tool reaches its final speed."""
        return np.asarray(self.rate / (self.periods(hand) * CONTROL_PERIOD))

    def torque(self, hand: Token) -> FloatArray:
        """Return the driving torque [N m] about the elbow, in addition to the torque that bears the tool."""
        return np.asarray(self.inertia * self.drive(hand))

    def wound_up(self, hand: Token) -> FloatArray:
        """Return the swing angle [rad] at which the swing begins.

        The speed changes once per control period, so n periods of acceleration turn the tool by (n + 1)/2 times the
        angle of one period at full speed.
        """
        return np.asarray(LEVEL - self.rate * CONTROL_PERIOD * ((self.periods(hand) + 1.0) / 2.0 + _COASTING))

    def duration(self, hand: Token) -> FloatArray:
        """Return the time from the beginning of the swing to the impact [s]."""
        return np.asarray((self.periods(hand) + _COASTING) * CONTROL_PERIOD)


def swing_of(hand: Token, tool: Token, held_at: FloatArray, radius: FloatArray | float) -> Swing:
    """Return the swing of a tool that a hand holds.

    Args:
        hand: the hand.
        tool: the tool.
        held_at: position ``(...)`` [m] of the hand along the tool's x axis.
        radius: distance of the hand from the elbow ``(...)`` [m]. A hand at radius 0 only turns.
    """
    aside = tool["handle_to"][2]
    own = tool["inertia"][1] + hand["wrist_inertia"]
    inertia = own + tool["mass"] * ((held_at - radius) ** 2 + aside**2) + hand["mass"] * np.asarray(radius) ** 2
    rate = np.sqrt(2.0 * hand["strike_torque"] * hand["strike_angle"] / inertia)
    lever = tool["impact_point"][0] - held_at + radius
    mass = tool["mass"] + hand["mass"]
    away = np.sqrt(held_at**2 + aside**2)
    free = own + tool["mass"] * hand["mass"] / mass * away**2
    off_centre = tool["impact_point"][0] - held_at * (hand["mass"] / mass)
    met = 1.0 / (1.0 / mass + off_centre**2 / free)
    return Swing(inertia, rate, np.asarray(lever), met * rate * lever, tool["mass"] * GRAVITY * away)


def largest_impulse(hand: Token, tool: Token) -> float:
    """Return an upper bound of the impulse [N s] over all grasps and radii with which the wrist can bear the tool.

    The ranges of the grasp and of the radius are divided into cells. In each cell, every factor of the impulse in
    `swing_of` is replaced by its largest value. The bound exceeds the largest impulse by about 2 %. It does not limit
    the driving torque of the wrist, because a hand that moves on an arc drives the tool by its force.
    """
    ends = np.linspace(tool["handle_from"][0], tool["handle_to"][0], _CELLS + 1)[:, None]
    radii = np.linspace(0.0, LARGEST_RADIUS, _CELLS + 1)
    low, high, near, far = ends[:-1], ends[1:], radii[:-1], radii[1:]
    aside = tool["handle_to"][2]
    whole = tool["mass"] + hand["mass"]
    own = tool["inertia"][1] + hand["wrist_inertia"]
    arm = _smallest_square(low - far, high - near) + aside**2
    inertia = own + tool["mass"] * arm + hand["mass"] * near**2
    rate = np.sqrt(2.0 * hand["strike_torque"] * hand["strike_angle"] / inertia)
    lever = np.maximum(tool["impact_point"][0] - low + far, 0.0)
    away = np.maximum(low**2, high**2) + aside**2
    free = own + tool["mass"] * hand["mass"] / whole * away
    share = hand["mass"] / whole
    off_centre = _smallest_square(tool["impact_point"][0] - high * share, tool["impact_point"][0] - low * share)
    met = 1.0 / (1.0 / whole + off_centre / free)
    weight_torque = tool["mass"] * GRAVITY * np.sqrt(_smallest_square(low, high) + aside**2)
    return float(np.max(np.where(weight_torque <= hand["maximal_torque"], met * rate * lever, 0.0)))


def _smallest_square(low: FloatArray, high: FloatArray) -> FloatArray:
    """Return the smallest square of the numbers from `low` to `high`."""
    return np.where(low * high > 0, np.minimum(low**2, high**2), 0.0)
