"""Simulated hands. Forces and torques move a hand, and two virtual fingers grip an object by friction.

A joint with a limited force simulates a grasp and keeps the relative pose of the hand and the object. If the load
exceeds the limit, the object slips. The joint is then replaced by a joint with the new relative pose, because the old
joint would pull the object back.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import pybullet

from hybrid_tamp.geometry.segments import nearest_on_segment
from hybrid_tamp.model.commands import CommandLayout
from hybrid_tamp.model.control import CONTROL_PERIOD
from hybrid_tamp.model.grasp import (
    APERTURE,
    CAPTURE,
    FINGER_SPEED,
    GRIP,
    GRIP_FRICTION,
    can_be_gripped,
    grips,
)
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_conjugate, quaternion_multiply, rotate
from hybrid_tamp.physics.scene import FORCE, TORQUE, Body

SLIP = 1e-3
"""Displacement beyond which a grasp has slipped [m]."""
TWIST = 0.02
"""Rotation beyond which a grasp has slipped [rad]."""


@dataclass
class Drive:
    """Force and torque on one hand. Both are constant during a control period.

    Attributes:
        client: PyBullet's identifier of the client.
        handle: PyBullet's handle of the hand.
        force: columns of the force in a row of commands.
        torque: columns of the torque in a row of commands, or None if the hand has no torque action.
        support: force that compensates the weight of the hand without its load, shape ``(3,)`` [N].
    """

    client: int
    handle: int
    force: slice
    torque: slice | None
    support: FloatArray
    _force: list[float] = field(default_factory=list)
    _torque: list[float] = field(default_factory=list)

    @classmethod
    def of(cls, body: Body, client: int, handle: int, commands: CommandLayout, gravity: Sequence[float]) -> "Drive":
        """Return the drive of a hand under gravity ``(3,)`` [m/s^2]."""
        torque = commands.slices.get((body.token, TORQUE))
        return cls(client, handle, commands.slices[body.token, FORCE], torque, -body.mass * np.array(gravity))

    def command(self, row: FloatArray) -> None:
        """Set the force and the torque of the next control period from a row of all commands, shape ``(m,)``."""
        self._force = (row[self.force] + self.support).tolist()
        self._torque = [] if self.torque is None else row[self.torque].tolist()

    def apply(self) -> None:
        """Apply the force and the torque for one substep. The force acts at the centre, so it causes no rotation."""
        centre, _ = pybullet.getBasePositionAndOrientation(self.handle, physicsClientId=self.client)
        frame = pybullet.WORLD_FRAME
        pybullet.applyExternalForce(self.handle, -1, self._force, centre, frame, physicsClientId=self.client)
        if self._torque:
            pybullet.applyExternalTorque(self.handle, -1, self._torque, frame, physicsClientId=self.client)


@dataclass
class Grasp:
    """A gripped object, PyBullet's handle of the joint, and the pose of the hand in the object's frame."""

    thing: Token
    joint: int
    position: FloatArray
    orientation: FloatArray


@dataclass
class Fingers:
    """The fingers of one hand.

    Attributes:
        hand: hand that has the fingers.
        things: objects that the hand can grip.
        client: PyBullet's identifier of the client.
        handles: maps each token to PyBullet's handle of its body.
        grip: column of the grip force in a row of commands.
        held: current grasp, or None.
    """

    hand: Token
    things: tuple[Token, ...]
    client: int
    handles: Mapping[str, int]
    grip: int
    held: Grasp | None = field(default=None, repr=False)

    @classmethod
    def make_all(
        cls, task: Task, client: int, handles: Mapping[str, int], commands: CommandLayout
    ) -> "tuple[Fingers, ...]":
        """Make the fingers of every hand that can grip. Disable its collisions with the objects that it can grip."""
        things = tuple(token for token in task.assigned if can_be_gripped(token))
        found = []
        for hand in filter(grips, task.assigned):
            others = tuple(thing for thing in things if thing is not hand)
            for thing in others:
                pair = (handles[hand.name], handles[thing.name])
                pybullet.setCollisionFilterPair(*pair, -1, -1, 0, physicsClientId=client)
            found.append(cls(hand, others, client, handles, commands.slices[hand.name, GRIP].start))
        return tuple(found)

    def advance(self, row: FloatArray, state: State) -> None:
        """Move the fingers for one control period.

        Args:
            row: commands of all tokens. Shape ``(m,)``.
            state: state at the beginning of the period. Shape ``(n,)``. The aperture is updated in place.
        """
        grip, aperture = float(row[self.grip]), state[self.hand, APERTURE]
        way = FINGER_SPEED * CONTROL_PERIOD
        if self.held is not None and (grip <= 0 or self._has_slipped(self.held, state)):
            # If the handle is still between the fingers, the code below grips the handle again.
            self.let_go()
        if grip <= 0:
            aperture[0] = min(aperture[0] + way, self.hand["maximal_aperture"])
            return
        if self.held is None:
            narrower = max(aperture[0] - way, 0.0)
            thing = self._find_between(state, narrower, aperture[0])
            aperture[0] = narrower if thing is None else thing["handle_width"]
            self.held = None if thing is None else self._grasp(thing, state)
        if self.held is not None:
            limit = GRIP_FRICTION * grip
            pybullet.changeConstraint(self.held.joint, maxForce=limit, physicsClientId=self.client)

    def let_go(self) -> None:
        """Release the gripped object, if any."""
        if self.held is not None:
            pybullet.removeConstraint(self.held.joint, physicsClientId=self.client)
            self.held = None

    def hold(self, grasp: Grasp | None) -> None:
        """Restore a grasp, if any, by a new joint with the same relative pose."""
        self.held = grasp and replace(grasp, joint=self._create_joint(grasp.thing, grasp.position, grasp.orientation))

    def _find_between(self, state: State, narrower: float, wider: float) -> Token | None:
        """Return the nearest object that the fingers touch while they close from `wider` to `narrower` [m]."""
        distances = [
            (self._measure_distance(state, thing), index)
            for index, thing in enumerate(self.things)
            if narrower <= thing["handle_width"] <= wider
        ]
        distance, index = min(distances, default=(np.inf, 0))
        return self.things[index] if distance <= CAPTURE else None

    def _measure_distance(self, state: State, thing: Token) -> float:
        """Return the distance from the hand's centre to the axis of an object's handle [m]."""
        centre, _ = self._pose_in(thing, state)
        return float(np.linalg.norm(nearest_on_segment(centre, thing["handle_from"], thing["handle_to"]) - centre))

    def _pose_in(self, thing: Token, state: State) -> tuple[FloatArray, FloatArray]:
        """Return the hand's position ``(3,)`` [m] and orientation ``(4,)`` in the frame of an object."""
        thing_from_world = quaternion_conjugate(state[thing, "orientation"])
        offset = state[self.hand, "position"] - state[thing, "position"]
        orientation = quaternion_multiply(thing_from_world, state[self.hand, "orientation"])
        return rotate(thing_from_world, offset), orientation

    def _grasp(self, thing: Token, state: State) -> Grasp:
        position, orientation = self._pose_in(thing, state)
        return Grasp(thing, self._create_joint(thing, position, orientation), position, orientation)

    def _create_joint(self, thing: Token, position: FloatArray, orientation: FloatArray) -> int:
        joint: int = pybullet.createConstraint(
            self.handles[self.hand.name],
            -1,
            self.handles[thing.name],
            -1,
            pybullet.JOINT_FIXED,
            (0.0, 0.0, 0.0),
            (0.0, 0.0, 0.0),
            position.tolist(),
            (0.0, 0.0, 0.0, 1.0),
            orientation.tolist(),
            physicsClientId=self.client,
        )
        return joint

    def _has_slipped(self, grasp: Grasp, state: State) -> bool:
        position, orientation = self._pose_in(grasp.thing, state)
        # The inner product of two unit quaternions is the cosine of half the angle between them.
        twisted = abs(orientation @ grasp.orientation) < np.cos(TWIST / 2)
        return bool(twisted or np.linalg.norm(position - grasp.position) > SLIP)
