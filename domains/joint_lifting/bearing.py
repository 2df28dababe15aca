"""How hands bear a box between them: the policy and the forward model that LIFTING, HOLDING and LOWERING share.

Each hand follows its reference c, which moves with the box: F = K (c - x) + D (c' - v) - S n + W z. Here n is the
outward normal of its face, along which K is smaller, S is the squeeze and W is its share of the weight. Only friction
joins hand and box. In the forward model, too, a hand bears at most mu times the force with which it presses on its
face; with more load the box slips.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from hybrid_tamp.authoring import (
    GRAVITY,
    Binding,
    Commands,
    ContinuousSystem,
    FloatArray,
    Hyperparameter,
    Policy,
    State,
    Token,
)

from ..common.roles import get_token
from ..common.servos import STIFFNESS, damping, force_on
from ..common.vectors import UP, dot
from .load import friction, largest_squeeze, load, squeeze_for
from .places import CREWS, corner_heights, gap_at, outward

SLOTS = ("first", "second", "third", "fourth")
"""Slots of the hands, in the order of the places of a crew."""
_SOFTNESS = 0.1
"""Stiffness of a hand that squeezes along the normal of its face, as a share of its stiffness in other directions.

Along the face the hand must be stiff: two hands that push against each other with S over a length L buckle, and the box
turns about the vertical, unless S < K L / 2.
"""
_TOUCH = 1e-4


@dataclass(frozen=True)
class Roles:
    """The tokens of an instance.

    Attributes:
        crew: symbol of the number of hands.
        hands: the hands with their places.
        thing: the box.
    """

    crew: str
    hands: tuple[tuple[Token, str], ...]
    thing: Token

    @classmethod
    def of(cls, crew: str, binding: Binding) -> "Roles":
        """Read the roles of a binding."""
        hands = tuple((get_token(binding, slot), place) for slot, place in places_of(crew))
        return cls(crew, hands, get_token(binding, "object"))


def places_of(crew: str) -> tuple[tuple[str, str], ...]:
    """Return the slots of the hands of a crew, each with its place at the box."""
    return tuple(zip(SLOTS, CREWS[crew], strict=False))


class Course(NamedTuple):
    """The progress of a movement at a time, each of shape ``(...)``.

    Attributes:
        closed: share of their gap that the hands have travelled, 0 to 1.
        closing: its rate [1/s].
        grip: share of the squeeze.
        loaded: share of the weight that the hands bear, at most `grip`.
        rise: planned height of the box above its start [m].
        rising: its rate [m/s].
    """

    closed: FloatArray
    closing: FloatArray
    grip: FloatArray
    loaded: FloatArray
    rise: FloatArray
    rising: FloatArray


def bearing(
    roles: Roles,
    start: State,
    squeeze: FloatArray,
    gaps: tuple[FloatArray, ...],
    course: Callable[[FloatArray], Course],
) -> Policy:
    """Return the impedance policy of all hands.

    Args:
        roles: hands and box.
        start: state at the beginning.
        squeeze: force with which each hand presses on its face, ``(...)`` [N].
        gaps: distance that each hand moves towards its face, ``(...)`` [m]; away from it if negative.
        course: elapsed time ``(...)`` [s] to the progress of the movement.
    """
    weight = load(roles.thing, roles.crew) * UP
    references = [
        (
            hand,
            start[hand, "position"].copy(),
            outward(start, roles.thing, place),
            gap[..., None],
            damping(hand["mass"]),
        )
        for (hand, place), gap in zip(roles.hands, gaps, strict=True)
    ]

    def policy(elapsed: FloatArray, state: State) -> Commands:
        closed, closing, grip, loaded, rise, rising = (np.asarray(each)[..., None] for each in course(elapsed))
        commands: Commands = {}
        for hand, begun, normal, gap, brake in references:
            place = begun - normal * (gap * closed) + UP * rise
            velocity = UP * rising - normal * (gap * closing)
            error = place - state[hand, "position"]
            # Hands reach their places approximately; for that, none must press harder than the others.
            given_way = normal * ((1.0 - _SOFTNESS) * grip * dot(error, normal)[..., None])
            push = STIFFNESS * (error - given_way) - normal * (squeeze[..., None] * grip)
            braking = brake * (velocity - state[hand, "velocity"])
            commands[hand.name, "force"] = push + braking + weight * loaded
        return commands

    return policy


def squeezing(crew: str) -> Hyperparameter:
    """Return the hyperparameter of the squeeze; its bound leaves the hands enough force to bear the box."""

    def initial(binding: Binding, state: State) -> FloatArray:
        return np.asarray(squeeze_for(get_token(binding, "object"), crew))

    def within(binding: Binding) -> tuple[float, float]:
        roles = Roles.of(crew, binding)
        return 0.0, min(largest_squeeze(hand, roles.thing, crew) for hand, _ in roles.hands)

    return Hyperparameter("squeeze", "N", 0.0, 1e5, initial, "force with which each hand squeezes the box", within)


def bearing_system(crew: str, binding: Binding, start: State) -> ContinuousSystem:
    """Make the system: Coulomb friction joins hands and box vertically as long as the hands press hard enough.

    The box keeps its orientation, moves up and down only, and stops at the floor. The faces stop the hands; the hands
    on the opposite side hold the box.
    """
    roles = Roles.of(crew, binding)
    thing, mass, coefficient = roles.thing, roles.thing["mass"], friction(roles.thing)

    def system(state: State, commands: Commands, dt: float) -> State:
        lowest = -corner_heights(state, thing).min(axis=-1) / dt
        """Vertical speed that brings the box to the floor in this step [m/s]."""
        sinking = state[thing, "velocity"][..., 2] - GRAVITY * dt
        moved = [(hand, *_pressed(state, hand, thing, place, commands, dt)) for hand, place in roles.hands]
        momentum, total = mass * sinking, mass * np.ones_like(sinking)
        for hand, velocity, press in moved:
            joined = np.where(press > 0.0, hand["mass"], 0.0)
            momentum, total = momentum + joined * velocity[..., 2], total + joined
        common = np.maximum(momentum / total, lowest)
        changes: dict[tuple[str, str], FloatArray] = {}
        lifting = np.zeros_like(common)
        for hand, velocity, press in moved:
            most = coefficient * press * dt
            impulse = np.clip(hand["mass"] * (velocity[..., 2] - common), -most, most)
            lifting = lifting + impulse
            after = velocity - UP * (impulse / hand["mass"])[..., None]
            changes[hand.name, "velocity"] = after
            changes[hand.name, "position"] = state[hand, "position"] + after * dt
        speed = np.maximum(sinking + lifting / mass, lowest)
        changes[thing.name, "position"] = state[thing, "position"] + UP * (speed * dt)[..., None]
        # On the floor the box is at rest, at any distance that it moved in this step.
        changes[thing.name, "velocity"] = UP * np.where(speed > lowest, speed, 0.0)[..., None]
        changes[thing.name, "angular_velocity"] = np.zeros_like(state[thing, "angular_velocity"])
        return state.replace(changes)

    return system


def _pressed(
    state: State, hand: Token, thing: Token, place: str, commands: Commands, dt: float
) -> tuple[FloatArray, FloatArray]:
    """Return a hand's velocity ``(..., 3)`` [m/s], stopped at its face, and the force ``(...)`` [N] that presses."""
    force, normal = force_on(hand, state, commands), outward(state, thing, place)
    velocity = state[hand, "velocity"] + force / hand["mass"] * dt
    gap = np.maximum(gap_at(state, hand, thing, place), 0.0)
    stopped = velocity + normal * np.maximum(-dot(velocity, normal) - gap / dt, 0.0)[..., None]
    return stopped, np.where(gap <= _TOUCH, np.maximum(-dot(force, normal), 0.0), 0.0)
