"""A recording: the measurements and commands of a run, enough to evaluate and to replay it."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from hybrid_tamp.model.block import Movement
from hybrid_tamp.model.plan import TIME_TOLERANCE, BlockInstance, TaskPlan
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.state import Layout, State, StateLayout
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.demonstration import ShownMovement


@dataclass(frozen=True)
class AtomMargin:
    """One condition of an instance or of the goal, with its predicted and measured margins.

    Attributes:
        atom: the ground condition.
        measured: its signed margin in the run, in the unit of the predicate; None if it was never measured.
        predicted: its signed margin in the blocks' own forward models; None if not predicted.
    """

    atom: Atom
    measured: float | None
    predicted: float | None = None

    @property
    def holds(self) -> bool:
        """Whether the measured margin is zero or positive."""
        return self.measured is not None and self.measured >= 0


@dataclass(frozen=True)
class Failure:
    """The reason why a run stopped before the end of its plan."""

    step: int
    instance: str
    reason: str
    margins: tuple[AtomMargin, ...] = ()


@dataclass(frozen=True)
class Contact:
    """The largest contact force between two tokens while they were in the same instances.

    Attributes:
        tokens: the two tokens.
        instances: the instance of each token then; the same instance twice if they were in one.
        force: largest normal force [N].
        time: end of the control period with that force [s].
    """

    tokens: tuple[str, str]
    instances: tuple[str, str]
    force: float
    time: float

    @property
    def between_instances(self) -> bool:
        """Whether the tokens were in different instances, so that the contact was not intended."""
        return self.instances[0] != self.instances[1]


@dataclass(frozen=True, eq=False)
class Recording:
    """The measurements and commands of one run.

    Attributes:
        layout: layout of a row of `states`.
        commands_layout: (token, basic action, size) of a row of `commands`.
        times: instant of each row of `states` [s], shape ``(t + 1,)``.
        states: measured states, shape ``(t + 1, layout.size)``; the first row is the start.
        commands: commands between consecutive rows, shape ``(t, c)``.
        instances: the instances that ran, with their measured start and end and their hyperparameters.
        exits: instance to its exit conditions at its end.
        goal: the goal atoms at the end.
        backend: name of the physics backend.
        timestep: control period [s].
        failure: why the run stopped early, or None.
        warnings: further remarks for the user.
        contacts: contacts between tokens, without the floor; empty if the backend does not measure them.
    """

    layout: StateLayout
    commands_layout: tuple[tuple[str, str, int], ...]
    times: FloatArray
    states: FloatArray
    commands: FloatArray
    instances: tuple[BlockInstance, ...]
    exits: Mapping[str, tuple[AtomMargin, ...]]
    goal: tuple[AtomMargin, ...]
    backend: str
    timestep: float
    failure: Failure | None = None
    warnings: tuple[str, ...] = field(default=())
    contacts: tuple[Contact, ...] = field(default=())

    @property
    def success(self) -> bool:
        """Whether the plan ran to its end and every goal atom holds there."""
        return self.failure is None and all(atom.holds for atom in self.goal)

    @property
    def duration(self) -> float:
        """Simulated time [s]."""
        return float(self.times[-1])

    @property
    def plan(self) -> TaskPlan:
        """The timeline of the run."""
        return TaskPlan(self.instances, self.duration)

    def state(self, row: int) -> State:
        """Return the state of one row."""
        return State(self.layout, self.states[row])

    @property
    def trajectory(self) -> State:
        """All states at once, batch shape ``(t + 1,)``."""
        return State(self.layout, self.states)

    def commanded(self, token: str, action: str) -> FloatArray:
        """Return the commands of a basic action of a token, shape ``(t, size)``, in the action's unit.

        Raises:
            KeyError: the token has no such action.
        """
        return self.commands[:, Layout(self.commands_layout).slices[token, action]]

    def at(self, time: float) -> State:
        """Return the state measured nearest to an instant [s]."""
        return self.state(int(np.clip(round(time / self.timestep), 0, len(self.times) - 1)))


def demonstrated_movements(
    source: str, times: FloatArray, trajectory: State, instances: Iterable[BlockInstance], movement: Movement
) -> Iterator[ShownMovement]:
    """Yield the movement in each instance, from its start until its exit conditions hold.

    Args:
        source: name of the run or the observation, for messages.
        times: instants [s], shape ``(t,)``.
        trajectory: states at the instants, batch shape ``(t,)``.
        instances: the instances.
        movement: which of their tokens moves.
    """
    for instance in instances:
        end = instance.active.end + TIME_TOLERANCE
        rows = np.flatnonzero((times >= instance.start - TIME_TOLERANCE) & (times <= end))
        token = instance.slots[movement.slot]
        turns = (token, "orientation") in trajectory.layout.slices
        yield ShownMovement(
            f"{source}/{instance.name}",
            times[rows],
            trajectory[token, "position"][rows],
            trajectory[token, "orientation"][rows] if turns else None,
        )
