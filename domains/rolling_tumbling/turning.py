"""Policy that all modes of TIPPING share, for two hands that turn a box about an edge.

A motor primitive plans the tilt of the box. The reference c of a hand turns about the edge with this tilt. The force of
the hand is F = K (c - x) + D (c' - v) - S n, where n is the outward normal of its face and S is the squeeze. The hands
squeeze before the box turns. If the box ends flat on a face, they loosen their grip before the end.
"""

from dataclasses import dataclass

import numpy as np

from hybrid_tamp.authoring import (
    Binding,
    Commands,
    FloatArray,
    Parameters,
    Policy,
    Profile,
    State,
    Token,
    cross,
    minimum_jerk,
    normalized,
    quaternion_from_axis_angle,
    quaternion_multiply,
    rotate,
)
from hybrid_tamp.skills import (
    STIFFNESS,
    Reference,
    Timetable,
    damping,
    dot,
    get_symbol,
    get_tokens,
    straight_profile,
    to_body,
)

from .faces import NORMALS, edge_between, faces_of
from .tumbling_geometry import (
    contact_distance,
    edge_axis,
    edge_position,
    nominal_tilt,
    normal,
    tilt,
)

CLOSING = 0.35
"""Time in which the hands close on the box and build up the squeeze [s]."""
_CATCHING_UP = 0.7
"""Ratio of the hands' extra turn to the angle by which the box lags behind the plan."""
_LEAD = 0.3
"""Largest extra turn of the hands [rad]."""
_LOOSENING = (0.82, 0.94)
"""Fractions of a turn onto a face at which the hands begin and finish to loosen their grip."""
_LYING = float(np.radians(0.7))
"""Deviation from the flat posture [rad] at which the hands begin to loosen their grip if the box is early."""
_TOUCHING_FORCE = 1.0
"""Largest force [N] that a hand with a fully loosened grip exerts on its face."""


@dataclass(frozen=True)
class Roles:
    """Tokens and symbols of a block instance of TIPPING.

    Attributes:
        hands: the hand at the near face and the hand at the far face.
        thing: the box.
        faces: the near face and the far face.
        edge: the two faces beside the edge of the turn. The tilt is measured from the first face towards the second.
        outcome: the posture after the turn.
    """

    hands: tuple[Token, ...]
    thing: Token
    faces: tuple[str, str]
    edge: tuple[str, str]
    outcome: str

    @classmethod
    def of(cls, binding: Binding) -> "Roles":
        """Return the roles in a binding."""
        near, far, before, outcome = (get_symbol(binding, role) for role in ("near", "far", "before", "outcome"))
        *hands, thing = get_tokens(binding, "first", "second", "object")
        return cls(tuple(hands), thing, (near, far), edge_between(before, outcome), outcome)

    @property
    def wanted(self) -> float:
        """Tilt of the box after the turn [rad]."""
        return nominal_tilt(self.thing, self.outcome, *self.edge)


def turning_time(angle: FloatArray | float, rate: FloatArray | float) -> FloatArray:
    """Return the duration ``(...)`` [s] of a turn by an angle [rad] at a mean rate [rad/s]."""
    return np.asarray(np.maximum(np.abs(angle), 0.05) / rate)


def make_turning(binding: Binding, start: State, parameters: Parameters, profile: Profile) -> Policy:
    """Return the impedance policy of both hands. The tilt of the box follows the profile."""
    roles = Roles.of(binding)
    thing, wanted = roles.thing, roles.wanted
    rate, squeeze = (np.asarray(parameters.hyperparameters[name]) for name in ("rate", "squeeze"))
    pivot, axis = edge_position(start, thing, *roles.edge), edge_axis(start, thing, *roles.edge)
    begun = tilt(start, thing, *roles.edge)
    turn = wanted - begun
    normals = [normal(start, thing, face) for face in roles.faces]
    gaps = [_gap(start, hand, thing, face) for hand, face in zip(roles.hands, roles.faces, strict=True)]
    hands = [(hand, gap, damping(hand["mass"])) for hand, gap in zip(roles.hands, gaps, strict=True)]
    # The arms of both hands and the normals of their faces turn with the box.
    fixed = np.stack([*(start[hand, "position"] - pivot for hand in roles.hands), *normals], axis=-2)
    tipped = len(faces_of(roles.outcome)) > 1
    unit_axis = normalized(axis)

    timetable = Timetable(_make_reference(axis, turn, turning_time(turn, rate), profile), start)

    def policy(elapsed: FloatArray, state: State) -> Commands:
        closed, closing, phase, planned, spin = timetable(elapsed)
        angle = tilt(state, thing, *roles.edge)
        ahead = np.minimum(np.maximum(_CATCHING_UP * (planned - (angle - begun)), -_LEAD), _LEAD)
        turned = quaternion_from_axis_angle(unit_axis, planned + ahead, unit=True)
        loose = np.zeros_like(phase) if tipped else _loose(phase, wanted - angle)
        grip = closed * (1.0 - loose)
        commands: Commands = {}
        carried = rotate(turned[..., None, :], fixed)
        for index, (hand, gap, brake) in enumerate(hands):
            face_normal = carried[..., index + 2, :]
            lever = carried[..., index, :] - face_normal * (gap * closed)[..., None]
            velocity = cross(spin, lever) - face_normal * (gap * closing)[..., None]
            push = STIFFNESS * (pivot + lever - state[hand, "position"]) - face_normal * (squeeze * grip)[..., None]
            braking = brake * (velocity - state[hand, "velocity"])
            commands[hand.name, "force"] = _loosened(push, face_normal, hand, 1.0 - loose) + braking
        return commands

    return policy


def _make_reference(axis: FloatArray, turn: FloatArray, duration: FloatArray, profile: Profile) -> Reference:
    """Return the function of the time that gives the planned progress of a turn by an angle ``(...)`` [rad].

    The progress consists of the closed share of the gaps, its rate [1/s], the phase of the turn, the planned angle
    [rad] and the planned angular velocity ``(..., 3)`` [rad/s].
    """

    def reference(elapsed: FloatArray) -> tuple[FloatArray, ...]:
        phase = (elapsed - CLOSING) / duration
        spin = axis * (turn * profile.rate(phase) / duration)[..., None]
        closed, closing = straight_profile().share(elapsed / CLOSING), straight_profile().rate(elapsed / CLOSING)
        return closed, closing / CLOSING, phase, turn * profile.share(phase), spin

    return reference


def _loose(phase: FloatArray, left: FloatArray) -> FloatArray:
    """Return how far ``(...)`` the hands have loosened their grip, from 0 for a full grip to 1 for no grip.

    The hands loosen their grip as planned, or earlier if the box reaches its next face early.

    Args:
        phase: elapsed fraction of the planned turn ``(...)``.
        left: remaining angle ``(...)`` [rad] until the box lies on its next face.
    """
    by_plan = (phase - _LOOSENING[0]) / (_LOOSENING[1] - _LOOSENING[0])
    by_angle = 1.0 - np.abs(left) / _LYING
    return np.asarray(minimum_jerk(np.maximum(by_plan, by_angle)))


def _loosened(push: FloatArray, outward: FloatArray, hand: Token, grip: FloatArray) -> FloatArray:
    """Limit the normal force of a hand on its face to `grip` times its maximal force plus `_TOUCHING_FORCE`."""
    inward = -dot(push, outward)
    most = _TOUCHING_FORCE + grip * hand["maximal_force"]
    return np.asarray(push + outward * np.maximum(inward - most, 0.0)[..., None])


def _gap(state: State, hand: Token, thing: Token, face: str) -> FloatArray:
    """Return the distance ``(...)`` [m] between a hand's surface and its contact point, along the face's normal."""
    offset = to_body(state, thing, state[hand, "position"] - state[thing, "position"])
    return np.asarray(dot(offset, NORMALS[face]) - contact_distance(thing, face) - hand["radius"])


def after_turning(binding: Binding, state: State) -> State:
    """Return the state ``(...)`` after the turn. The box and the hands on its faces turn about the edge as one body."""
    roles = Roles.of(binding)
    thing = roles.thing
    pivot, axis = edge_position(state, thing, *roles.edge), edge_axis(state, thing, *roles.edge)
    turn = quaternion_from_axis_angle(axis, roles.wanted - tilt(state, thing, *roles.edge))
    changes: dict[tuple[str, str], FloatArray] = {
        (thing.name, "position"): pivot + rotate(turn, state[thing, "position"] - pivot),
        (thing.name, "orientation"): quaternion_multiply(turn, state[thing, "orientation"]),
    }
    for hand, face in zip(roles.hands, roles.faces, strict=True):
        gap = _gap(state, hand, thing, face)[..., None] * normal(state, thing, face)
        changes[hand.name, "position"] = pivot + rotate(turn, state[hand, "position"] - gap - pivot)
    return state.replace(changes)
