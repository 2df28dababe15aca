"""Rollouts: a plan's blocks chained by their own continuous systems, a whole population of hyperparameters at once.

The order of reassignments is the plan's; when they happen follows from each candidate. Each instance is computed from
where the ones before it left its tokens; those that share a reassignment hold for the latest. A condition that does
not hold is a violation and is counted, and the chain goes on from there.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.midlevel.population import IntArray, Stretch
from hybrid_tamp.midlevel.simulation import Simulation
from hybrid_tamp.model.control import CONTROL_PERIOD
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.predicate import Atom, Literal
from hybrid_tamp.model.reassignment import Reassignment, initial, reassignments
from hybrid_tamp.model.refined import GOAL, Shortfall
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray

Key = tuple[str, str]
"""(instance, hyperparameter) or (instance, measure)."""

Chosen = Mapping[Key, FloatArray]
"""(instance, hyperparameter) to its values over the population, shape ``(n,)``."""

_SETTLING = 0.5
"""How long the last instances run on before the goal is looked at, as in a real run [s]."""


@dataclass(frozen=True, eq=False)
class Condition:
    """One condition over the population.

    Attributes:
        where: name of the instance whose entry or exit condition it is, or `GOAL`.
        atom: the ground condition.
        unit: unit of its margin.
        scale: size of a margin that counts as one unit of violation [unit].
        margin: its signed margins, shape ``(n,)``; not finite where a rollout failed.
    """

    where: str
    atom: Atom
    unit: str
    scale: float
    margin: FloatArray

    @property
    def violation(self) -> FloatArray:
        """How far it is from holding, in units of its scale, shape ``(n,)``."""
        return np.asarray(np.maximum(0.0, -self.margin) / self.scale)

    def at(self, candidate: int) -> Shortfall:
        """Return what one candidate, for which it does not hold, lacks."""
        return Shortfall(self.where, self.atom, self.unit, float(self.margin[candidate]))


@dataclass(frozen=True, eq=False)
class Rollout:
    """What the forward models expect of a population.

    Attributes:
        conditions: entry and exit conditions of all instances in their order, then the goal's atoms.
        figures: (instance, measure) to the figures of performance measures, shape ``(n,)``.
        value: the weighted sum of the performance measures, maximised, shape ``(n,)``.
        final: the state in the end, shape ``(n, layout.size)``.
        intervals: instance to its beginning and its end [s], each of shape ``(n,)``.
        failed: instance to the candidates in which something was first not finite there, shape ``(n,)``.
    """

    conditions: tuple[Condition, ...]
    figures: Mapping[Key, FloatArray]
    value: FloatArray
    final: State
    intervals: Mapping[str, tuple[FloatArray, FloatArray]]
    failed: Mapping[str, NDArray[np.bool_]]

    @property
    def violation(self) -> FloatArray:
        """V, the sum of all violations, shape ``(n,)``; infinite where something was not finite."""
        total = np.sum([condition.violation for condition in self.conditions], axis=0) + np.zeros(len(self.value))
        for where in self.failed.values():
            total = np.where(where, np.inf, total)
        return np.where(np.isfinite(total), total, np.inf)

    def worst(self, candidate: int = 0) -> Condition | None:
        """Return the first condition that does not hold for a candidate, in the order of the plan, or None."""
        return next((c for c in self.conditions if not c.margin[candidate] >= 0), None)

    def value_of(self, task: Task, instance: BlockInstance) -> FloatArray:
        """Return the weighted sum of one instance's own measures, shape ``(n,)``."""
        measures = task.domain.block_by_name[instance.block].performance
        terms = [m.weight * self.figures[instance.name, m.name] / m.scale for m in measures]
        return np.asarray(np.sum(terms, axis=0) + np.zeros(len(self.value)))


class Rollouts:
    """Rolls out one plan, for one population after the other; what candidates share is computed once."""

    def __init__(self, task: Task, plan: TaskPlan) -> None:
        self.task = task
        self.plan = plan
        self._events = reassignments(task, plan)
        self._simulations = {instance.name: Simulation(task, instance) for instance in plan.instances}

    def __call__(self, chosen: Chosen, count: int = 1, until: str | None = None) -> Rollout:
        """Roll out a population.

        Args:
            chosen: values of hyperparameters; others are as the plan says, or initial values.
            count: size n of the population.
            until: the instance after whose exit the rollout may stop; what comes later is then left out.
        """
        chain = _Chain(self.task, self._simulations, chosen, count)
        chain.begin(initial(self.plan), np.zeros(count, dtype=np.int64))
        times: list[IntArray] = []
        for event in self._events:
            if until in event.ending:
                return chain.rollout(event.ending)
            before = [times[index] + 1 for index in event.after if index < len(times)]
            times.append(chain.reassign(event, before))
        return chain.rollout()


@dataclass(eq=False)
class _Running:
    """An instance that has begun, with what has been computed of it so far."""

    begun: IntArray
    start: FloatArray
    chosen: dict[str, FloatArray]
    stretch: Stretch | None = None


@dataclass(eq=False)
class _Chain:
    """A population on its way through the plan."""

    task: Task
    simulations: Mapping[str, Simulation]
    chosen: Chosen
    count: int
    conditions: list[Condition] = field(default_factory=list)
    intervals: dict[str, tuple[FloatArray, FloatArray]] = field(default_factory=dict)
    figures: dict[Key, FloatArray] = field(default_factory=dict)
    failed: dict[str, NDArray[np.bool_]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.now = np.tile(self.task.state.values, (self.count, 1))
        self.running: dict[str, _Running] = {}
        self.broken = np.zeros(self.count, dtype=bool)
        self.last = np.zeros(self.count, dtype=np.int64)

    def begin(self, instances: tuple[BlockInstance, ...], time: IntArray) -> None:
        """Let instances begin from where their tokens are."""
        for instance in instances:
            simulation = self.simulations[instance.name]
            start = self.now[:, simulation.columns]
            state = simulation.state(start)
            if time.any():
                self._note(instance.name, simulation.block.measured_entries, simulation, simulation.entries(state))
            self.running[instance.name] = _Running(time, start, self._hyperparameters(instance, state))

    def _hyperparameters(self, instance: BlockInstance, state: State) -> dict[str, FloatArray]:
        found = {}
        simulation = self.simulations[instance.name]
        for h in simulation.block.hyperparameters:
            value = self.chosen.get((instance.name, h.name), instance.hyperparameters.get(h.name))
            value = h.initial_value(simulation.binding, state) if value is None else value
            found[h.name] = np.array(np.broadcast_to(value, (self.count,)), dtype=np.float64)
        return found

    def reassign(self, event: Reassignment, before: list[IntArray]) -> IntArray:
        """Carry out an event and return when it happens, in control steps, shape ``(n,)``."""
        ready = [self._exit_of(name) for name in event.ending]
        read = {value for instance in event.starting for value in instance.targets.values()}
        # What a starting instance reads must have come to its exit where another one still holds it (law 5).
        ready += [self._exit_of(n) for n in self.running if n not in event.ending and self._changes(n, read)]
        time: IntArray = np.max([*ready, *before], axis=0)
        if event.final:
            time = np.maximum(time, self.last + round(_SETTLING / CONTROL_PERIOD))
        for name in event.ending:
            self._end(name, time)
        self.begin(event.starting, time)
        self.last = time
        return time

    def _changes(self, name: str, tokens: set[str]) -> bool:
        simulation = self.simulations[name]
        return any(
            token in tokens for slot, token in simulation.instance.slots.items() if simulation.block.writes.get(slot)
        )

    def _exit_of(self, name: str) -> IntArray:
        """Return when an instance has come to its exit; its tokens are there from now on."""
        running, simulation = self.running[name], self.simulations[name]
        if running.stretch is None:
            running.stretch = stretch = simulation.run(running.start, running.chosen)
            self._note(name, simulation.block.measured_exits, simulation, stretch.exits)
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
        assert running.stretch is not None, "it has come to its exit before it ends"
        until = time - running.begun
        self._place(simulation, simulation.hold(running.start, running.chosen, running.stretch, until))
        begun, ended = (np.asarray(steps * CONTROL_PERIOD, dtype=np.float64) for steps in (running.begun, time))
        self.intervals[name] = (begun, ended)

    def _place(self, simulation: Simulation, rows: FloatArray) -> None:
        held = simulation.held
        self.now[:, simulation.columns[held]] = rows[:, held]

    def _note(self, where: str, literals: tuple[Literal, ...], simulation: Simulation, margins: FloatArray) -> None:
        for column, literal in enumerate(literals):
            atom, predicate = literal.ground(simulation.binding), literal.predicate
            self.conditions.append(Condition(where, atom, predicate.unit, predicate.scale, margins[:, column]))

    def rollout(self, ending: tuple[str, ...] | None = None) -> Rollout:
        """Return what came of the population: at the plan's end, or at the exit of these instances."""
        for name in ending or ():
            self._exit_of(name)
        final = State(self.task.state.layout, self.now)
        for atom in () if ending else self.task.goal:
            predicate = self.task.domain.predicate_by_name[atom.predicate]
            margin = Literal(predicate, atom.arguments, atom.positive).margin(final, self.task.token_by_name)
            margins = np.array(np.broadcast_to(margin, (self.count,)))
            self.conditions.append(Condition(GOAL, atom, predicate.unit, predicate.scale, margins))
        value = np.zeros(self.count)
        for name, simulation in self.simulations.items():
            for measure in simulation.block.performance:
                value = value + measure.weight * self.figures.get((name, measure.name), 0.0) / measure.scale
        return Rollout(tuple(self.conditions), self.figures, value, final, self.intervals, self.failed)
