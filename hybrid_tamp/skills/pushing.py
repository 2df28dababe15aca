"""Pushing: a hand moves behind an object and pushes it along a straight line.

At a remaining distance e, the hand moves at the speed ``v = min(speed, sqrt(2 deceleration e))``, so that the object
stops after the chosen distance. A further force of the hand compensates the resistance of the object. Perpendicular to
the line, the hand follows the object. The forward model is one-dimensional along the line: the hand and the object meet
without a bounce, and the object slows down by friction. An object that leaves its support falls.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from hybrid_tamp.model.control import Commands, ContinuousSystem, Parameters, Policy
from hybrid_tamp.model.course import Course
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.constants import GRAVITY
from hybrid_tamp.motion.poses import cross, integrate, quaternion_from_axis_angle, quaternion_multiply, rotate
from hybrid_tamp.skills.alignment import ALIGNED, Alignment
from hybrid_tamp.skills.classes import can_turn
from hybrid_tamp.skills.extents import height_below
from hybrid_tamp.skills.roles import get_token
from hybrid_tamp.skills.servos import driven_velocity, keep_orientation, position_servo, turn_wrists
from hybrid_tamp.skills.steering import steer
from hybrid_tamp.skills.vectors import UP, dot

STANDOFF = 0.03
"""Gap between an object and a hand in its standby position [m]."""
_APPROACH_GAIN = 4.0
_APPROACH_SPEED = 0.15
_STEP = 0.05
"""Largest distance of an object between two states of a course [m]."""
_SPEED_RATE = 200.0
"""Rate at which the hand's speed converges to the wanted speed [1/s]."""


@dataclass(frozen=True)
class Resistance:
    """How an object resists a push, and how it slows down by itself.

    Attributes:
        force: force that moves the object at a constant speed [N].
        deceleration: deceleration of the object when nothing pushes it [m/s^2].
        inertia: force per acceleration of the object [kg]. For an object that rolls, more than its mass.
        radius: radius of an object that rolls [m], or None for an object that slides.
    """

    force: float
    deceleration: float
    inertia: float
    radius: float | None = None


@dataclass(frozen=True)
class Push:
    """A straight push. All functions take a binding with the roles `hand` and `object`, and all but one a state.

    A hand that can turn lies across the line of the push. Another hand pushes in its present orientation.

    Attributes:
        line: ``line(binding, state)`` returns the unit vector ``(..., 3)`` of the push, which is horizontal, and the
            distance ``(...)`` [m] of the push in this direction.
        touching: ``touching(binding, state, direction)`` returns the distance ``(...)`` [m] from the hand's centre to
            the object's centre along the line when both touch.
        beside: ``beside(binding, state)`` returns the point ``(..., 3)`` [m] that the hand follows perpendicular to the
            line, e.g. the object's centre.
        resistance: ``resistance(binding)`` returns the `Resistance` of the object.
        ground: ``ground(binding, state)`` returns the height ``(...)`` [m] of the surface below the object. None if the
            object keeps its height.
        steered: whether the object slides. Then a hand that touches the object at a point pushes beside its middle to
            counteract a turn. A hand that lies across the line keeps the object straight, and moves straight itself.
    """

    line: Callable[[Binding, State], tuple[FloatArray, FloatArray]]
    touching: Callable[[Binding, State, FloatArray], FloatArray]
    beside: Callable[[Binding, State], FloatArray]
    resistance: Callable[[Binding], Resistance]
    ground: Callable[[Binding, State], FloatArray] | None = None
    steered: bool = False

    def aligned(self, binding: Binding, state: State) -> State:
        """Return the state in which a hand that can turn is level and lies across the line of the push."""
        hand = get_token(binding, "hand")
        if not can_turn(hand):
            return state
        alignment = Alignment(lambda state, hand: self.across(binding, state), ALIGNED)
        return state.replace({(hand.name, "orientation"): alignment.orientation(state, hand)})

    def across(self, binding: Binding, state: State) -> FloatArray:
        """Return the horizontal unit vector ``(..., 3)`` across the line of the push."""
        return cross(UP, self.line(binding, state)[0])

    def standby(self, binding: Binding, state: State) -> FloatArray:
        """Return the position ``(..., 3)`` [m] of the hand's centre before the push, at a distance from the object."""
        state = self.aligned(binding, state)
        direction, _ = self.line(binding, state)
        behind = self.touching(binding, state, direction) + STANDOFF
        place = self.beside(binding, state)
        along = dot(place - state[get_token(binding, "object"), "position"], direction)
        return np.asarray(place - direction * (along + behind)[..., None])

    def policy(self, binding: Binding, start: State, parameters: Parameters) -> Policy:
        """Make the policy. Its hyperparameters are ``distance`` [m], ``speed`` [m/s] and ``deceleration`` [m/s^2]."""
        hand, thing = get_token(binding, "hand"), get_token(binding, "object")
        direction, _ = self.line(binding, start)
        origin = start[thing, "position"].copy()
        axes = np.stack([direction, self.across(binding, start)], axis=-2)
        lies_across = np.abs(dot(rotate(start[hand, "orientation"], UP), axes[..., 1, :])) > _ACROSS
        height = None if self.ground is None else self.beside(binding, start)[..., 2]
        chosen, resistance = parameters.hyperparameters, self.resistance(binding)
        distance, speed, braked = (np.asarray(chosen[name]) for name in ("distance", "speed", "deceleration"))
        braking = np.minimum(resistance.inertia * braked, resistance.force)
        rate, servo = _SPEED_RATE * hand["mass"], position_servo(hand)

        def policy(elapsed: FloatArray, state: State) -> Commands:
            centre = state[thing, "position"]
            remaining, dropped = distance - dot(centre - origin, direction), np.False_
            if height is not None:
                dropped = (origin - centre)[..., 2] > _DROP
                remaining = np.where(dropped, 0.0, remaining)
            wanted = np.minimum(speed, np.sqrt(2 * braked * np.maximum(remaining, 0.0)))
            gap = dot(centre - state[hand, "position"], direction) - self.touching(binding, state, direction)
            closing = np.where(remaining > 0, np.clip(_APPROACH_GAIN * gap, 0.0, _APPROACH_SPEED), 0.0)
            velocity = dot(state[hand, "velocity"], direction)
            push = rate * (wanted + closing - velocity)
            # A slowing object needs a smaller force. Otherwise, a heavy object would lag behind the hand.
            bearing = resistance.force - np.where(wanted < speed, braking, 0.0)
            push = push + np.where((remaining > 0) & (gap < STANDOFF / 2), bearing, 0.0)
            # The hand controls its speed along the line, and its position perpendicular to the line.
            beside = self.beside(binding, state)
            if self.steered:
                aside, _ = steer(state, thing, origin, axes, remaining)
                aside, across = np.where(dropped | lies_across, 0.0, aside), axes[..., 1, :]
                beside = beside + (aside - dot(beside - origin, across))[..., None] * across
            if height is not None:  # The hand does not follow an object that falls.
                beside = np.concatenate([beside[..., :2], height[..., None]], axis=-1)
            follow = servo(state, beside)
            follow = follow - dot(follow, direction)[..., None] * direction
            return {(hand.name, "force"): follow + push[..., None] * direction}

        return turn_wrists(policy, {hand: keep_orientation(self.aligned(binding, start)[hand, "orientation"])})

    def sweep(self, binding: Binding, start: State, parameters: Parameters) -> Course | None:
        """Return the course of a hand that closes the gap, and then moves on with the object. None if the object falls.

        Args:
            binding: the hand, the object and the targets.
            start: state at the beginning, without batch dimensions.
            parameters: parameters with the hyperparameter ``distance`` [m].
        """
        hand, thing = get_token(binding, "hand"), get_token(binding, "object")
        direction, _ = self.line(binding, start)
        radius, aligned = self.resistance(binding).radius, self.aligned(binding, start)
        distance = max(float(parameters.hyperparameters["distance"]), 0.0)
        count = int(np.ceil(distance / (_STEP if radius is None else min(_STEP, radius / 2.0)))) + 1
        pushed = np.concatenate([[0.0], np.linspace(0.0, distance, count)])[:, None]
        touching = self.standby(binding, start) + direction * STANDOFF
        values = {
            (hand.name, "position"): touching + pushed * direction,
            (hand.name, "orientation"): np.repeat(aligned[hand, "orientation"][None], count + 1, axis=0),
            (thing.name, "position"): start[thing, "position"] + pushed * direction,
        }
        if radius is not None:
            turned = quaternion_from_axis_angle(cross(UP, direction), pushed[:, 0] / radius)
            values[thing.name, "orientation"] = quaternion_multiply(turned, start[thing, "orientation"])
        for name in ("position", "orientation"):
            values[hand.name, name][0] = start[hand, name]
        course = Course.through(start, values)
        if self.ground is None:
            return course
        above = self._above(binding, course.states, height_below(start, thing))
        return None if np.any(above > _DROP) else course

    def system(self, binding: Binding, start: State) -> ContinuousSystem:
        """Make the system of a hand that pushes an object along the line. The object does not bounce."""
        hand, thing = get_token(binding, "hand"), get_token(binding, "object")
        resistance, mass = self.resistance(binding), hand["mass"]
        whole = mass + resistance.inertia
        forward, _ = self.line(binding, start)
        level = None if self.ground is None else height_below(start, thing)

        def system(state: State, commands: Commands, dt: float) -> State:
            moving = dot(state[thing, "velocity"], forward)
            # An object that was pushed past its goal and rolls back would move against the line.
            direction = np.where((moving < -1e-9)[..., None], -forward, forward)
            hand_velocity = driven_velocity(hand, state, commands, dt)
            along = dot(hand_velocity, direction)
            above = None if level is None else self._above(binding, state, level)
            falls = np.False_ if above is None else above > _TOUCH
            alone = np.maximum(0.0, np.abs(moving) - np.where(falls, 0.0, resistance.deceleration) * dt)
            gap = dot(state[thing, "position"] - state[hand, "position"], direction)
            gap = gap - self.touching(binding, state, direction)
            touches = (gap <= (along - alone) * dt + 1e-6) & (along > alone) & ~falls
            common = np.maximum(0.0, (mass * along + resistance.inertia * alone) / whole)
            alone = np.where(touches, common, alone)
            hand_velocity = hand_velocity + (np.where(touches, common, along) - along)[..., None] * direction
            velocity = alone[..., None] * direction
            if above is not None:
                sinking = np.maximum(state[thing, "velocity"][..., 2] - GRAVITY * dt, -above / dt)
                velocity = velocity + np.where(falls, sinking, 0.0)[..., None] * UP
            changes = {
                (hand.name, "velocity"): hand_velocity,
                (hand.name, "position"): state[hand, "position"] + hand_velocity * dt,
                (thing.name, "velocity"): velocity,
                (thing.name, "position"): state[thing, "position"] + velocity * dt,
            }
            if resistance.radius is not None:
                spin = cross(UP, velocity) / resistance.radius
                changes[thing.name, "angular_velocity"] = spin
                changes[thing.name, "orientation"] = integrate(state[thing, "orientation"], spin, dt)
            return state.replace(changes)

        return system

    def _above(self, binding: Binding, state: State, level: FloatArray) -> FloatArray:
        """Return the height ``(...)`` [m] of an object above the surface below."""
        assert self.ground is not None, "only an object that can fall has a level"
        return np.asarray(state[get_token(binding, "object"), "position"][..., 2] - self.ground(binding, state) - level)


_ACROSS = 0.7
"""Smallest cosine of the angle between the axis of a hand and the horizontal across the push, for a flat contact."""
_DROP = 0.01
"""Fall after which an object no longer lies on the surface on which the hand pushed it [m]."""
_TOUCH = 1e-6
"""Largest height above a surface at which an object counts as lying on the surface [m]."""
