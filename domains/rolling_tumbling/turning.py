"""Policy that all modes of TIPPING share, for two hands that turn a box about an edge.

A motor primitive plans the tilt of the box. The references of the hands turn about the edge with this tilt, and the
hands press on their faces (see `hybrid_tamp.skills.press`). The hands squeeze before the box turns. If the box ends
flat on a face, the hands loosen their grip before the end.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hybrid_tamp.authoring import (
    SERVO_ERROR,
    Binding,
    Course,
    FloatArray,
    KeyPose,
    Parameters,
    Policy,
    Profile,
    State,
    Token,
    minimum_jerk,
    normalized,
    quaternion_from_axis_angle,
    quaternion_multiply,
    rotate,
    sample_times,
)
from hybrid_tamp.skills import (
    Pressure,
    Reference,
    Timetable,
    advance,
    gap_to_face,
    gaps_to_faces,
    get_symbol,
    get_tokens,
    keep_orientation,
    normal,
    press,
    straight_profile,
    sweep_pressed,
    turn_wrists,
)

from .faces import edge_between, faces_of
from .standing import FLAT_TOLERANCE
from .tumbling_geometry import edge_axis, edge_position, nominal_tilt, place_at, tilt
from .turning_hands import ALIGNMENT

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

_KEY_POSES = 16
"""Number of angles of a turn at which fixed bodies are compared with the box and its hands."""
_SLIDING = 0.01
"""Largest distance of a hand from its place on the turning box [m]."""


@dataclass(frozen=True)
class Roles:
    """Tokens and symbols of a block instance of TIPPING.

    Attributes:
        contacts: pairs of (hand, face), for the near face and the far face.
        thing: the box.
        edge: the two faces beside the edge of the turn. The tilt is measured from the first face towards the second.
        outcome: the posture after the turn.
    """

    contacts: tuple[tuple[Token, str], ...]
    thing: Token
    edge: tuple[str, str]
    outcome: str

    @classmethod
    def of(cls, binding: Binding) -> "Roles":
        """Return the roles in a binding."""
        near, far, before, outcome = (get_symbol(binding, role) for role in ("near", "far", "before", "outcome"))
        first, second, thing = get_tokens(binding, "first", "second", "object")
        return cls(((first, near), (second, far)), thing, edge_between(before, outcome), outcome)

    @property
    def wanted(self) -> float:
        """Tilt of the box after the turn [rad]."""
        return nominal_tilt(self.thing, self.outcome, *self.edge)


def turning_time(angle: FloatArray | float, rate: FloatArray | float) -> FloatArray:
    """Return the duration ``(...)`` [s] of a turn by an angle [rad] at a mean rate [rad/s]."""
    return np.asarray(np.maximum(np.abs(angle), 0.05) / rate)


def _plan(roles: Roles, start: State, parameters: Parameters, profile: Profile) -> tuple[Reference, FloatArray]:
    """Return the reference of the tilt, which follows the profile, and the duration ``(...)`` [s] of the turn."""
    thing, straight = roles.thing, straight_profile()
    axis = edge_axis(start, thing, *roles.edge)
    turn = roles.wanted - tilt(start, thing, *roles.edge)
    duration = turning_time(turn, np.asarray(parameters.hyperparameters["rate"]))

    def reference(elapsed: FloatArray) -> tuple[FloatArray, ...]:
        """Return the closed share of the gaps, its rate, the phase of the turn, the planned angle and its rate."""
        planned, speed = advance(profile, elapsed - CLOSING, duration, turn)
        return *advance(straight, elapsed, CLOSING), (elapsed - CLOSING) / duration, planned, axis * speed[..., None]

    return reference, duration


def make_turning(binding: Binding, start: State, parameters: Parameters, profile: Profile) -> Policy:
    """Return the impedance policy of both hands. The tilt of the box follows the profile."""
    roles = Roles.of(binding)
    thing, wanted, squeeze = roles.thing, roles.wanted, np.asarray(parameters.hyperparameters["squeeze"])
    pivot, axis = edge_position(start, thing, *roles.edge), edge_axis(start, thing, *roles.edge)
    begun, unit_axis = tilt(start, thing, *roles.edge), normalized(axis)
    tipped = len(faces_of(roles.outcome)) > 1
    timetable = Timetable(_plan(roles, start, parameters, profile)[0], start)

    def plan(elapsed: FloatArray, state: State) -> Pressure:
        closed, closing, phase, planned, spin = timetable(elapsed)
        angle = tilt(state, thing, *roles.edge)
        ahead = np.minimum(np.maximum(_CATCHING_UP * (planned - (angle - begun)), -_LEAD), _LEAD)
        turned = quaternion_from_axis_angle(unit_axis, planned + ahead, unit=True)
        loose = np.zeros_like(phase) if tipped else _loose(phase, wanted - angle)
        return Pressure(closed, closing, closed * (1.0 - loose), pivot, turned=turned, spin=spin, loose=loose)

    gaps = gaps_to_faces(roles.contacts, thing, start)
    return keep_parallel(press(roles.contacts, thing, start, gaps, squeeze, plan, pivot), roles.contacts, thing, start)


def sweep_turning(binding: Binding, start: State, parameters: Parameters, profile: Profile) -> Course:
    """Return the course of the box and of both hands. The box turns as planned."""
    roles = Roles.of(binding)
    thing, contacts = roles.thing, roles.contacts
    pivot, axis = edge_position(start, thing, *roles.edge), edge_axis(start, thing, *roles.edge)
    reference, duration = _plan(roles, start, parameters, profile)
    times = sample_times(CLOSING + duration)
    closed, closing, _, angle, _ = reference(times)
    planned = Pressure(closed, closing, closed, pivot, turned=quaternion_from_axis_angle(axis, angle))
    parallel = {hand: ALIGNMENT.orientation(start, hand, thing, face) for hand, face in contacts}
    gaps = gaps_to_faces(contacts, thing, start)
    return sweep_pressed(contacts, thing, start, gaps, times, planned, pivot, parallel)


def keep_parallel(policy: Policy, contacts: Sequence[tuple[Token, str]], thing: Token, start: State) -> Policy:
    """Return a policy that also keeps hands parallel to the edge about which the box turns. This edge does not move.

    Args:
        policy: policy that moves the hands.
        contacts: pairs of (hand, face). Hands that cannot turn are ignored.
        thing: the box.
        start: state at the beginning of the movement.
    """
    wanted = {hand: keep_orientation(ALIGNMENT.orientation(start, hand, thing, face)) for hand, face in contacts}
    return turn_wrists(policy, wanted)


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


def poses_of_turn(binding: Binding, start: State) -> list[KeyPose]:
    """Return poses of the box and of its hands from the start of a turn until the box may count as turned.

    The box passes all angles in between. The hands touch their faces and turn with the box.
    """
    roles = Roles.of(binding)
    thing, hands = roles.thing, dict(zip(("first", "second"), roles.contacts, strict=True))
    pivot, axis = edge_position(start, thing, *roles.edge), edge_axis(start, thing, *roles.edge)
    turn = roles.wanted - float(tilt(start, thing, *roles.edge))
    begun = [("object", start[thing, "position"], start[thing, "orientation"], SERVO_ERROR)]
    for slot, (hand, face) in hands.items():
        place, lying = place_at(start, hand, thing, face, 0.0), ALIGNMENT.orientation(start, hand, thing, face)
        begun.append((slot, place, lying, _SLIDING))
    poses = []
    for angle in np.sign(turn) * np.linspace(0.0, max(abs(turn) - FLAT_TOLERANCE, 0.0), _KEY_POSES):
        turned = quaternion_from_axis_angle(axis, angle)
        for slot, at, lying, within in begun:
            orientation = quaternion_multiply(turned, lying)
            poses.append(KeyPose(slot, pivot + rotate(turned, at - pivot), orientation, within))
    return poses


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
    for hand, face in roles.contacts:
        gap = gap_to_face(state, hand, thing, face)[..., None] * normal(state, thing, face)
        changes[hand.name, "position"] = pivot + rotate(turn, state[hand, "position"] - gap - pivot)
        changes[hand.name, "orientation"] = ALIGNMENT.orientation(state, hand, thing, face)
    return state.replace(changes)
