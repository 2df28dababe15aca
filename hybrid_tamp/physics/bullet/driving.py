"""The effect of commands on a hand: a force on its centre and a torque, constant for a control period."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import pybullet

from hybrid_tamp.model.commands import CommandLayout
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.physics.scene import FORCE, TORQUE, Body


@dataclass
class Drive:
    """Force and torque on one hand.

    Attributes:
        client: PyBullet's client.
        handle: PyBullet's handle of the hand.
        force: columns of the force in a row of commands.
        torque: columns of the torque, or None if the hand cannot be turned.
        support: force that bears the hand's own weight, without what it holds ``(3,)`` [N].
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
        """Return the drive of a driven body."""
        torque = commands.slices.get((body.token, TORQUE))
        return cls(client, handle, commands.slices[body.token, FORCE], torque, -body.mass * np.array(gravity))

    def command(self, row: FloatArray) -> None:
        """Set the commands of a control period from a row of all commands."""
        self._force = (row[self.force] + self.support).tolist()
        self._torque = [] if self.torque is None else row[self.torque].tolist()

    def apply(self) -> None:
        """Apply both for the next substep; the force acts at the current centre, so it does not turn the hand."""
        centre, _ = pybullet.getBasePositionAndOrientation(self.handle, physicsClientId=self.client)
        frame = pybullet.WORLD_FRAME
        pybullet.applyExternalForce(self.handle, -1, self._force, centre, frame, physicsClientId=self.client)
        if self._torque:
            pybullet.applyExternalTorque(self.handle, -1, self._torque, frame, physicsClientId=self.client)
