"""Policy and forward models of hands that bear a box between them.

The policy is that of `hybrid_tamp.skills.press`. Each hand also bears its share of the weight. The stiffness of a hand
is smaller along the normal of its face. Only friction joins a hand to the box: each hand bears at most mu times its
force on the face. Under a larger load, the box slips in the forward model, too.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from hybrid_tamp.authoring import (
    GRAVITY,
    Binding,
    Commands,
    ContinuousSystem,
    Course,
    FloatArray,
    Parameters,
    Policy,
    Profile,
    State,
    sample_times,
)
from hybrid_tamp.skills import (
    UP,
    Pressure,
    Reference,
    dot,
    driven_velocity,
    force_on,
    gap_to_face,
    keep_orientation,
    meet_face,
    norm,
    normal,
    press,
    stop_at_face,
    sweep_pressed,
    touches_face,
    turn_hand,
    turn_wrists,
)

from .load import friction, load
from .places import VERTICAL, Roles, height

_SOFTNESS = 0.1
"""Ratio of a squeezing hand's stiffness along the normal of its face to its stiffness K in the other directions.

Two hands at a distance L, which push against each other with a force S, buckle unless S < K L / 2. Buckling hands turn
the box about the vertical axis. So K must be large.
"""


class Plan(NamedTuple):
    """The planned movement of hands that bear a box.

    Attributes:
        gaps: distance ``(...)`` [m] that each hand moves towards its face.
        course: maps the elapsed time ``(...)`` [s] to six quantities: the closed fraction of the gap between
            hand and face, its rate [1/s], the applied fraction of the squeeze, the supported fraction of the weight of
            the box, the planned displacement of the box ``(..., 3)`` [m], and its velocity ``(..., 3)`` [m/s].
        duration: duration ``(...)`` [s].
    """

    gaps: Sequence[FloatArray]
    course: Reference
    duration: FloatArray


PlanMaker = Callable[[Roles, Profile, Binding, State, Parameters], Plan]
"""``make_plan(roles, profile, binding, start, parameters)`` returns the planned movement."""


def sweep_bearing(
    crew: str, profile: Profile, make_plan: PlanMaker, binding: Binding, start: State, parameters: Parameters
) -> Course:
    """Return the course of all hands and of the box, which moves as planned."""
    roles = Roles.of(crew, binding)
    plan = make_plan(roles, profile, binding, start, parameters)
    times = sample_times(plan.duration)
    closed, closing, grip, _, moved, moving = plan.course(times)
    upright = {hand: VERTICAL.orientation(start, hand) for hand, _ in roles.hands}
    planned = Pressure(closed, closing, grip, moved, moving)
    return sweep_pressed(roles.contacts, roles.thing, start, plan.gaps, times, planned, orientations=upright)


def bear(
    crew: str, profile: Profile, make_plan: PlanMaker, binding: Binding, start: State, parameters: Parameters
) -> Policy:
    """Return the policy of all hands. The parameters contain the hyperparameter ``squeeze``."""
    roles = Roles.of(crew, binding)
    gaps, course, _ = make_plan(roles, profile, binding, start, parameters)
    weight = load(roles.thing, roles.crew) * UP

    def plan(elapsed: FloatArray, state: State) -> Pressure:
        closed, closing, grip, loaded, moved, moving = course(elapsed)
        return Pressure(closed, closing, grip, moved, moving, bearing=weight * loaded[..., None])

    squeeze = np.asarray(parameters.hyperparameters["squeeze"])
    policy = press(roles.contacts, roles.thing, start, gaps, squeeze, plan, softness=_SOFTNESS)
    upright = {hand: keep_orientation(VERTICAL.orientation(start, hand)) for hand, _ in roles.hands}
    return turn_wrists(policy, upright)


def bearing_system(crew: str, binding: Binding, start: State) -> ContinuousSystem:
    """Return the system in which Coulomb friction joins the hands to the box while the hands press hard enough.

    The box keeps its orientation, moves only up and down, and stops at the floor. Each hand stops at its face,
    because the hands on the opposite face keep the box in place.
    """
    roles = Roles.of(crew, binding)
    thing, mass, coefficient = roles.thing, roles.thing["mass"], friction(roles.thing)

    def system(state: State, commands: Commands, dt: float) -> State:
        lowest = -height(state, thing) / dt
        """Vertical velocity [m/s] with which the box reaches the floor at the end of this step."""
        sinking = state[thing, "velocity"][..., 2] - GRAVITY * dt
        moved = []
        momentum, total = mass * sinking, mass * np.ones_like(sinking)
        for hand, face in roles.contacts:
            outward, gap = normal(state, thing, face), gap_to_face(state, hand, thing, face)
            velocity, touches = meet_face(state, hand, outward, gap, commands, dt)
            force = np.where(touches, np.maximum(-dot(force_on(hand, state, commands), outward), 0.0), 0.0)
            joined = np.where(force > 0.0, hand["mass"], 0.0)
            momentum, total = momentum + joined * velocity[..., 2], total + joined
            moved.append((hand, velocity, force))
        common = np.maximum(momentum / total, lowest)
        changes: dict[tuple[str, str], FloatArray] = {}
        lifting = np.zeros_like(common)
        for hand, velocity, force in moved:
            most = coefficient * force * dt
            impulse = np.clip(hand["mass"] * (velocity[..., 2] - common), -most, most)
            lifting = lifting + impulse
            after = velocity - UP * (impulse / hand["mass"])[..., None]
            changes[hand.name, "velocity"] = after
            changes[hand.name, "position"] = state[hand, "position"] + after * dt
            changes |= turn_hand(hand, state, commands, dt)
        speed = np.maximum(sinking + lifting / mass, lowest)
        changes[thing.name, "position"] = state[thing, "position"] + UP * (speed * dt)[..., None]
        # A box that reaches the floor in this step is at rest after the step.
        changes[thing.name, "velocity"] = UP * np.where(speed > lowest, speed, 0.0)[..., None]
        changes[thing.name, "angular_velocity"] = np.zeros_like(state[thing, "angular_velocity"])
        return state.replace(changes)

    return system


def carried_system(crew: str, binding: Binding, start: State) -> ContinuousSystem:
    """Return the system in which Coulomb friction joins the hands to a box that moves in all directions.

    The box keeps its orientation, and stops at the floor. The bodies that press on each other meet without a bounce, so
    they have a common velocity unless a hand slips along its face.
    """
    roles = Roles.of(crew, binding)
    thing, mass, coefficient = roles.thing, roles.thing["mass"], friction(roles.thing)

    def system(state: State, commands: Commands, dt: float) -> State:
        lowest = -height(state, thing) / dt
        """Vertical velocity [m/s] with which the box reaches the floor at the end of this step."""
        falling = state[thing, "velocity"] - GRAVITY * dt * UP
        moved = []
        momentum, total = mass * falling, mass * np.ones_like(lowest)
        for hand, face in roles.contacts:
            outward, gap = normal(state, thing, face), gap_to_face(state, hand, thing, face)
            velocity = driven_velocity(hand, state, commands, dt)
            pressing = np.where(touches_face(gap), -dot(force_on(hand, state, commands), outward), 0.0)
            joined = np.where(pressing > 0.0, hand["mass"], 0.0)
            momentum, total = momentum + joined[..., None] * velocity, total + joined
            moved.append((hand, outward, gap, velocity, joined))
        common = _not_below(momentum / total[..., None], lowest)
        changes: dict[tuple[str, str], FloatArray] = {}
        given = np.zeros_like(common)
        for hand, outward, gap, velocity, joined in moved:
            impulse = _passed_on(joined[..., None] * (velocity - common), outward, coefficient)
            given = given + impulse
            left = velocity - impulse / hand["mass"]
            after = common + stop_at_face(left - common, outward, gap, dt)
            changes[hand.name, "velocity"] = after
            changes[hand.name, "position"] = state[hand, "position"] + after * dt
            changes |= turn_hand(hand, state, commands, dt)
        carried = _not_below(falling + given / mass, lowest)
        changes[thing.name, "position"] = state[thing, "position"] + carried * dt
        changes[thing.name, "velocity"] = carried
        changes[thing.name, "angular_velocity"] = np.zeros_like(state[thing, "angular_velocity"])
        return state.replace(changes)

    return system


def _passed_on(impulse: FloatArray, outward: FloatArray, coefficient: float) -> FloatArray:
    """Return the part ``(..., 3)`` [N s] of an impulse of a hand that Coulomb friction passes on to a face."""
    inward = np.maximum(-dot(impulse, outward), 0.0)[..., None]
    along = impulse - dot(impulse, outward)[..., None] * outward
    most = coefficient * inward / np.maximum(norm(along)[..., None], 1e-12)
    return np.asarray(along * np.minimum(most, 1.0) - outward * inward)


def _not_below(velocity: FloatArray, lowest: FloatArray) -> FloatArray:
    """Return a velocity ``(..., 3)`` [m/s] with a limited rate of descent."""
    return np.asarray(velocity + UP * np.maximum(lowest - velocity[..., 2], 0.0)[..., None])
