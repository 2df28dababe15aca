"""Policy and forward model that LIFTING, HOLDING and LOWERING share, for hands that bear a box between them.

Let x and v be the position and velocity of a hand. The hand follows a reference c that moves with the box. Its force is
F = K (c - x) + D (c' - v) - S n + W z. Here n is the outward normal of the hand's face, S is the squeeze, W is the
hand's share of the weight and z points up. The stiffness K is smaller along n. Only friction joins a hand to the box:
each hand bears at most mu times its force on the face. Under a larger load, the box slips in the forward model, too.
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
from hybrid_tamp.skills import STIFFNESS, UP, damping, dot, driven_velocity, force_on, get_token, stop_at_face

from .load import friction, largest_squeeze, load, squeeze_for
from .places import CREWS, corner_heights, gap_at, outward

SLOTS = ("first", "second", "third", "fourth")
"""Slots of the hands, in the same order as the places in `CREWS`."""
_SOFTNESS = 0.1
"""Ratio of a squeezing hand's stiffness along the normal of its face to its stiffness K in the other directions.

Two hands at a distance L, which push against each other with a force S, buckle unless S < K L / 2. Buckling hands turn
the box about the vertical axis. So K must be large.
"""
_TOUCH = 1e-4


@dataclass(frozen=True)
class Roles:
    """The hands and the box of a block instance.

    Attributes:
        crew: symbol for the number of hands.
        hands: pairs of (hand, place).
        thing: the box.
    """

    crew: str
    hands: tuple[tuple[Token, str], ...]
    thing: Token

    @classmethod
    def of(cls, crew: str, binding: Binding) -> "Roles":
        """Return the roles in a binding."""
        hands = tuple((get_token(binding, slot), place) for slot, place in places_of(crew))
        return cls(crew, hands, get_token(binding, "object"))


def places_of(crew: str) -> tuple[tuple[str, str], ...]:
    """Return a pair of (slot, place) for each hand of a crew."""
    return tuple(zip(SLOTS, CREWS[crew], strict=False))


class Course(NamedTuple):
    """The progress of a movement at given times. All fields have the shape ``(...)``.

    Attributes:
        closed: closed fraction of the gap between hand and face, from 0 to 1.
        closing: rate of `closed` [1/s].
        grip: applied fraction of the full squeeze, from 0 to 1.
        loaded: supported fraction of the box's weight, from 0 to `grip`.
        rise: planned height of the box above its initial height [m].
        rising: rate of `rise` [m/s].
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
        roles: the hands and the box.
        start: state at the beginning of the movement.
        squeeze: force ``(...)`` [N] with which each hand presses on its face.
        gaps: distance ``(...)`` [m] that each hand moves towards its face. A hand with a negative value moves away.
        course: maps the elapsed time ``(...)`` [s] to the progress of the movement.
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
            # Hands reach their places only approximately. The lower stiffness lets all hands press equally hard.
            given_way = normal * ((1.0 - _SOFTNESS) * grip * dot(error, normal)[..., None])
            push = STIFFNESS * (error - given_way) - normal * (squeeze[..., None] * grip)
            braking = brake * (velocity - state[hand, "velocity"])
            commands[hand.name, "force"] = push + braking + weight * loaded
        return commands

    return policy


def squeezing(crew: str) -> Hyperparameter:
    """Return the hyperparameter `squeeze`. Its upper bound leaves the hands enough force to bear the box."""

    def initial(binding: Binding, state: State) -> FloatArray:
        return np.asarray(squeeze_for(get_token(binding, "object"), crew))

    def within(binding: Binding) -> tuple[float, float]:
        roles = Roles.of(crew, binding)
        return 0.0, min(largest_squeeze(hand, roles.thing, crew) for hand, _ in roles.hands)

    return Hyperparameter("squeeze", "N", 0.0, 1e5, initial, "force with which each hand squeezes the box", within)


def bearing_system(crew: str, binding: Binding, start: State) -> ContinuousSystem:
    """Return the system in which Coulomb friction joins the hands to the box while the hands press hard enough.

    The box keeps its orientation, moves only up and down, and stops at the floor. Each hand stops at its face,
    because the hands on the opposite face keep the box in place.
    """
    roles = Roles.of(crew, binding)
    thing, mass, coefficient = roles.thing, roles.thing["mass"], friction(roles.thing)

    def system(state: State, commands: Commands, dt: float) -> State:
        lowest = -corner_heights(state, thing).min(axis=-1) / dt
        """Vertical velocity [m/s] with which the box reaches the floor at the end of this step."""
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
        # A box that reaches the floor in this step is at rest after the step.
        changes[thing.name, "velocity"] = UP * np.where(speed > lowest, speed, 0.0)[..., None]
        changes[thing.name, "angular_velocity"] = np.zeros_like(state[thing, "angular_velocity"])
        return state.replace(changes)

    return system


def _pressed(
    state: State, hand: Token, thing: Token, place: str, commands: Commands, dt: float
) -> tuple[FloatArray, FloatArray]:
    """Return a hand's velocity ``(..., 3)`` [m/s], limited by its face, and its force ``(...)`` [N] on the face."""
    force, normal = force_on(hand, state, commands), outward(state, thing, place)
    gap = gap_at(state, hand, thing, place)
    stopped = stop_at_face(driven_velocity(hand, state, commands, dt), normal, gap, dt)
    return stopped, np.where(gap <= _TOUCH, np.maximum(-dot(force, normal), 0.0), 0.0)
