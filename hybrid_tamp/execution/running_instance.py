"""Running block instances: policies, commands, measured conditions and time bounds."""

import math
from collections.abc import Collection, Iterable, Sequence

import numpy as np

from hybrid_tamp.model.authored import authored
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.commands import CommandLayout
from hybrid_tamp.model.contacts import Contact
from hybrid_tamp.model.control import Commands, Parameters
from hybrid_tamp.model.plan import TIME_TOLERANCE, BlockInstance
from hybrid_tamp.model.predicate import Literal
from hybrid_tamp.model.recording import AtomMargin
from hybrid_tamp.model.shapes import check_commands, sizes_of
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.view import View
from hybrid_tamp.motion.arrays import FloatArray, are_finite


class RunError(Exception):
    """Failure of an instance, which ends the run. `Run` catches this error, so callers of the package never see it.

    Attributes:
        instance: name of the instance that failed; empty if no single instance failed.
        reason: reason for the failure.
        margins: margins of the conditions that do not hold.
        contact: the contact that no block allowed, or None.
    """

    def __init__(
        self, instance: str, reason: str, margins: Iterable[AtomMargin] = (), contact: Contact | None = None
    ) -> None:
        super().__init__(reason)
        self.instance = instance
        self.reason = reason
        self.margins = tuple(margins)
        self.contact = contact


def measure_conditions(
    task: Task, literals: Iterable[Literal], instance: BlockInstance, state: State
) -> list[AtomMargin]:
    """Return the margin of each condition of an instance. A margin that is NaN becomes None (not measured)."""
    binding = task.bind(instance.roles)
    found = []
    for literal in literals:
        margin = float(literal.margin(state, binding))
        found.append(AtomMargin(literal.ground(binding), None if math.isnan(margin) else margin))
    return found


class Running:
    """A running block instance, which begins at a time [s] in a state of shape ``(n,)``.

    Raises:
        RunError: a hyperparameter is not finite.
    """

    def __init__(self, task: Task, instance: BlockInstance, time: float, state: State) -> None:
        self.instance = instance
        self.block: Block = task.domain.block_by_name[instance.block]
        self.begin = time
        self.reached: float | None = None
        self._asked, self._holds = -math.inf, False
        self._task = task
        self._held = frozenset(instance.slots.values())
        self._binding = task.bind(instance.roles)
        self._view = View(self._binding, state.layout)
        self._sizes = sizes_of({slot: task.token_by_name[token] for slot, token in instance.slots.items()})
        self._exits = self.block.measured_exits
        # Conditions with fewer arguments come first, because their margins are computed faster.
        self._in_turn = tuple(sorted(self._exits, key=lambda literal: len(literal.arguments)))
        seen = self._view.of(state)
        self.hyperparameters = self._choose_hyperparameters(seen)
        arrays = {name: np.asarray(value) for name, value in self.hyperparameters.items()}
        maker, self._maker_name = self.block.policy, f"{self.block.name}.policy"
        with authored(self._maker_name, self._binding):
            self._policy = (
                None if maker is None else maker(self._binding, seen, Parameters.along(instance.path, arrays))
            )

    def __repr__(self) -> str:
        return f"Running({self.instance.name!r})"

    @property
    def latest(self) -> float:
        """Time [s] at which the maximum duration ends. A hold without exit conditions uses its minimum duration."""
        bounds = self.block.duration
        return self.begin + (bounds.maximum if self._exits or not self.block.hold else bounds.minimum)

    def measure_exits(self, state: State) -> list[AtomMargin]:
        """Return the margins of the exit conditions in a state of shape ``(n,)``."""
        return measure_conditions(self._task, self._exits, self.instance, state)

    def is_ready(self, time: float, state: State) -> bool:
        """Return whether the minimum duration is over and all exit conditions hold. The result is cached."""
        if time - self.begin < self.block.duration.minimum - TIME_TOLERANCE:
            return False
        if time != self._asked:
            self._asked = time
            self._holds = self._all_hold(state)
            if self._holds and self.reached is None:
                self.reached = time
        return self._holds

    def forget_after(self, time: float) -> None:
        """Forget that the exit conditions held for the first time, if this was after a time [s]."""
        if self.reached is not None and self.reached > time:
            self.reached = None
        self._asked = -math.inf

    def _all_hold(self, state: State) -> bool:
        for literal in self._in_turn:
            if not float(literal.margin(state, self._binding)) >= 0:
                # A condition that fails now probably also fails at the next step, so it is tested first from now on.
                if literal is not self._in_turn[0]:
                    self._in_turn = (literal, *(other for other in self._in_turn if other is not literal))
                return False
        return True

    def check_overdue(self, time: float, state: State) -> None:
        """Check the maximum duration.

        Raises:
            RunError: the duration exceeds its maximum. A hold is exempt once its exit conditions have held.
        """
        maximum = self.block.duration.maximum
        if time - self.begin <= maximum + TIME_TOLERANCE or (self.block.hold and self.reached is not None):
            return
        missing = [margin for margin in self.measure_exits(state) if not margin.holds]
        said = "; ".join(map(describe_shortfall, missing)) or "its exit conditions hold, but its tokens cannot leave"
        elapsed = time - self.begin
        raise RunError(
            self.instance.name,
            f"{self.instance.name} ran for {elapsed:.3f} s and exceeded its maximum duration of {maximum:g} s: {said}",
            missing,
        )

    def command(self, time: float, state: State) -> Commands:
        """Return the commands of the policy at a time [s] and in a state of shape ``(n,)``.

        Raises:
            DomainError: a command has the wrong shape, or no token in a slot of the block has the action.
        """
        if self._policy is None:
            return {}
        seen = self._view.of(state)
        with authored(self._maker_name, self._binding):
            commands = self._policy(np.float64(time - self.begin), seen)
        check_commands(self._maker_name, self._binding, commands, self._sizes, seen)
        return commands

    def check_finite(self, commands: Commands) -> None:
        """Check that the commands on the instance's tokens are finite.

        Raises:
            RunError: a command is not finite.
        """
        for (token, action), command in commands.items():
            if token in self._held and not np.isfinite(command).all():
                said = f"{action} {np.asarray(command).tolist()} on {token}"
                reason = f"the policy of {self.block.name} must command finite values, got {said}"
                raise RunError(self.instance.name, reason)

    def _choose_hyperparameters(self, state: State) -> dict[str, float]:
        """Return the value of each hyperparameter: the planned value if given, otherwise the initial value."""
        given = self.instance.hyperparameters
        chosen = {
            h.name: float(given[h.name] if h.name in given else self.block.initial_value(h, self._binding, state))
            for h in self.block.hyperparameters
        }
        for name, value in chosen.items():
            if not math.isfinite(value):
                said = f"hyperparameter {name} of {self.instance.name} must be finite, got {value}"
                raise RunError(self.instance.name, said)
        return chosen


def describe_shortfall(margin: AtomMargin) -> str:
    """Return a message that a condition does not hold, with the margin of the condition."""
    if margin.measured is None:
        return f"the margin of {margin.atom.text} is not a number"
    return f"{margin.atom.text} does not hold (margin {margin.measured:.4g})"


def command_instances(layout: CommandLayout, running: Collection[Running], time: float, state: State) -> FloatArray:
    """Return the commands of all policies at a time [s] in a state of shape ``(n,)``, as a row of shape ``(m,)``.

    Raises:
        DomainError: a command has the wrong shape, or no token in a slot of the block has the action.
        RunError: a command is not finite.
    """
    commands: Commands = {}
    for each in running:
        commands.update(each.command(time, state))
    row = layout.row(commands)
    if not are_finite(row):
        for each in running:
            each.check_finite(commands)
    return row


def blame_state(state: State, running: Collection[Running], time: float) -> RunError:
    """Return a failure of the first instance that has a token with a state that is not finite.

    Args:
        state: state with a value that is not finite. Shape ``(n,)``.
        running: instances that are running.
        time: last time at which the state was finite [s].
    """
    for each in running:
        for token in each.instance.slots.values():
            for name in (name for owner, name, _ in state.layout.entries if owner == token):
                if not np.isfinite(state[token, name]).all():
                    said = f"the {name} of {token} is not finite after {time:.3f} s"
                    return RunError(each.instance.name, said)
    return RunError("", f"the state is not finite after {time:.3f} s")


def blame_waiting(missing: Sequence[tuple[str, AtomMargin]], due: float, ending: str) -> RunError:
    """Return the failure of a run that waits too long for a reassignment.

    Args:
        missing: pairs of (instance, condition) for each condition that does not hold.
        due: time at which the reassignment was due [s].
        ending: instance to blame if all conditions hold.
    """
    said = "; ".join(f"{name}: {describe_shortfall(margin)}" for name, margin in missing) or "all conditions hold"
    reason = f"the reassignment due at {due:.3f} s cannot happen: {said}"
    return RunError(missing[0][0] if missing else ending, reason, (margin for _, margin in missing))


def measure_goal(task: Task, state: State) -> tuple[AtomMargin, ...]:
    """Return the margins of the goal atoms of a task in a state of shape ``(n,)``."""
    margins = [(atom, task.margin(atom, state)) for atom in task.goal]
    return tuple(AtomMargin(atom, None if np.isnan(margin) else margin) for atom, margin in margins)
