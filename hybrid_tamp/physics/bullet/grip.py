"""The contact between the pads of a hand and a handle: a stiff spring with a return mapping on a limit surface.

No joint connects hand and handle. In each substep, the wrench of the pads is that of a step of backward Euler for the
relative motion of both bodies, so the spring may be as stiff as a substep resolves. With the relative velocity v,
the elastic displacement e, the effective mobility A at the hand's centre, and the acceleration a without the grip::

    w = -(K (e + dt v') + D v'),     v' = v + dt (a + A w)

If w exceeds the limit surface, it is mapped back (`motion.limit_surface`), and the rest pose of the spring moves until
the spring and the damper give the mapped wrench: the handle slides in the hand. The wrench acts on both bodies at the
same point, so it changes neither momentum nor angular momentum.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pybullet

from hybrid_tamp.model.grasp import grip_axes, grip_limits
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.limit_surface import map_back
from hybrid_tamp.motion.poses import (
    quaternion_from_rotation_vector,
    quaternion_multiply,
)
from hybrid_tamp.physics.bullet.engine import SUBSTEP
from hybrid_tamp.physics.scene import Body

RATE = 1.0 / SUBSTEP
"""Natural frequency of the spring, with the effective mass of each component [rad/s]."""
Vector = Sequence[float]
"""Vector of three numbers, or quaternion. Small tuples are faster than arrays."""
_SPRING = (RATE * SUBSTEP) ** 2
_DAMPER = 2.0 * RATE * SUBSTEP


@dataclass(frozen=True, eq=False)
class Grasp:
    """A gripped object and the pose of the hand in the frame of the object at which the spring is at rest.

    The pose has six degrees of freedom. It changes only if the handle slides in the hand.

    Attributes:
        thing: the object.
        position: position of the hand's centre ``(3,)`` [m].
        orientation: orientation of the hand ``(4,)``.
    """

    thing: Token
    position: FloatArray
    orientation: FloatArray


@dataclass(frozen=True)
class Side:
    """One of the two bodies of a contact: PyBullet's handle, and the body's mass and inertia."""

    handle: int
    body: Body


class Contact:
    """The pads of a hand on a handle, for one grip force and one rest position.

    Args:
        hand: hand that grips.
        sides: bodies of the hand and of the object.
        grasp: grasp at the beginning of the period.
        force: force of each finger [N].
        gravity: acceleration of free fall ``(3,)`` [m/s^2].
        client: PyBullet's identifier of the client.
    """

    def __init__(
        self, hand: Token, sides: tuple[Side, Side], grasp: Grasp, force: float, gravity: Sequence[float], client: int
    ) -> None:
        self.grasp, self.force, self._sides, self._client, self._gravity = grasp, force, sides, client, gravity
        self._began_at = grasp.position
        self._axes = grip_axes(grasp.thing)
        self._limits = grip_limits(hand, grasp.thing, force)
        self._mobility = _effective_mobility(sides, self._axes, grasp.position)
        mass = 1.0 / np.diag(self._mobility)
        self._stiffness, self._damping = mass * (_SPRING / SUBSTEP**2), mass * (_DAMPER / SUBSTEP)
        self._slope = self._damping + self._stiffness * SUBSTEP
        self._inverse = np.linalg.inv(np.eye(6) + SUBSTEP * self._slope[:, None] * self._mobility)
        self._compliance = np.diag(1.0 / self._slope) + SUBSTEP * self._mobility

    def holds_for(self, grasp: Grasp, force: float) -> bool:
        """Return whether the matrices of this contact are those of a grasp and of a force of each finger [N]."""
        return grasp.thing is self.grasp.thing and grasp.position is self._began_at and force == self.force

    def apply(self, force: Sequence[float], torque: Sequence[float]) -> None:
        """Apply the wrench of the pads for one substep.

        Args:
            force: commanded force on the hand ``(3,)`` [N], without the support of its weight.
            torque: commanded torque on the hand ``(3,)`` [N m].
        """
        (hand_at, hand_turn), (thing_at, thing_turn) = map(self._pose, self._sides)
        world_from_grip = np.array(pybullet.getMatrixFromQuaternion(thing_turn)).reshape(3, 3) @ self._axes.T
        arm = _minus(hand_at, thing_at)
        turned = self._turned(hand_turn, thing_turn)
        seen = np.array([arm, *self._relative_motion(arm, force, torque)]) @ world_from_grip
        elastic = np.concatenate([seen[0] - self._axes @ self.grasp.position, self._axes @ turned])
        free = seen[1:3].ravel() + SUBSTEP * seen[3:].ravel()
        trial = -(self._inverse @ (self._stiffness * elastic + self._slope * free))
        wrench = map_back(trial, self._compliance, self._limits)
        if wrench is not trial:
            after = free + SUBSTEP * (self._mobility @ wrench)
            self._slide(elastic + SUBSTEP * after + (wrench + self._damping * after) / self._stiffness)
        self._push((wrench.reshape(2, 3) @ world_from_grip.T).tolist(), hand_at)

    def _slide(self, slip: FloatArray) -> None:
        """Move the rest pose by a displacement and a rotation vector in the frame of the grip, shape ``(6,)``."""
        position = self.grasp.position + slip[:3] @ self._axes
        turn = quaternion_from_rotation_vector(slip[3:] @ self._axes)
        self.grasp = Grasp(self.grasp.thing, position, quaternion_multiply(turn, self.grasp.orientation))

    def _pose(self, side: Side) -> tuple[Vector, Vector]:
        position, orientation = pybullet.getBasePositionAndOrientation(side.handle, physicsClientId=self._client)
        return position, orientation

    def _turned(self, hand_turn: Vector, thing_turn: Vector) -> Vector:
        """Return the small rotation vector ``(3,)`` [rad] of the hand from its rest pose, in the object's frame."""
        relative = _multiply(_conjugate(thing_turn), hand_turn)
        x, y, z, w = _multiply(relative, _conjugate(self.grasp.orientation.tolist()))
        double = math.copysign(2.0, w)
        return double * x, double * y, double * z

    def _relative_motion(self, arm: Vector, force: Vector, torque: Vector) -> tuple[Vector, Vector, Vector, Vector]:
        """Return velocity and spin of the hand relative to the turning object, and the changes of both per second.

        All vectors ``(3,)`` are in the world frame. The changes are those without the grip and without contacts.
        """
        (hand_speed, hand_spin), (thing_speed, thing_spin) = (
            pybullet.getBaseVelocity(side.handle, physicsClientId=self._client) for side in self._sides
        )
        carried = _cross(thing_spin, arm)
        speed = _minus(_minus(hand_speed, thing_speed), carried)
        turning = _cross(thing_spin, [one + 2.0 * two for one, two in zip(carried, speed, strict=True)])
        body = self._sides[0].body
        driven = [f / body.mass - g - t for f, g, t in zip(force, self._gravity, turning, strict=True)]
        twisted = [t / moment if moment > 0 else 0.0 for t, moment in zip(torque, body.inertia, strict=True)]
        return speed, _minus(hand_spin, thing_spin), driven, twisted

    def _push(self, wrench: Sequence[Vector], at: Vector) -> None:
        for side, sign in zip(self._sides, (1.0, -1.0), strict=True):
            pushed, twisted = ([sign * each for each in vector] for vector in wrench)
            frame = pybullet.WORLD_FRAME
            pybullet.applyExternalForce(side.handle, -1, pushed, at, frame, physicsClientId=self._client)
            pybullet.applyExternalTorque(side.handle, -1, twisted, frame, physicsClientId=self._client)


def _multiply(a: Vector, b: Vector) -> Vector:
    return (
        a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
        a[3] * b[1] + a[1] * b[3] + a[2] * b[0] - a[0] * b[2],
        a[3] * b[2] + a[2] * b[3] + a[0] * b[1] - a[1] * b[0],
        a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2],
    )


def _conjugate(a: Vector) -> Vector:
    return -a[0], -a[1], -a[2], a[3]


def _cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _minus(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _effective_mobility(sides: tuple[Side, Side], axes: FloatArray, position: FloatArray) -> FloatArray:
    """Return the relative acceleration ``(6, 6)`` per wrench at the hand's centre, in the frame of the grip.

    Args:
        sides: bodies of the hand and of the object.
        axes: axes of the grip in the object's frame ``(3, 3)``.
        position: position of the hand in the object's frame ``(3,)`` [m].
    """
    hand, thing = (side.body for side in sides)
    x, y, z = axes @ position
    lever = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turning = axes * _inverted(thing.inertia) @ axes.T
    mobility = np.zeros((6, 6))
    mobility[:3, :3] = np.eye(3) * (1.0 / hand.mass + 1.0 / thing.mass) - lever @ turning @ lever
    mobility[:3, 3:] = -lever @ turning
    mobility[3:, :3] = turning @ lever
    # The wrist of a hand turns equally easily about all axes.
    mobility[3:, 3:] = turning + np.diag(_inverted(hand.inertia))
    return mobility


def _inverted(inertia: tuple[float, float, float]) -> FloatArray:
    """Return the inverse of each moment of inertia, or zero if the moment is zero, which means infinite."""
    return np.array([1.0 / moment if moment > 0 else 0.0 for moment in inertia])
