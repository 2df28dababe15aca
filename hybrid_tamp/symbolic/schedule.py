"""Scheduler that computes the times of an ordered plan with a simple temporal network.

The events of the network are the reassignments. If tokens may stay in a block after its exit (`hold`), an instance
lasts at least its expected duration. Otherwise, the instance lasts exactly its expected duration. Two instances keep
the order of the plan if one of them changes a token or fact that the other one reads or requires. The earliest time of
an event is the length of the longest path to the event.
"""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from itertools import pairwise

import networkx as nx
import numpy as np

from hybrid_tamp.model.plan import PlannedAction, TaskPlan
from hybrid_tamp.model.predicate import ANY, Atom
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.decode import NotAPlanError, OrderedInstance, decode
from hybrid_tamp.symbolic.encoding.problem import Compilation
from hybrid_tamp.symbolic.estimates import TICK, Estimate, Estimates

Constraint = tuple[int, int, float, str]
"""Tuple of (i, j, seconds, reason). Event j must happen at least `seconds` after event i."""


class InfeasibleScheduleError(NotAPlanError):
    """The order and the durations of the plan contradict each other. The message lists the conflicting constraints."""


def schedule(
    task: Task,
    instances: Sequence[OrderedInstance],
    actions: Sequence[PlannedAction] = (),
    estimates: Estimates | None = None,
) -> TaskPlan:
    """Return the plan with the earliest possible times.

    Args:
        task: Task of the plan.
        instances: Instances of the plan in the order of their beginnings.
        actions: Actions to store in `TaskPlan.actions`.
        estimates: Estimates of the task, which several plans may share. New estimates are made if None.

    Raises:
        InfeasibleScheduleError: If the durations contradict the order of the instances.
    """
    expected = (estimates or Estimates(task)).of(instances)
    final = max(i.begin for i in instances) + 1
    ends = [final if i.end is None else i.end for i in instances]
    network = _Network(task, instances, ends, [each.seconds for each in expected])
    times = find_earliest(list(network.constraints(final)), final + 1)
    timed = [
        instance.timed(times[instance.begin], times[end], each.initial_values, _reached(task, instance, each, times))
        for instance, end, each in zip(instances, ends, expected, strict=True)
    ]
    return TaskPlan(tuple(sorted(timed, key=lambda i: (i.start, i.end, i.name))), times[final], tuple(actions))


def schedule_actions(
    compilation: Compilation, actions: Sequence[PlannedAction], estimates: Estimates | None = None
) -> TaskPlan:
    """Decode and schedule the actions of a compiled task.

    Raises:
        NotAPlanError: If the actions are not a sequence of reassignments, or if their order contradicts the durations.
    """
    return schedule(compilation.task, decode(compilation, actions), actions, estimates)


def _reached(task: Task, instance: OrderedInstance, expected: Estimate, times: Sequence[float]) -> float | None:
    hold = task.domain.block_by_name[instance.block].hold
    return round(times[instance.begin] + expected.seconds, 6) if hold else None


class _Network:
    """The simple temporal network of one plan."""

    def __init__(
        self, task: Task, instances: Sequence[OrderedInstance], ends: Sequence[int], seconds: Sequence[float]
    ) -> None:
        self.instances = instances
        self.ends = ends
        self.seconds = seconds
        self.blocks = [task.domain.block_by_name[instance.block] for instance in instances]
        self.roles = [task.bind({**instance.slots, **instance.targets}) for instance in instances]

    def constraints(self, final: int) -> Iterator[Constraint]:
        """Yield all constraints. Some constraints are yielded several times."""
        yield from self._durations()
        yield from self._conflicts()
        yield from self._needs()
        yield from ((0, event, 0.0, "no event precedes the beginning of the plan") for event in range(1, final + 1))
        yield from ((event, final, 0.0, "no event follows the end of the plan") for event in range(final))

    def _durations(self) -> Iterator[Constraint]:
        for instance, end, block, seconds in zip(self.instances, self.ends, self.blocks, self.seconds, strict=True):
            reason = f"{instance.name} lasts {seconds:.2f} s"
            yield (instance.begin, end, seconds, reason)
            if not block.hold:
                yield (end, instance.begin, -seconds, reason)

    def _conflicts(self) -> Iterator[Constraint]:
        """Yield constraints that keep two instances in order if one changes a token that the other one reads."""
        for writer, reader in self._touching():
            one, two = sorted((writer, reader))
            first, second = self.instances[one], self.instances[two]
            if self.ends[one] <= second.begin:
                yield (self.ends[one], second.begin, 0.0, f"{second.name} must begin after {first.name} ends")
            elif writer == one and first.begin < second.begin and self.blocks[one].hold:
                # The reader waits until the writer reaches its exit. Then the writer may stay in its hold.
                reason = f"{second.name} reads a token that {first.name} changes"
                yield (first.begin, second.begin, self.seconds[one], reason)

    def _touching(self) -> Iterator[tuple[int, int]]:
        """Yield index pairs (writer, reader). The writer changes a property of a token that the reader reads."""
        writers: defaultdict[str, list[tuple[int, set[str]]]] = defaultdict(list)
        for index, (instance, block) in enumerate(zip(self.instances, self.blocks, strict=True)):
            for slot, token in instance.slots.items():
                if block.writes.get(slot):
                    writers[token].append((index, set(block.writes[slot])))
        for index, (instance, block) in enumerate(zip(self.instances, self.blocks, strict=True)):
            for target in block.targets:
                for writer, written in writers.get(instance.targets[target.name], ()):
                    if writer != index and written.intersection(target.reads):
                        yield writer, index

    def _needs(self) -> Iterator[Constraint]:
        """Yield constraints that let each instance begin only while its entry conditions hold."""
        effects = _Effects(self)
        for index, instance in enumerate(self.instances):
            for literal in self.blocks[index].changing_entry:
                atom = literal.ground(self.roles[index])
                changing = effects.changing(atom)
                makers = [j for j in changing if j < index and self.instances[j].begin < instance.begin]
                if makers:
                    yield self._after(makers[-1], instance, atom)
                for later in changing:
                    if later > index and self.instances[later].begin > instance.begin:
                        reason = f"{instance.name} requires {atom.text}, which {self.instances[later].name} may change"
                        yield (instance.begin, self.instances[later].begin, 0.0, reason)

    def _after(self, maker: int, instance: OrderedInstance, atom: Atom) -> Constraint:
        """Return the constraint that an instance begins after instance `maker` has made its entry condition true."""
        made = self.instances[maker]
        reason = f"{instance.name} requires {atom.text}, an effect of {made.name}"
        if self.ends[maker] <= instance.begin:
            return (self.ends[maker], instance.begin, 0.0, reason)
        return (made.begin, instance.begin, self.seconds[maker], reason)


class _Effects:
    """An index of the effects of all instances, by predicate and first argument."""

    def __init__(self, network: _Network) -> None:
        self._found: defaultdict[tuple[str, str], list[tuple[int, Atom]]] = defaultdict(list)
        for index, (block, roles) in enumerate(zip(network.blocks, network.roles, strict=True)):
            for literal in block.exit:
                effect = literal.ground(roles)
                self._found[_key(effect)].append((index, effect))

    def changing(self, atom: Atom) -> list[int]:
        """Return the sorted indices of the instances that set or delete the atom."""
        found = [*self._found.get(_key(atom), ()), *self._found.get((atom.predicate, ANY), ())]
        wanted = Atom(atom.predicate, atom.arguments)
        return sorted({index for index, effect in found if effect.matches(wanted)})


def _key(atom: Atom) -> tuple[str, str]:
    return (atom.predicate, atom.arguments[0] if atom.arguments else "")


def find_earliest(constraints: Sequence[Constraint], count: int) -> list[float]:
    """Return the earliest time of each event [s], which is the length of the longest path from event 0.

    Args:
        constraints: constraints between the events.
        count: number of events.

    Raises:
        InfeasibleScheduleError: If the constraints contradict each other.
    """
    sources, targets = (np.array([each[side] for each in constraints], dtype=np.intp) for side in (0, 1))
    ticks = np.array([round(each[2] / TICK) for each in constraints], dtype=np.int64)
    times = np.zeros(count, dtype=np.int64)
    for _ in range(count + 1):
        before = times.copy()
        np.maximum.at(times, targets, times[sources] + ticks)
        if np.array_equal(times, before):
            return [round(float(time) * TICK, 6) for time in times]
    raise InfeasibleScheduleError("the durations contradict the order of the plan: " + "; ".join(_cycle(constraints)))


def _cycle(constraints: Sequence[Constraint]) -> list[str]:
    """Return the reasons of constraints that form a cycle and cannot be satisfied together."""
    graph: nx.DiGraph[int] = nx.DiGraph()
    for source, target, least, reason in constraints:
        ticks = round(least / TICK)
        if not graph.has_edge(source, target) or -ticks < graph[source][target]["weight"]:
            graph.add_edge(source, target, weight=-ticks, reason=reason)
    cycle = nx.find_negative_cycle(graph, 0)
    return list(dict.fromkeys(graph[i][j]["reason"] for i, j in pairwise(cycle)))
