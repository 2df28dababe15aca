"""Rollouts of a plan on the forward models of its blocks, for a whole population of candidates at the same time.

At a reassignment, some instances end and others start. The plan determines the order of the reassignments, but their
times differ between candidates. An instance starts from the states in which earlier instances leave its tokens. If
several instances end in one reassignment, all of them continue until the last of them reaches its exit. If a condition
does not hold, its shortfall is added to the violation, and the rollout continues.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.midlevel.instance_model import Guard, IntArray
from hybrid_tamp.midlevel.population import Stretch
from hybrid_tamp.midlevel.predictions import Chosen, Condition, Interval, Key, Rollout, Trace, weigh_plan
from hybrid_tamp.midlevel.simulation import Simulation
from hybrid_tamp.model.control import CONTROL_PERIOD
from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.predicate import Literal
from hybrid_tamp.model.reassignment import Reassignment, initial, reassignments
from hybrid_tamp.model.refined import GOAL
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray

_SETTLING = 0.5
"""Minimum time from the last start of an instance to the measurement of the goal, in seconds, as in a real run."""


class Rollouts:
    """Rollout function for one plan on forward models. Results that all candidates share are computed once."""

    def __init__(
        self, task: Task, plan: TaskPlan, deadline: Deadline = NEVER, guards: Mapping[str, Guard] | None = None
    ) -> None:
        """Create the function. `guards` maps names of instances to further conditions on their poses."""
        self.task = task
        self.guards = guards or {}
        self.plan = plan
        self._events = reassignments(task, plan)
        self._simulations = {
            each.name: Simulation(task, each, deadline, self.guards.get(each.name, Guard())) for each in plan.instances
        }

    def __call__(self, chosen: Chosen, count: int = 1, until: str | None = None) -> Rollout:
        """Roll out a population.

        Args:
            chosen: maps (instance, hyperparameter) to values of shape ``(n,)``. Every other hyperparameter keeps its
                value in the plan or, if the plan has no value, its initial value.
            count: size n of the population.
            until: name of the instance after whose exit the rollout may stop. None rolls out the whole plan.

        Raises:
            LimitReached: the deadline passes.
        """
        return self._roll_out(_Chain(self.task, self._simulations, chosen, count, self.plan.order), until)

    def trace(self, plan: TaskPlan) -> dict[str, Trace]:
        """Return the movements of all instances that move tokens.

        Args:
            plan: a plan with the same instances, whose hyperparameters are used.

        Raises:
            LimitReached: the deadline passes.
        """
        values = {(each.name, h): np.array([v]) for each in plan.instances for h, v in each.hyperparameters.items()}
        chain = _Chain(self.task, self._simulations, values, 1, self.plan.order)
        self._roll_out(chain, None)
        layout = self.task.state.layout
        return {
            name: Trace(self._simulations[name].trace(each.start, each.chosen), State(layout, each.world[0]))
            for name, each in chain.begun.items()
            if self._simulations[name].block.moves
        }

    def _roll_out(self, chain: "_Chain", until: str | None) -> Rollout:
        chain.begin(initial(self.plan), np.zeros(chain.count, dtype=np.int64))
        times: list[IntArray] = []
        for event in self._events:
            if until in event.ending:
                return chain.finish(event.ending)
            before = [times[index] + 1 for index in event.after if index < len(times)]
            times.append(chain.reassign(event, before))
        return chain.finish()


@dataclass(eq=False)
class _Running:
    """A running instance, with its results so far. ``world`` are the states of all tokens at its start."""

    begun: IntArray
    world: FloatArray
    start: FloatArray
    chosen: dict[str, FloatArray]
    stretch: Stretch | None = None


@dataclass(eq=False)
class _Chain:
    """The rollout of a population in progress."""

    task: Task
    simulations: Mapping[str, Simulation]
    chosen: Chosen
    count: int
    order: tuple[tuple[str, str], ...] = ()
    conditions: list[Condition] = field(default_factory=list)
    intervals: dict[str, Interval] = field(default_factory=dict)
    figures: dict[Key, FloatArray] = field(default_factory=dict)
    failed: dict[str, NDArray[np.bool_]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.now = np.tile(self.task.state.values, (self.count, 1))
        self.running: dict[str, _Running] = {}
        self.begun: dict[str, _Running] = {}
        self.broken = np.zeros(self.count, dtype=bool)
        self.last = np.zeros(self.count, dtype=np.int64)

    def begin(self, instances: tuple[BlockInstance, ...], time: IntArray) -> None:
        """Start instances from the current states of their tokens. ``time`` is in control steps. Shape ``(n,)``."""
        for instance in instances:
            simulation = self.simulations[instance.name]
            start = self.now[:, simulation.columns]
            state = simulation.state(start)
            if time.any():
                self._note(instance.name, simulation.block.predicted_entries, simulation, simulation.entries(state))
            running = _Running(time, self.now.copy(), start, self._hyperparameters(instance, state))
            self.running[instance.name] = self.begun[instance.name] = running

    def _hyperparameters(self, instance: BlockInstance, state: State) -> dict[str, FloatArray]:
        found, simulation = {}, self.simulations[instance.name]
        for h in simulation.block.hyperparameters:
            value = self.chosen.get((instance.name, h.name), instance.hyperparameters.get(h.name))
            value = simulation.block.initial_value(h, simulation.binding, state) if value is None else value
            found[h.name] = np.array(np.broadcast_to(value, (self.count,)), dtype=np.float64)
        return found

    def reassign(self, event: Reassignment, before: list[IntArray]) -> IntArray:
        """Carry out a reassignment, and return its time in control steps. Shape ``(n,)``."""
        ready = [self._reach_exit(name) for name in event.ending]
        read = {value for instance in event.starting for value in instance.targets.values()}
        # A running instance that changes the targets of a starting instance must reach its exit first (law 5).
        ready += [self._reach_exit(n) for n in self.running if n not in event.ending and self._changes(n, read)]
        starting = {instance.name for instance in event.starting}
        ready += [self._exit_of(first) for first, second in self.order if second in starting]
        time: IntArray = np.max([*ready, *before], axis=0)
        if event.final:
            time = np.maximum(time, self.last + round(_SETTLING / CONTROL_PERIOD))
        for name in event.ending:
            self._end(name, time)
        self.begin(event.starting, time)
        self.last = np.maximum(self.last, time)
        return time

    def _exit_of(self, name: str) -> IntArray:
        """Return the time at which an instance reaches its exit, which may have ended. Shape ``(n,)``."""
        if name in self.running:
            return self._reach_exit(name)
        ended = self.begun[name]
        assert ended.stretch is not None, "an instance that has ended has reached its exit"
        return np.asarray(ended.begun + ended.stretch.steps)

    def _changes(self, name: str, tokens: set[str]) -> bool:
        simulation = self.simulations[name]
        return any(
            token in tokens for slot, token in simulation.instance.slots.items() if simulation.block.writes.get(slot)
        )

    def _reach_exit(self, name: str) -> IntArray:
        """Run an instance to its exit, update the states of its tokens, and return the exit time in control steps."""
        running, simulation = self.running[name], self.simulations[name]
        if running.stretch is None:
            running.stretch = stretch = simulation.run(running.start, running.chosen)
            self._note(name, simulation.block.measured_exits, simulation, stretch.exits)
            self._note(name, simulation.lasting, simulation, stretch.lasting, throughout=True)
            for column, measure in enumerate(simulation.block.performance):
                self.figures[name, measure.name] = stretch.figures[:, column]
            bad = ~stretch.finite & ~self.broken
            if bad.any():
                self.failed[name] = bad
                self.broken |= bad
            self._place(simulation, stretch.after)
        return np.asarray(running.begun + running.stretch.steps)

    def _end(self, name: str, time: IntArray) -> None:
        running, simulation = self.running.pop(name), self.simulations[name]
        assert running.stretch is not None, "an instance must reach its exit before it ends"
        until = time - running.begun
        self._place(simulation, simulation.hold(running.start, running.chosen, running.stretch, until))
        times = (running.begun, running.begun + running.stretch.steps, time)
        self.intervals[name] = Interval(*(np.asarray(steps * CONTROL_PERIOD) for steps in times))

    def _place(self, simulation: Simulation, rows: FloatArray) -> None:
        self.now[:, simulation.columns[simulation.held]] = rows[:, simulation.held]

    def _note(
        self, where: str, literals: Iterable[Literal], of: Simulation, margins: FloatArray, *, throughout: bool = False
    ) -> None:
        for column, literal in enumerate(literals):
            atom = of.ground(literal)
            self.conditions.append(Condition(where, atom, literal.predicate, margins[:, column], throughout))

    def finish(self, ending: tuple[str, ...] | None = None) -> Rollout:
        """Return the outcome of the population at the end of the plan, or at the exit of the given instances."""
        for name in ending or ():
            self._reach_exit(name)
        final = State(self.task.state.layout, self.now)
        for atom in () if ending else self.task.goal:
            predicate = self.task.domain.predicate_by_name[atom.predicate]
            margin = Literal(predicate, atom.arguments, atom.positive).margin(final, self.task.token_by_name)
            self.conditions.append(Condition(GOAL, atom, predicate, np.array(np.broadcast_to(margin, (self.count,)))))
        instances = (simulation.instance for simulation in self.simulations.values())
        value = weigh_plan(self.task, instances, self.figures, final)
        return Rollout(tuple(self.conditions), self.figures, value, final, self.intervals, self.failed)
