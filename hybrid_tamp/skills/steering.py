"""Steering of an object that is pushed from behind at a single point."""

import numpy as np

from hybrid_tamp.geometry.shapes import Box
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_conjugate, rotate
from hybrid_tamp.skills.vectors import dot

_STEERING = 0.08
"""Ratio of the pushing point's lateral offset to the angle by which the object has turned [m/rad]."""
_RETURNING = 15.0
"""Ratio of the object's wanted turn towards its line to its distance from the line [rad/m]."""
_STRAIGHTENING = 0.05
"""Distance over which the object turns back at the end of a push [m]."""
_LARGEST_TURN = 0.3
"""Largest wanted turn of the object [rad]."""
_MARGIN = 0.6
"""Ratio of the pushing point's largest lateral offset to the object's half width."""


def steer(
    state: State, thing: Token, line: FloatArray, axes: FloatArray, remaining: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the lateral position ``(...)`` [m] of the pushing point and the rate ``(...)`` [m/s] of this position.

    An object that is pushed from behind at a single point turns away from this point. To counteract a turn, the tool
    pushes on the side to which the object has turned. If the object has left its line, the tool turns the object
    slightly towards the line. At the end, the object turns back, so the next block finds it as planned. A body that is
    not a box is pushed at its middle.

    Args:
        state: current state.
        thing: the pushed object.
        line: a point on the line of the push ``(..., 3)`` [m].
        axes: the directions along the line and perpendicular to the line ``(..., 2, 3)``.
        remaining: distance that the object has yet to move along the line ``(...)`` [m].
    """
    across = axes[..., 1, :]
    off, drift = dot(state[thing, "position"] - line, across), dot(state[thing, "velocity"], across)
    if not isinstance(thing.shape, Box):  # The sides of other bodies are not flat, so their turn does not matter.
        return off, drift
    half_extents = np.asarray(thing.shape.half_extents)
    local = rotate(quaternion_conjugate(state[thing, "orientation"])[..., None, :], axes)
    turned = (np.pi / 4 - np.arctan2(local[..., 0, 1], local[..., 0, 0])) % (np.pi / 2) - np.pi / 4
    spin = state[thing, "angular_velocity"][..., 2]
    reach = np.ascontiguousarray(np.abs(local)) @ half_extents
    depth, width = reach[..., 0], _MARGIN * reach[..., 1]
    wanted = np.minimum(np.maximum(-_RETURNING * off, -_LARGEST_TURN), _LARGEST_TURN)
    wanted = wanted * np.minimum(np.maximum(remaining / _STRAIGHTENING, 0.0), 1.0)
    beside = np.minimum(np.maximum(_STEERING * (turned - wanted), -width), width)
    return off - depth * turned + beside, drift + (_STEERING - depth) * spin
