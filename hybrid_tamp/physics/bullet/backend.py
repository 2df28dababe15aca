"""The PyBullet backend.

The backend simulates the substeps one by one, because an impact may last for a single substep and Bullet reports the
contact forces of the last substep only.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

import numpy as np
import pybullet

from hybrid_tamp.model.affordance import BODY_STATE
from hybrid_tamp.model.block import FLOOR
from hybrid_tamp.model.commands import CommandLayout
from hybrid_tamp.model.control import CONTROL_PERIOD, Commands
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.constants import GRAVITY
from hybrid_tamp.physics.bullet.contact_windows import ContactWindows
from hybrid_tamp.physics.bullet.engine import SUBSTEPS, Client, create_body, prepare_world
from hybrid_tamp.physics.bullet.grip import Side
from hybrid_tamp.physics.bullet.hands import Drive, Fingers
from hybrid_tamp.physics.bullet.impacts import Impacts
from hybrid_tamp.physics.bullet.solids import is_compound
from hybrid_tamp.physics.protocol import ContactForce, Pair
from hybrid_tamp.physics.scene import make_bodies

_BODY = tuple(varying.name for varying in BODY_STATE)


class BulletBackend(Client):
    """A simulation of rigid bodies on a floor. Limited forces and torques move the hands, which grip by friction only.

    Args:
        gravity: acceleration of free fall, shape ``(3,)`` [m/s^2]. An inclined vector represents an inclined floor.
    """

    name = "pybullet"
    timestep = CONTROL_PERIOD

    def __init__(self, gravity: Sequence[float] = (0.0, 0.0, -GRAVITY)) -> None:
        super().__init__()
        self._gravity = tuple(gravity)
        self._handles: dict[str, int] = {}
        self._moving: list[int] = []
        self._windows = ContactWindows()
        self._within: dict[str, str] = {}

    def reset(self, task: Task, state: State) -> State:
        """Build the scene in a given state, shape ``(n,)``, and return this state.

        The state is not read back from Bullet, whose conversion of quaternions to matrices may change the last bit.

        Raises:
            InputError: a token cannot be simulated (see `make_bodies`).
        """
        scene = make_bodies(task)
        self._commands = CommandLayout.of(task)
        floor = prepare_world(self._client, self._gravity)
        self._handles = {body.token: create_body(self._client, body) for body in scene}
        self._has_compounds = any(is_compound(body.shape, rolls=not body.driven) for body in scene)
        for token, handle in self._handles.items():
            self._place(handle, token, state)
        names = {handle: token for token, handle in self._handles.items()} | {floor: FLOOR}
        self._pairs: dict[tuple[int, int], Pair] = {
            (one, other): (min(names[one], names[other]), max(names[one], names[other]))
            for one in names
            for other in names
        }
        moving = [body for body in scene if body.mass]
        self._moving = [self._handles[body.token] for body in moving]
        self._windows, self._within = ContactWindows(), {}
        slices = state.layout.slices
        self._index = np.array(
            [i for b in moving for name in _BODY for i in range(state.layout.size)[slices[b.token, name]]],
            dtype=np.intp,
        )
        self._drives = [
            Drive.of(body, self._client, self._handles[body.token], self._commands, self._gravity)
            for body in scene
            if body.driven
        ]
        sides = {body.token: Side(self._handles[body.token], body) for body in scene}
        self._fingers = Fingers.make_all(task, self._client, sides, self._commands, self._gravity)
        self._impacts = Impacts(task)
        self._state = State(state.layout, np.array(state.values, dtype=float))
        self._task, self._start = task, self._state
        self._rows: list[FloatArray] = []
        return self._state

    def assign(self, running: Sequence[BlockInstance]) -> None:
        """Empty the contact windows of the tokens whose instance has changed; the simulation itself stays the same."""
        within = {token: each.name for each in running for token in each.slots.values()}
        before, self._within = self._within, within
        self._windows.empty({token for token, name in within.items() if before.get(token) != name})

    def step(self, commands: Commands) -> State:
        """Apply constant commands to the hands for one control period and return the measured state, shape ``(n,)``.

        Raises:
            CommandError: a command is unknown, not finite, above its limit, or has the wrong size.
        """
        return self._advance(self._commands.checked(commands))

    def _advance(self, row: FloatArray) -> State:
        self._rows.append(row)
        after = self._state.values.copy()
        state = State(self._state.layout, after)
        for fingers in self._fingers:
            fingers.advance(row, state)
        self._simulate(row)
        after[self._index] = self._measure()
        self._impacts.update(state)
        self._state = state
        return state

    def contact_forces(self) -> list[ContactForce]:
        """Return each pair of bodies in contact with its largest force during the last control period [N].

        The force is the normal impulse over 10 ms, divided by 10 ms. The normal impulse of a pair is the sum over its
        contact points.
        """
        return [(one, other, force) for (one, other), force in sorted(self._windows.largest.items())]

    @contextmanager
    def snapshot(self) -> Iterator[Callable[[], None]]:
        """Save the current state. The context provides a function that restores the saved state bit for bit.

        Bullet cannot restore the contacts of compounds exactly. If the scene contains a compound, the function resets
        the scene and repeats all commands since the reset. Without commands, a reset is exact for every scene.
        """
        if self._has_compounds or not self._rows:
            start, rows, kept = self._start, tuple(self._rows), (self._windows.copy(), self._within)
            yield lambda: self._repeat(start, rows, *kept)
            return
        saved = pybullet.saveState(physicsClientId=self._client)
        state, within, rows = self._state, self._within, tuple(self._rows)
        windows, impacts = self._windows.copy(), self._impacts.copy()
        held = [fingers.held for fingers in self._fingers]

        def restore() -> None:
            pybullet.restoreState(saved, physicsClientId=self._client)
            for fingers, grasp in zip(self._fingers, held, strict=True):
                fingers.held = grasp
            self._state, self._within, self._rows = state, within, list(rows)
            self._windows, self._impacts = windows.copy(), impacts.copy()

        yield restore
        pybullet.removeState(saved, physicsClientId=self._client)

    def _repeat(
        self, start: State, rows: Sequence[FloatArray], windows: ContactWindows, within: dict[str, str]
    ) -> None:
        self.reset(self._task, start)
        for row in rows:
            self._advance(row)
        self._windows, self._within = windows.copy(), within

    def _simulate(self, row: FloatArray) -> None:
        for drive in self._drives:
            drive.command(row)
        self._windows.begin_period()
        for _ in range(SUBSTEPS):
            for drive in self._drives:
                drive.apply()
            for fingers in self._fingers:
                fingers.apply()
            pybullet.stepSimulation(physicsClientId=self._client)
            sums = self._sum_contacts()
            self._impacts.record(sums)
            self._windows.record(sums)

    def _sum_contacts(self) -> dict[Pair, float]:
        """Return the total normal force of each pair of tokens in the last substep [N]."""
        sums: dict[Pair, float] = {}
        pairs = self._pairs
        for point in pybullet.getContactPoints(physicsClientId=self._client):
            pair = pairs[point[1], point[2]]
            sums[pair] = sums.get(pair, 0.0) + point[9]
        return sums

    def _measure(self) -> list[float]:
        measured: list[float] = []
        client = self._client
        for handle in self._moving:
            for vectors in (
                pybullet.getBasePositionAndOrientation(handle, physicsClientId=client),
                pybullet.getBaseVelocity(handle, physicsClientId=client),
            ):
                for vector in vectors:
                    measured += vector
        return measured

    def _place(self, handle: int, token: str, state: State) -> None:
        position, orientation, velocity, angular_velocity = (state[token, n].tolist() for n in _BODY)
        pybullet.resetBasePositionAndOrientation(handle, position, orientation, physicsClientId=self._client)
        pybullet.resetBaseVelocity(handle, velocity, angular_velocity, physicsClientId=self._client)
