"""Recordings: the measurements and commands of a run, from which the run can be evaluated and replayed."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from hybrid_tamp.model.contacts import Contact
from hybrid_tamp.model.movement import Movement
from hybrid_tamp.model.plan import TIME_TOLERANCE, BlockInstance, TaskPlan
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.state import Layout, State, StateLayout
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.demonstration import ShownMovement


@dataclass(frozen=True)
class AtomMargin:
    """A condition of an instance or of the goal, with predicted and measured margins.

    Attributes:
        atom: ground condition.
        measured: signed margin measured in the run, in the unit of the predicate. None if not measured.
        predicted: signed margin in the forward models, in the unit of the predicate. None if not predicted.
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
    """The reason why a run stopped before the end of its plan.

    Attributes:
        step: index of the step of the plan in which the run stopped.
        instance: name of the instance that failed.
        reason: description of the failure.
        margins: margins of conditions at the failure.
        contact: contact that no block allowed, or None.
    """

    step: int
    instance: str
    reason: str
    margins: tuple[AtomMargin, ...] = ()
    contact: Contact | None = None


@dataclass(frozen=True, eq=False)
class Recording:
    """The measurements and commands of one run.

    Attributes:
        layout: layout of each row of `states`.
        commands_layout: triples of (token, basic action, number of components), in the order of a row of `commands`.
        times: instants of the rows of `states` [s], shape ``(t + 1,)``.
        states: measured states, shape ``(t + 1, layout.size)``. The first row is the initial state.
        commands: commands between consecutive rows of `states`, shape ``(t, c)``.
        instances: instances that ran, with measured start and end and with hyperparameters.
        exits: maps the name of each instance to the margins of its exit conditions at its end.
        goal: margins of the goal atoms at the end.
        backend: name of the physics backend.
        timestep: control period [s].
        failure: reason why the run stopped early, or None.
        warnings: warnings for the user.
        contacts: contacts between tokens, and of tokens with the floor. Empty if the backend does not measure contacts.
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
        """Whether the plan ran to its end and every goal atom holds at the end."""
        return self.failure is None and all(atom.holds for atom in self.goal)

    @property
    def duration(self) -> float:
        """Simulated time [s]."""
        return float(self.times[-1])

    @property
    def plan(self) -> TaskPlan:
        """Timeline of the run."""
        return TaskPlan(self.instances, self.duration)

    def state(self, row: int) -> State:
        """Return the state in a row of `states`."""
        return State(self.layout, self.states[row])

    @property
    def trajectory(self) -> State:
        """All measured states as one batch, batch shape ``(t + 1,)``."""
        return State(self.layout, self.states)

    def commanded(self, token: str, action: str) -> FloatArray:
        """Return the commands of a basic action of a token in the unit of the action, shape ``(t, size)``.

        Raises:
            KeyError: if the token does not have the basic action.
        """
        return self.commands[:, Layout(self.commands_layout).slices[token, action]]

    def at(self, time: float) -> State:
        """Return the measured state nearest to an instant [s]."""
        return self.state(int(np.clip(round(time / self.timestep), 0, len(self.times) - 1)))


def demonstrated_movements(
    source: str, times: FloatArray, trajectory: State, instances: Iterable[BlockInstance], movement: Movement
) -> Iterator[ShownMovement]:
    """Yield the movement that each instance demonstrates between its start and the time when its exit conditions hold.

    Args:
        source: name of the run or observation, for messages.
        times: instants of the states [s], shape ``(t,)``.
        trajectory: states at the instants, batch shape ``(t,)``.
        instances: instances of the block that is demonstrated.
        movement: movement of the block, which names the slot of the moving token.
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
