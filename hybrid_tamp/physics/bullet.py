"""PyBullet, headless: the only module that imports it.

The numbers were measured (closed forms within 1 %, see the tests): four substeps of 1/960 s inside each control
period, because a rolling cylinder gains energy from contact points that are one substep old (1.2 % of a rolling
acceleration with one substep, 0.4 % with four); contact ERP 0.2, which takes up penetration without throwing a body
that starts a millimetre too low; no damping, so that only the modelled friction brakes.

The substeps are taken one by one: Bullet tells the contact forces of the last one only, and a blow is over in one.
"""

import ctypes
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from types import TracebackType

import numpy as np

from hybrid_tamp.model.affordance import BODY_STATE
from hybrid_tamp.model.block import CONTROL_PERIOD, Commands
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.shape import Box, Cylinder
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.backend import FLOOR, ContactForce
from hybrid_tamp.physics.commands import CommandLayout
from hybrid_tamp.physics.scene import FLOOR_FRICTION, FORCE, Body, bodies


@contextmanager
def _silence() -> Iterator[None]:
    """Send the process's standard streams to nowhere for a moment.

    On import PyBullet prints its build time from C, past `sys.stdout`, to standard output or error depending on the
    build; standard output belongs to ``--json``. What C still buffers must go to nowhere as well, hence the flush.
    """
    saved = {}
    for descriptor in (1, 2):
        with suppress(OSError):  # a process may run without a standard stream; there is nothing to silence then
            saved[descriptor] = os.dup(descriptor)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        for descriptor in saved:
            os.dup2(nowhere, descriptor)
        yield
    finally:
        if os.name == "posix":
            ctypes.CDLL(None).fflush(None)
        for descriptor, copy in saved.items():
            os.dup2(copy, descriptor)
            os.close(copy)
        os.close(nowhere)


with _silence():
    import pybullet

__all__ = ["BulletBackend", "pybullet"]

GRAVITY = 9.81
"""[m/s^2]."""
SUBSTEPS = 4
SOLVER_ITERATIONS = 50
CONTACT_ERP = 0.2
_BODY = tuple(varying.name for varying in BODY_STATE)


class BulletBackend:
    """Rigid bodies on a floor; the robot acts by bounded forces only, and nothing joins a hand to an object.

    Args:
        gravity: acceleration of free fall ``(3,)`` [m/s^2]; leaning it stands for an inclined floor.
    """

    name = "pybullet"
    timestep = CONTROL_PERIOD

    def __init__(self, gravity: Sequence[float] = (0.0, 0.0, -GRAVITY)) -> None:
        self._gravity = tuple(gravity)
        self._client = pybullet.connect(pybullet.DIRECT)
        self._handles: dict[str, int] = {}
        self._forces: dict[tuple[str, str], float] = {}

    def reset(self, task: Task, state: State) -> State:
        """Build the scene anew and return the given state.

        It is returned as given, not as read back: Bullet turns quaternions into matrices and back, and setting
        what was read would start a run that differs in the last bit.

        Raises:
            InputError: a token has no shape, or is moved by something else than a force.
        """
        scene = bodies(task)
        self._commands = CommandLayout.of(task)
        self._prepare()
        self._handles = {body.token: self._create(body) for body in scene}
        for token, handle in self._handles.items():
            self._place(handle, token, state)
        self._names = {handle: token for token, handle in self._handles.items()} | {self._floor: FLOOR}
        self._forces = {}
        slices = state.layout.slices
        self._index = np.array(
            [i for b in scene for name in _BODY for i in range(state.layout.size)[slices[b.token, name]]],
            dtype=np.intp,
        )
        self._hands = [
            (
                self._handles[body.token],
                self._commands.slices[body.token, FORCE],
                slices[body.token, "position"],
                -body.mass * np.array(self._gravity),
            )
            for body in scene
            if body.driven
        ]
        self._state = State(state.layout, np.array(state.values, dtype=float))
        return self._state

    def assign(self, running: Sequence[BlockInstance]) -> None:
        """Do nothing: physics does not know what is intended."""

    def step(self, commands: Commands) -> State:
        """Apply the forces on the hands for one control period and measure.

        Raises:
            CommandError: a command is unknown, of a wrong size, not finite or above its limit.
        """
        row = self._commands.checked(commands)
        client, values = self._client, self._state.values
        pushes = [
            (handle, (row[part] + support).tolist(), values[position].tolist())
            for handle, part, position, support in self._hands
        ]
        self._forces = {}
        for _ in range(SUBSTEPS):
            for handle, force, centre in pushes:
                pybullet.applyExternalForce(handle, -1, force, centre, pybullet.WORLD_FRAME, physicsClientId=client)
            pybullet.stepSimulation(physicsClientId=client)
            self._note_forces()
        measured: list[float] = []
        for handle in self._handles.values():
            position, orientation = pybullet.getBasePositionAndOrientation(handle, physicsClientId=client)
            velocity, angular_velocity = pybullet.getBaseVelocity(handle, physicsClientId=client)
            measured += (*position, *orientation, *velocity, *angular_velocity)
        after = values.copy()
        after[self._index] = measured
        self._state = State(self._state.layout, after)
        return self._state

    def contact_forces(self) -> list[ContactForce]:
        """Return the largest normal force of each pair within the last period, summed over its contact points."""
        return [(one, other, force) for (one, other), force in sorted(self._forces.items())]

    def _note_forces(self) -> None:
        sums: dict[tuple[str, str], float] = {}
        for point in pybullet.getContactPoints(physicsClientId=self._client):
            one, other = self._names[point[1]], self._names[point[2]]
            pair = (one, other) if one < other else (other, one)
            sums[pair] = sums.get(pair, 0.0) + point[9]
        for pair, force in sums.items():
            self._forces[pair] = max(force, self._forces.get(pair, 0.0))

    def close(self) -> None:
        """Leave Bullet; a second time does nothing."""
        if self._client >= 0:
            pybullet.disconnect(self._client)
            self._client = -1

    def __enter__(self) -> "BulletBackend":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _prepare(self) -> None:
        client = self._client
        pybullet.resetSimulation(physicsClientId=client)
        # A reset keeps the engine's parameters, so all that matter are set every time.
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=self.timestep / SUBSTEPS,
            numSolverIterations=SOLVER_ITERATIONS,
            contactERP=CONTACT_ERP,
            deterministicOverlappingPairs=1,
            physicsClientId=client,
        )
        pybullet.setGravity(*self._gravity, physicsClientId=client)
        plane = pybullet.createCollisionShape(pybullet.GEOM_PLANE, physicsClientId=client)
        self._floor = pybullet.createMultiBody(0.0, plane, physicsClientId=client)
        pybullet.changeDynamics(self._floor, -1, lateralFriction=FLOOR_FRICTION, physicsClientId=client)

    def _create(self, body: Body) -> int:
        shape, client = body.shape, self._client
        if isinstance(shape, Box):
            geometry = {"shapeType": pybullet.GEOM_BOX, "halfExtents": shape.half_extents}
        elif isinstance(shape, Cylinder):
            geometry = {"shapeType": pybullet.GEOM_CYLINDER, "radius": shape.radius, "height": shape.length}
        else:
            geometry = {"shapeType": pybullet.GEOM_SPHERE, "radius": shape.radius}
        collision = pybullet.createCollisionShape(**geometry, physicsClientId=client)
        handle: int = pybullet.createMultiBody(body.mass, collision, physicsClientId=client)
        pybullet.changeDynamics(
            handle,
            -1,
            localInertiaDiagonal=body.inertia,
            lateralFriction=body.friction,
            rollingFriction=body.rolling_friction,
            spinningFriction=body.rolling_friction,
            restitution=0.0,
            linearDamping=0.0,
            angularDamping=0.0,
            physicsClientId=client,
        )
        return handle

    def _place(self, handle: int, token: str, state: State) -> None:
        position, orientation, velocity, angular_velocity = (state[token, n].tolist() for n in _BODY)
        pybullet.resetBasePositionAndOrientation(handle, position, orientation, physicsClientId=self._client)
        pybullet.resetBaseVelocity(handle, velocity, angular_velocity, physicsClientId=self._client)
