"""Simulated hands. Forces and torques move a hand, and two virtual fingers grip an object by friction (`grip`)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

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
    can_be_gripped,
    grips,
)
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_conjugate, quaternion_multiply, rotate
from hybrid_tamp.physics.bullet.grip import Contact, Grasp, Side
from hybrid_tamp.physics.scene import FORCE, TORQUE, Body

_ANYWHERE = (0.0, 0.0, 0.0)
"""Point at which the force on a hand without a wrist acts. The hand cannot turn, so the point has no influence."""


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
        handle, client, frame, centre = self.handle, self.client, pybullet.WORLD_FRAME, _ANYWHERE
        if self._torque:
            centre, _ = pybullet.getBasePositionAndOrientation(handle, physicsClientId=client)
            pybullet.applyExternalTorque(handle, -1, self._torque, frame, physicsClientId=client)
        pybullet.applyExternalForce(handle, -1, self._force, centre, frame, physicsClientId=client)


@dataclass
class Fingers:
    """The fingers of one hand.

    Attributes:
        hand: hand that has the fingers.
        things: objects that the hand can grip.
        client: PyBullet's identifier of the client.
        sides: maps each token to its body.
        gravity: acceleration of free fall ``(3,)`` [m/s^2].
        commands: layout of a row of commands.
        held: current grasp, or None.
    """

    hand: Token
    things: tuple[Token, ...]
    client: int
    sides: Mapping[str, Side]
    gravity: Sequence[float]
    commands: CommandLayout
    held: Grasp | None = field(default=None, repr=False)
    _contact: Contact | None = field(default=None, repr=False)
    _force: list[float] = field(default_factory=list, repr=False)
    _torque: list[float] = field(default_factory=list, repr=False)

    @classmethod
    def make_all(
        cls, task: Task, client: int, sides: Mapping[str, Side], commands: CommandLayout, gravity: Sequence[float]
    ) -> "tuple[Fingers, ...]":
        """Make the fingers of every hand that can grip. Disable its collisions with the objects that it can grip."""
        things = tuple(token for token in task.assigned if can_be_gripped(token))
        found = []
        for hand in filter(grips, task.assigned):
            others = tuple(thing for thing in things if thing is not hand)
            for thing in others:
                pair = (sides[hand.name].handle, sides[thing.name].handle)
                pybullet.setCollisionFilterPair(*pair, -1, -1, 0, physicsClientId=client)
            found.append(cls(hand, others, client, sides, gravity, commands))
        return tuple(found)

    def advance(self, row: FloatArray, state: State) -> None:
        """Move the fingers for one control period, and set the commands of the period.

        Args:
            row: commands of all tokens. Shape ``(m,)``.
            state: state at the beginning of the period. Shape ``(n,)``. The aperture is updated in place.
        """
        (force,), self._force, self._torque = (
            row[self.commands.slices[self.hand.name, action]].tolist() for action in (GRIP, FORCE, TORQUE)
        )
        aperture = state[self.hand, APERTURE]
        way = FINGER_SPEED * CONTROL_PERIOD
        if self.held is not None and (force <= 0 or self._measure_distance(state, self.held.thing) > CAPTURE):
            self.held = None
        if force <= 0:
            aperture[0] = min(aperture[0] + way, self.hand["maximal_aperture"])
        elif self.held is None:
            narrower = max(aperture[0] - way, 0.0)
            thing = self._find_between(state, narrower, aperture[0])
            aperture[0] = narrower if thing is None else thing["handle_width"]
            self.held = None if thing is None else Grasp(thing, *self._pose_in(thing, state))
        self._contact = None if self.held is None else self._touch(self.held, force)

    def apply(self) -> None:
        """Apply the wrench between the fingers and the handle for one substep."""
        if self._contact is not None:
            self._contact.apply(self._force, self._torque)
            self.held = self._contact.grasp

    def _touch(self, grasp: Grasp, force: float) -> Contact:
        if self._contact is not None and self._contact.holds_for(grasp, force):
            self._contact.grasp = grasp
            return self._contact
        sides = self.sides[self.hand.name], self.sides[grasp.thing.name]
        return Contact(self.hand, sides, grasp, force, self.gravity, self.client)

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
