"""The speed and impulse, in closed form, of a tool that a constant torque swings through an angle."""

from dataclasses import dataclass

import numpy as np

from hybrid_tamp.authoring import CONTROL_PERIOD, GRAVITY, FloatArray, Token, grip_limits

from .geometry import LEVEL

LARGEST_RADIUS = 0.3
"""Largest distance between the hand and the elbow [m]."""
_CELLS = 256
"""Number of intervals into which `largest_impulse` divides each range."""


_PUSHED_ON = 1.1
"""Factor of `largest_impulse` for the impulse of the hand's servo during the impact. PyBullet gave at most 1.07."""
_COASTING = 0.15
"""Number of control periods without torque before the planned impact, so that the whole torque has acted by then."""


_Range = tuple[FloatArray, FloatArray]
"""Lower and upper ends of intervals."""


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
        """Return the number of control periods, not rounded, in which the strike torque drives a swing from rest.

        A constant torque tau turns the inertia I through the angle phi in the time sqrt(2 phi I / tau).
        """
        seconds = np.sqrt(2.0 * hand["strike_angle"] * self.inertia / hand["strike_torque"])
        return np.asarray(seconds / CONTROL_PERIOD)

    def driven(self, hand: Token, period: FloatArray | float) -> FloatArray:
        """Return the angular acceleration ``(...)`` [rad/s^2] in a control period, counted from 0 at the beginning.

        The strike torque acts in whole periods after a first period with the remaining torque. Then no torque acts.
        With the remaining torque in the last period, the swing would begin further back, and the butt of the handle
        would hit the object.
        """
        exact = self.periods(hand)
        whole = np.floor(exact)
        share = np.where(period <= 0, exact - whole, period <= whole)
        return np.asarray(share * hand["strike_torque"] / self.inertia)

    def wound_up(self, hand: Token) -> FloatArray:
        """Return the swing angle [rad] at which the swing begins, so that its last period of torque ends at the target.

        The speed changes once per control period. So a share r of a period and n whole periods turn the tool by
        ``(n + 1) (r + n / 2)`` times the angle of one period at the speed that one period gives.
        """
        exact = self.periods(hand)
        whole = np.floor(exact)
        turned = (whole + 1.0) * (exact - whole / 2.0) + exact * _COASTING
        return np.asarray(LEVEL - turned * (hand["strike_torque"] / self.inertia) * CONTROL_PERIOD**2)

    def duration(self, hand: Token) -> FloatArray:
        """Return the time from the beginning of the swing to the impact [s]."""
        return np.asarray((np.floor(self.periods(hand)) + 1.0 + _COASTING) * CONTROL_PERIOD)


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


def largest_impulse(hand: Token, tool: Token, *, gripped: bool = False) -> float:
    """Return an upper bound of the impulse [N s] over all grasps and radii with which the wrist can bear the tool.

    The ranges of the grasp and of the radius are divided into cells. In each cell, every factor of the impulse in
    `swing_of` is replaced by its largest value. The servo of the hand pushes on during the impact, so the bound exceeds
    the largest impulse by about 10 %. The bound does not limit the driving torque of the wrist, because a hand that
    moves on an arc drives the tool by its force.

    Args:
        hand: the hand.
        tool: the tool.
        gripped: whether only swings count in which the tool does not slip in the grip before the impact.
    """
    ends = np.linspace(tool["handle_from"][0], tool["handle_to"][0], _CELLS + 1)[:, None]
    radii = np.linspace(0.0, LARGEST_RADIUS, _CELLS + 1)
    low, high, near, far = ends[:-1], ends[1:], radii[:-1], radii[1:]
    aside = tool["handle_to"][2]
    whole = tool["mass"] + hand["mass"]
    own = tool["inertia"][1] + hand["wrist_inertia"]
    inertia = own + tool["mass"] * (_smallest_square(low - far, high - near) + aside**2) + hand["mass"] * near**2
    rate = np.sqrt(2.0 * hand["strike_torque"] * hand["strike_angle"] / inertia)
    lever = np.maximum(tool["impact_point"][0] - low + far, 0.0)
    away = np.maximum(low**2, high**2) + aside**2
    free = own + tool["mass"] * hand["mass"] / whole * away
    share = hand["mass"] / whole
    off_centre = _smallest_square(tool["impact_point"][0] - high * share, tool["impact_point"][0] - low * share)
    met = 1.0 / (1.0 / whole + off_centre / free)
    weight_torque = tool["mass"] * GRAVITY * np.sqrt(_smallest_square(low, high) + aside**2)
    borne = weight_torque <= hand["maximal_torque"]
    if gripped:
        borne = borne & (_least_grip_load(hand, tool, (low, high), (near, far)) <= 1.0)
    return float(_PUSHED_ON * np.max(np.where(borne, met * rate * lever, 0.0)))


def _least_grip_load(hand: Token, tool: Token, grasps: _Range, radii: _Range) -> FloatArray:
    """Return a lower bound ``(...)`` of the grip's load just before the impact, as a ratio to the limits of the grip.

    The grip bears the centrifugal force of the tool by friction along the handle. It bears the tool's share of the
    driving torque by a shift of the pads' pressure. At the impact, the tool is level, and its weight helps to drive it.

    Args:
        hand: the hand.
        tool: the tool.
        grasps: ranges of the hand's position along the tool's x axis [m].
        radii: ranges of the radius [m].
    """
    (low, high), (near, far) = grasps, radii
    mass, aside = tool["mass"], abs(tool["handle_to"][2])
    own = tool["inertia"][1] + hand["wrist_inertia"]
    out = np.maximum(np.abs(near - low), np.abs(far - low))
    out = np.maximum(out, np.maximum(np.abs(near - high), np.abs(far - high)))
    slowest = hand["strike_torque"] / (own + mass * (out**2 + aside**2) + hand["mass"] * far**2)
    fastest = hand["strike_torque"] / (own + hand["mass"] * near**2)
    distance = np.maximum(near - high, 0.0)
    pulled = mass * (2.0 * hand["strike_angle"] * slowest * distance - fastest * aside)
    moment = slowest * (tool["inertia"][1] + mass * distance * np.maximum(-high, 0.0))
    moment = moment - mass * GRAVITY * np.maximum(np.abs(low), np.abs(high))
    limits = grip_limits(hand, tool, hand["maximal_grip"])
    return np.asarray(np.maximum(pulled / limits[0], moment / limits[4]))


def _smallest_square(low: FloatArray, high: FloatArray) -> FloatArray:
    """Return the smallest square of the numbers from `low` to `high`."""
    return np.where(low * high > 0, np.minimum(low**2, high**2), 0.0)
