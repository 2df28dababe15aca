"""Dynamics of a hand and the object that it holds, which move as one rigid body.

The hand is at x, and the centre of mass of the object is at x + r. The Newton-Euler equations are::

    m_hand x'' = F - f,     m (x + r)'' = f + w,     (I + I_wrist) alpha = T - r x f + n

F and T are the basic actions, and f is the force of the hand on the object. The weight of the object and the contact
forces sum to w and have the moment n. The body turns about the object's y axis, so
(x + r)'' = x'' + alpha x r - omega^2 r, and I is the moment of inertia about this axis. Turns about other axes are
slow, so the same I is used for them. The hand's own weight is compensated.

The grip must bear f and the torque on the object. If they exceed the limit surface of the grip (`grip_limits`), the
model does not compute how far the object slides. The object then counts as lost.
"""

from dataclasses import dataclass

import numpy as np

from hybrid_tamp.model.control import Commands, ContinuousSystem, SystemMaker
from hybrid_tamp.model.grasp import CAPTURE, grip_limits
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.constants import GRAVITY
from hybrid_tamp.motion.limit_surface import load_ratio
from hybrid_tamp.motion.poses import (
    cross,
    quaternion_conjugate,
    quaternion_from_rotation_vector,
    quaternion_multiply,
    rotate,
)
from hybrid_tamp.skills.handles import hand_in, off_handle
from hybrid_tamp.skills.knocks import Changes, Mass
from hybrid_tamp.skills.roles import get_tokens
from hybrid_tamp.skills.servos import DAMPING_RATIO, turning_rate
from hybrid_tamp.skills.vectors import UP, dot

_LIFT = GRAVITY * UP
"""Upward acceleration that compensates gravity [m/s^2]."""
POSITION_RATE = 60.0
"""Natural frequency of the position servo of a hand that holds an object [rad/s]."""


@dataclass(frozen=True, eq=False)
class Load:
    """A force on a held object, in addition to the object's weight and the hand's force.

    Attributes:
        force: force ``(..., 3)`` [N].
        point: point of application of the force ``(..., 3)`` [m].
    """

    force: FloatArray
    point: FloatArray


class HeldBody:
    """A hand and the object that it holds, as one rigid body. All states have the same batch shape ``(...)``."""

    def __init__(self, hand: Token, thing: Token) -> None:
        self.hand, self.thing = hand, thing
        self._hand_mass, self._thing_mass = hand["mass"], thing["mass"]
        self._mass = self._hand_mass + self._thing_mass
        self._reduced = self._thing_mass * self._hand_mass / self._mass
        self._own_inertia = thing["inertia"][1] + hand["wrist_inertia"]
        self._limits = grip_limits(hand, thing, hand["maximal_grip"])

    def wrench(self, state: State, acceleration: FloatArray, turning: FloatArray, load: Load | None = None) -> Commands:
        """Return the basic actions for given accelerations of the body (inverse dynamics).

        Args:
            state: current state.
            acceleration: acceleration of the hand ``(..., 3)`` [m/s^2].
            turning: angular acceleration of the body ``(..., 3)`` [rad/s^2].
            load: additional force on the object, or None.
        """
        hand, thing = self.hand, self.thing
        arm = state[thing, "position"] - state[hand, "position"]
        spin = state[thing, "angular_velocity"]
        moving = acceleration + cross(turning, arm) - dot(spin, spin)[..., None] * arm
        force = self._thing_mass * (moving + _LIFT)
        torque = self._own_inertia * turning
        if load is not None:
            force = force - load.force
            torque = torque - cross(load.point - state[thing, "position"], load.force)
        return {
            (hand.name, "force"): self._hand_mass * acceleration + force,
            (hand.name, "torque"): torque + cross(arm, force),
            (hand.name, "grip"): np.full((*arm.shape[:-1], 1), hand["maximal_grip"]),
        }

    def servo(
        self,
        state: State,
        position: tuple[FloatArray, FloatArray],
        orientation: tuple[FloatArray, FloatArray],
        load: Load | None = None,
    ) -> Commands:
        """Return the basic actions that keep the body on a moving reference.

        Args:
            state: current state.
            position: reference position [m] and velocity [m/s] of the hand, each ``(..., 3)``.
            orientation: reference orientation ``(..., 4)`` and angular velocity ``(..., 3)`` [rad/s] of the object.
            load: additional force on the object, or None.
        """
        turning = turning_rate(state, self.thing, *orientation)
        return self.wrench(state, keep_on(state, self.hand, *position), turning, load)

    def accelerated(self, state: State, commands: Commands, dt: float) -> tuple[FloatArray, FloatArray]:
        """Return the hand's velocity [m/s] and the body's angular velocity [rad/s], each ``(..., 3)``, after a step.

        The basic actions and the weight of the object accelerate the body.
        """
        arm = state[self.thing, "position"] - state[self.hand, "position"]
        spin = state[self.thing, "angular_velocity"]
        commanded = commands[self.hand.name, "force"]
        pushed = commanded / self._hand_mass + _LIFT
        inertia = self._own_inertia + self._reduced * dot(arm, arm)
        turning = (commands[self.hand.name, "torque"] - self._reduced * cross(arm, pushed)) / inertia[..., None]
        force = self._reduced * (pushed + cross(turning, arm) - dot(spin, spin)[..., None] * arm)
        return state[self.hand, "velocity"] + (commanded - force) * (dt / self._hand_mass), spin + turning * dt

    def grip_load(self, state: State, changes: Changes, dt: float, load: Load | None = None) -> FloatArray:
        """Return the ratio ``(...)`` of the grip's load during a step to the limit surface of the grip.

        Args:
            state: state before the step.
            changes: poses and velocities after the step (see `placed`).
            dt: duration of the step [s].
            load: additional force on the object, or None.
        """
        hand, thing = self.hand, self.thing
        arm = state[thing, "position"] - state[hand, "position"]
        spinning = changes[thing.name, "angular_velocity"] - state[thing, "angular_velocity"]
        force = self._thing_mass * ((changes[thing.name, "velocity"] - state[thing, "velocity"]) / dt + _LIFT)
        torque = thing["inertia"][1] * spinning / dt
        if load is not None:
            force = force - load.force
            torque = torque - cross(load.point - state[thing, "position"], load.force)
        wrench = np.stack([force, torque + cross(arm, force)], axis=-2)
        seen = rotate(quaternion_conjugate(state[thing, "orientation"])[..., None, :], wrench)
        return load_ratio(seen.reshape(*seen.shape[:-2], 6), self._limits)

    def loosened(self, changes: Changes, state: State, ratio: FloatArray) -> Changes:
        """Return poses and velocities after a step, with the object out of the fingers where the load is too large.

        Args:
            changes: poses and velocities after a step in which no object slips.
            state: state before the step.
            ratio: load of the grip during the step (see `grip_load`).
        """
        over = ratio > 1.0
        if not over.any():
            return changes
        lost = over & (off_handle(state, self.hand, self.thing) <= CAPTURE)
        key = (self.thing.name, "position")
        out = 2.0 * CAPTURE * rotate(state[self.thing, "orientation"], UP)
        return changes | {key: np.where(lost[..., None], changes[key] + out, changes[key])}

    def placed(self, state: State, velocity: FloatArray, spin: FloatArray, dt: float) -> Changes:
        """Return the poses and velocities of hand and object after a step (semi-implicit Euler with exact rotation).

        `velocity` [m/s] of the hand and `spin` [rad/s] of the body, each ``(..., 3)``, are the values after the step.
        """
        hand, thing = self.hand, self.thing
        turn = quaternion_from_rotation_vector(spin * dt)
        arm = rotate(turn, state[thing, "position"] - state[hand, "position"])
        position = state[hand, "position"] + velocity * dt
        return {
            (hand.name, "position"): position,
            (hand.name, "velocity"): velocity,
            (hand.name, "orientation"): quaternion_multiply(turn, state[hand, "orientation"]),
            (hand.name, "angular_velocity"): spin,
            (thing.name, "position"): position + arm,
            (thing.name, "velocity"): velocity + cross(spin, arm),
            (thing.name, "orientation"): quaternion_multiply(turn, state[thing, "orientation"]),
            (thing.name, "angular_velocity"): spin,
        }

    def whole(self, state: State) -> Mass:
        """Return the mass of the hand with the object."""
        arm = state[self.thing, "position"] - state[self.hand, "position"]
        inertia = self._own_inertia + self._reduced * dot(arm, arm)
        centre = state[self.hand, "position"] + arm * (self._thing_mass / self._mass)
        return centre, float(self._mass), inertia


def pose_held(
    state: State, hand: Token, thing: Token, place: FloatArray, orientation: FloatArray
) -> dict[tuple[str, str], FloatArray]:
    """Return the poses of a hand at a place ``(..., 3)`` [m] and of its object with an orientation ``(..., 4)``."""
    arm = rotate(orientation, hand_in(state, hand, thing))
    return {
        (hand.name, "position"): place,
        (thing.name, "position"): place - arm,
        (thing.name, "orientation"): orientation,
    }


def sweep_held(
    start: State, hand: Token, thing: Token, places: FloatArray, orientations: FloatArray
) -> dict[tuple[str, str], FloatArray]:
    """Return the poses of a hand and the object that it holds along a course, for `Course.through`.

    Args:
        start: state at the beginning, without batch dimensions.
        hand: the hand, which turns with the object.
        thing: the object.
        places: positions of the hand ``(k, 3)`` [m].
        orientations: orientations of the object ``(k, 4)``.
    """
    turned = quaternion_multiply(orientations, quaternion_conjugate(start[thing, "orientation"]))
    poses = pose_held(start, hand, thing, places, orientations)
    return poses | {(hand.name, "orientation"): quaternion_multiply(turned, start[hand, "orientation"])}


def keep_on(
    state: State,
    hand: Token,
    position: FloatArray,
    velocity: FloatArray | float,
    acceleration: FloatArray | float = 0.0,
) -> FloatArray:
    """Return the acceleration ``(..., 3)`` [m/s^2] that keeps a hand on a moving reference."""
    error, drift = position - state[hand, "position"], velocity - state[hand, "velocity"]
    return np.asarray(acceleration + POSITION_RATE**2 * error + 2.0 * DAMPING_RATIO * POSITION_RATE * drift)


def held_system(role: str) -> SystemMaker:
    """Return the maker of the system in which a hand carries the object of a role as one rigid body.

    If the load of the grip exceeds its limits, the object counts as lost.
    """

    def make(binding: Binding, start: State) -> ContinuousSystem:
        held = HeldBody(*get_tokens(binding, "hand", role))

        def system(state: State, commands: Commands, dt: float) -> State:
            changes = held.placed(state, *held.accelerated(state, commands, dt), dt)
            return state.replace(held.loosened(changes, state, held.grip_load(state, changes, dt)))

        return system

    return make
