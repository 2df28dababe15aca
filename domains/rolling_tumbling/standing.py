"""Margins of a box's postures, and a check of whether the box can be tumbled from its initial pose."""

from collections.abc import Iterable

import numpy as np

from hybrid_tamp.authoring import FloatArray, State, Token, cross, without_rounding
from hybrid_tamp.skills import NORMALS, UP, StaticEndEffector, can_turn, dot, normal, to_body, z_axis

from .faces import FACE, POSTURES, faces_of, flat
from .tumbling_geometry import lowest_point, nominal_tilt, tilt
from .turning_hands import axes_of_turn

SLENDERNESS = 1.6
"""Largest ratio of a box's edge lengths. Tumbling has been tested up to this ratio."""
FLAT_TOLERANCE = np.radians(5.0)
# The tolerance is less than PAST_BALANCE, so no box is in both leaning postures of an edge at once.
_TIPPED_TOLERANCE = np.radians(5.0)
_TWIST_TOLERANCE = np.radians(5.0)
_GROUND_TOLERANCE = 0.015
_LEVEL = 0.5


def standing(state: State, thing: Token, posture: str) -> FloatArray:
    """Return the margin ``(...)`` [rad] of a posture, which is at least 0 if the box is in the posture.

    The result is the smaller of two margins: the margin of the orientation, and the margin of the height of the lowest
    point above the ground, scaled to an angle.
    """
    contact = 1.0 - np.abs(lowest_point(state, thing)) / _GROUND_TOLERANCE
    return np.asarray(np.minimum(_fit(state, thing, posture), FLAT_TOLERANCE * contact))


def _fit(state: State, thing: Token, posture: str) -> FloatArray:
    faces = faces_of(posture)
    if len(faces) == 1:
        return np.asarray(FLAT_TOLERANCE - np.arccos(np.clip(-normal(state, thing, faces[0])[..., 2], -1.0, 1.0)))
    angle = tilt(state, thing, *faces) - nominal_tilt(thing, posture, *faces)
    # Both faces beside the edge must face down, so the edge must be level.
    level = cross(NORMALS[faces[0]], NORMALS[faces[1]])
    heights = np.abs(dot(to_body(state, thing, UP), level))
    twist = _TWIST_TOLERANCE - np.arcsin(np.clip(heights, 0.0, 1.0))
    return np.asarray(np.minimum(_TIPPED_TOLERANCE - np.abs(angle), twist))


def start_complaint(thing: Token, state: State, tokens: Iterable[Token]) -> str | None:
    """Return the reason why a box cannot be tumbled from its initial pose, or None if the box can be tumbled.

    Args:
        thing: the box.
        state: the initial state, without batch dimensions.
        tokens: all tokens of the task, including the hands about whose axes the box tumbles.
    """
    if not any(_stands(state, thing, posture) for posture in POSTURES.symbols):
        return _unsupported(thing, state)
    down = next((face for face in FACE.symbols if _stands(state, thing, flat(face))), None)
    if down is None:
        return None
    height, base = _proportions(thing, state, tokens, down)
    if without_rounding(np.asarray(SLENDERNESS - height / base), 1.0) >= 0:
        return None
    return (
        f"the height of a TUMBLABLE box must be at most {SLENDERNESS} times the width of its base, got a height of "
        f"{height:.3g} m and a width of {base:.3g} m; lay the box on another face, or remove its class TUMBLABLE"
    )


def _stands(state: State, thing: Token, posture: str) -> bool:
    return float(without_rounding(standing(state, thing, posture), FLAT_TOLERANCE)) >= 0


def _unsupported(thing: Token, state: State) -> str:
    nearest = max(POSTURES.symbols, key=lambda posture: float(_fit(state, thing, posture)))
    off = FLAT_TOLERANCE - float(_fit(state, thing, nearest))
    height = float(lowest_point(state, thing))
    said = []
    if off > FLAT_TOLERANCE:
        said.append(f"it is {np.degrees(off):.3g} degrees off its nearest posture, {nearest!r}")
    if abs(height) > _GROUND_TOLERANCE:
        said.append(f"its lowest point is {height:.3g} m above {thing.ground.text}")
    return (
        f"the box is in no posture: {', and '.join(said)}; a TUMBLABLE box must either lie flat on a face, or stand on "
        "an edge and lean over a face beside the edge"
    )


def _proportions(thing: Token, state: State, tokens: Iterable[Token], down: str) -> tuple[float, float]:
    """Return the height [m] of a flat box, and the largest width [m] of its base perpendicular to a hand's axis."""
    extents = 2.0 * np.asarray(thing["half_extents"])
    upright = int(np.argmax(np.abs(NORMALS[down])))
    hands = (token for token in tokens if token.is_member(StaticEndEffector))
    edges = {edge for hand in hands for edge in _edges_along(thing, state, hand)} - {upright}
    bases = [float(extents[3 - upright - edge]) for edge in edges]
    return float(extents[upright]), float(max(bases, default=np.delete(extents, upright).max()))


def _edges_along(thing: Token, state: State, hand: Token) -> tuple[int, ...]:
    """Return the indices of the box's body axes about which a hand can turn it. A hand that stays upright has none."""
    if not can_turn(hand) and abs(float(z_axis(state, hand)[2])) > _LEVEL:
        return ()
    return axes_of_turn(state, hand, thing)
