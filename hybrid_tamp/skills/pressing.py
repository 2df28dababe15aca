"""Pressing: hands close on the faces of an object, press on the faces, and move with the object as one rigid body.

Let x and v be the position and velocity of a hand. The hand follows a reference c that closes the gap to the hand's
face, and then moves with the object. The force of the hand is F = K (c - x) + D (c' - v) - S n + W. Here n is the
outward normal of the face, S is the squeeze, and W is a force that bears a part of the object's weight. Only friction
joins the hands to the object. In a forward model, each hand stops at its face, and presses on the face when it touches.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.block import FLOOR, Block, Slot
from hybrid_tamp.model.control import Commands, Hyperparameter, Policy
from hybrid_tamp.model.course import Course
from hybrid_tamp.model.predicate import Binding, Literal, Predicate
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import cross, quaternion_multiply, rotate
from hybrid_tamp.skills.classes import StaticEndEffector
from hybrid_tamp.skills.faces import gap_to_face, normal
from hybrid_tamp.skills.predicates import AT_REST, IN_WORKSPACE
from hybrid_tamp.skills.roles import BODY
from hybrid_tamp.skills.servos import STIFFNESS, damping, driven_velocity
from hybrid_tamp.skills.vectors import dot, stop_at_face

TOUCHING_FORCE = 1.0
"""Largest force [N] that a hand with a fully loosened grip exerts on its face."""
_TOUCH = 1e-4
"""Largest gap between a hand and its face at which the hand touches the face [m]."""


class Pressure(NamedTuple):
    """The planned progress of hands that press on an object, and the planned rigid motion of the object, at one time.

    Attributes:
        closed: closed fraction ``(...)`` of the gap between hand and face, from 0 to 1.
        closing: rate ``(...)`` of `closed` [1/s].
        grip: applied fraction ``(...)`` of the squeeze, from 0 to 1.
        pivot: position ``(..., 3)`` [m] of the pivot of the motion (see `press`).
        velocity: velocity ``(..., 3)`` [m/s] of the pivot, or None if the pivot does not move.
        turned: rotation ``(..., 4)`` of the object about the pivot, or None if the object does not turn.
        spin: angular velocity ``(..., 3)`` [rad/s] of the object, or None if the object does not turn.
        bearing: force ``(..., 3)`` [N] with which each hand bears a part of the object's weight, or None.
        loose: fraction ``(...)`` from 0 to 1 by which the hands have loosened their grip, or None. Each hand presses
            with at most ``1 - loose`` of its maximal force, plus `TOUCHING_FORCE`.
    """

    closed: FloatArray
    closing: FloatArray
    grip: FloatArray
    pivot: FloatArray
    velocity: FloatArray | None = None
    turned: FloatArray | None = None
    spin: FloatArray | None = None
    bearing: FloatArray | None = None
    loose: FloatArray | None = None


def gaps_to_faces(contacts: Sequence[tuple[Token, str]], thing: Token, state: State) -> list[FloatArray]:
    """Return the gap ``(...)`` [m] between each hand and its face. `contacts` are pairs of (hand, face)."""
    return [gap_to_face(state, hand, thing, face) for hand, face in contacts]


def press(
    contacts: Sequence[tuple[Token, str]],
    thing: Token,
    start: State,
    gaps: Sequence[FloatArray],
    squeeze: FloatArray,
    plan: Callable[[FloatArray, State], Pressure],
    pivot: FloatArray | float = 0.0,
    softness: float = 1.0,
) -> Policy:
    """Return the impedance policy of hands that press on faces of an object and move with the object.

    Args:
        contacts: pairs of (hand, face).
        thing: the object.
        start: state at the beginning of the movement.
        gaps: distance ``(...)`` [m] that each hand moves towards its face. A hand with a negative value moves away.
        squeeze: force ``(...)`` [N] with which each hand presses on its face.
        plan: ``plan(elapsed, state)`` returns the planned `Pressure` after an elapsed time ``(...)`` [s].
        pivot: initial position ``(..., 3)`` [m] of the point about which the object turns, or 0 if `Pressure.pivot` is
            the displacement of an object that does not turn.
        softness: ratio of the stiffness along the normal of a face to the stiffness in the other directions, for a hand
            with a full grip. Hands reach their places only approximately. With a small ratio, all hands press equally.
    """
    outward = [normal(start, thing, face) for _, face in contacts]
    # Both the arms from the pivot to the hands and the normals of the faces turn with the object.
    fixed = np.stack([*(start[hand, "position"] - pivot for hand, _ in contacts), *outward], axis=-2)
    hands = [(hand, gap, damping(hand["mass"])) for (hand, _), gap in zip(contacts, gaps, strict=True)]

    def policy(elapsed: FloatArray, state: State) -> Commands:
        planned = plan(elapsed, state)
        carried = fixed if planned.turned is None else rotate(planned.turned[..., None, :], fixed)
        commands: Commands = {}
        for index, (hand, gap, brake) in enumerate(hands):
            face_normal = carried[..., len(hands) + index, :]
            arm = carried[..., index, :] - face_normal * (gap * planned.closed)[..., None]
            error = planned.pivot + arm - state[hand, "position"]
            if softness < 1.0:
                giving_way = (1.0 - softness) * planned.grip * dot(error, face_normal)
                error = error - face_normal * giving_way[..., None]
            force = STIFFNESS * error - face_normal * (squeeze * planned.grip)[..., None]
            if planned.loose is not None:
                force = _loosened(force, face_normal, hand, 1.0 - planned.loose)
            force = force + brake * (_velocity(planned, arm, face_normal, gap) - state[hand, "velocity"])
            commands[hand.name, "force"] = force if planned.bearing is None else force + planned.bearing
        return commands

    return policy


def _velocity(planned: Pressure, arm: FloatArray, outward: FloatArray, gap: FloatArray) -> FloatArray:
    """Return the planned velocity ``(..., 3)`` [m/s] of a hand at an arm ``(..., 3)`` [m] from the pivot."""
    closing = outward * (gap * planned.closing)[..., None]
    carried = planned.velocity if planned.spin is None else cross(planned.spin, arm)
    return -closing if carried is None else carried - closing


def _loosened(push: FloatArray, outward: FloatArray, hand: Token, grip: FloatArray) -> FloatArray:
    """Limit the normal force of a hand on its face to `grip` times its maximal force plus `TOUCHING_FORCE`."""
    inward = -dot(push, outward)
    most = TOUCHING_FORCE + grip * hand["maximal_force"]
    return np.asarray(push + outward * np.maximum(inward - most, 0.0)[..., None])


def sweep_pressed(
    contacts: Sequence[tuple[Token, str]],
    thing: Token,
    start: State,
    gaps: Sequence[FloatArray],
    times: FloatArray,
    planned: Pressure,
    pivot: FloatArray | float = 0.0,
    orientations: Mapping[Token, FloatArray] | None = None,
) -> Course:
    """Return the course of hands that close on faces, and of the object that moves with the hands.

    Args:
        contacts: pairs of (hand, face).
        thing: the object.
        start: state at the beginning of the movement, without batch dimensions.
        gaps: distance ``()`` [m] that each hand moves towards its face.
        times: elapsed times of k instants [s], shape ``(k,)``.
        planned: the planned progress at these instants, each field with shape ``(k, ...)``.
        pivot: see `press`.
        orientations: maps hands to the orientations ``(4,)`` that they keep. Other hands keep their present ones.
    """
    count = len(times)

    def carry(arm: FloatArray) -> FloatArray:
        return arm if planned.turned is None else rotate(planned.turned, arm)

    values = {(thing.name, "position"): planned.pivot + carry(start[thing, "position"] - pivot)}
    if planned.turned is not None:
        values[thing.name, "orientation"] = quaternion_multiply(planned.turned, start[thing, "orientation"])
    for (hand, face), gap in zip(contacts, gaps, strict=True):
        closing = normal(start, thing, face) * (gap * planned.closed)[:, None]
        values[hand.name, "position"] = planned.pivot + carry(start[hand, "position"] - pivot - closing)
        kept = (
            start[hand, "orientation"] if orientations is None else orientations.get(hand, start[hand, "orientation"])
        )
        values[hand.name, "orientation"] = np.repeat(kept[None], count, axis=0)
        values[hand.name, "orientation"][0] = start[hand, "orientation"]
    values = {key: np.broadcast_to(value, (count, value.shape[-1])) for key, value in values.items()}
    return Course.through(start, values, times=times)


def touches_face(gap: FloatArray) -> FloatArray:
    """Return whether ``(...)`` a hand touches a face at a gap ``(...)`` [m]."""
    return np.asarray(gap <= _TOUCH)


def meet_face(
    state: State, hand: Token, outward: FloatArray, gap: FloatArray, commands: Commands, dt: float
) -> tuple[FloatArray, FloatArray]:
    """Return a hand's velocity ``(..., 3)`` [m/s] that the face stops, and whether ``(...)`` the hand touches the face.

    Args:
        state: current state.
        hand: the hand.
        outward: outward normal ``(..., 3)`` of the face.
        gap: distance ``(...)`` [m] between the hand and the face.
        commands: commands of the hand.
        dt: time step [s].
    """
    return stop_at_face(driven_velocity(hand, state, commands, dt), outward, gap, dt), touches_face(gap)


def squeezing(limits: Callable[[Binding], tuple[float, float, float]], most: float = 1e5) -> Hyperparameter:
    """Return the hyperparameter ``squeeze`` of hands that press on an object.

    Args:
        limits: ``limits(binding)`` returns the smallest squeeze, the initial value and the largest squeeze [N].
        most: upper bound of the squeeze for all bindings [N].
    """

    def initial(binding: Binding, state: State) -> FloatArray:
        return np.asarray(limits(binding)[1])

    def within(binding: Binding) -> tuple[float, float]:
        smallest, _, largest = limits(binding)
        return smallest, largest

    return Hyperparameter("squeeze", "N", 0.0, most, initial, "force with which each hand presses on its face", within)


def make_pressing(
    name: str,
    hands: Sequence[str],
    thing: type[ObjectClass],
    exit: tuple[Literal, ...],
    always: Sequence[Predicate] = (IN_WORKSPACE,),
    invariants: tuple[Literal, ...] = (),
    contacts: Sequence[tuple[str, str]] = (("object", FLOOR),),
    **told: Any,
) -> Block:
    """Return a block in which hands press on an object and move it. The slot of the object, `object`, is the anchor.

    Args:
        name: name of the block.
        hands: names of the slots of the hands.
        thing: class of the object.
        exit: exit conditions in addition to the rest of all tokens.
        always: predicates that must hold for each hand as long as the block runs.
        invariants: further conditions that must hold as long as the block runs.
        contacts: pairs of roles that may touch, in addition to each hand and the object.
        **told: further arguments of `Block`.
    """
    return Block(
        name=name,
        slots=(*(Slot(hand, StaticEndEffector) for hand in hands), Slot("object", thing)),
        anchor="object",
        exit=(*exit, AT_REST("object"), *map(AT_REST, hands)),
        invariants=(*(predicate(hand) for hand in hands for predicate in always), *invariants),
        writes={**dict.fromkeys(hands, BODY), "object": BODY},
        allowed_contacts=(*((hand, "object") for hand in hands), *contacts),
        **told,
    )
