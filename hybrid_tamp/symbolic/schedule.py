"""Order to time: one simple temporal network gives the instants at which blocks abut.

Its events are the reassignments. An instance with a hold lasts at least as long as expected, one without exactly so
long; blocks that must wait for a bounded one hold, bounded ones shift right. Instances of which one reads or needs
what the other changes keep the order that the plan gives them. The earliest times are the longest paths.
"""

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise

import networkx as nx
import numpy as np

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.predicate import Atom, Literal
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.decoder import OrderedInstance

Constraint = tuple[int, int, float, str]
"""Event j comes at least so many seconds after event i; the reason."""

_TICK = 1e-3
"""Times are whole ticks [s]: sums of floats would turn a cycle of length zero into an endless one."""


class InfeasibleScheduleError(ValueError):
    """No times satisfy the plan's order and durations; the message names the cycle."""


def schedule(task: Task, instances: Sequence[OrderedInstance], actions: tuple[str, ...] = ()) -> TaskPlan:
    """Return the plan with the earliest times.

    Args:
        task: the task.
        instances: instances in the order in which they begin.
        actions: the plan's PDDL lines, kept with it.

    Raises:
        InfeasibleScheduleError: the durations contradict the order.
    """
    final = max(i.begin for i in instances) + 1
    ends = [final if i.end is None else i.end for i in instances]
    constraints = [*_durations(task, instances, ends), *_conflicts(task, instances, ends)]
    constraints += [(0, event, 0.0, "the plan begins") for event in range(1, final + 1)]
    constraints += [(event, final, 0.0, "the plan ends") for event in range(final)]
    times = _earliest(constraints)
    timed = [
        instance.timed(
            times[instance.begin],
            times[end],
            _guesses(task, instances, instance),
            _reached(task, instances, instance, times),
        )
        for instance, end in zip(instances, ends, strict=True)
    ]
    return TaskPlan(tuple(sorted(timed, key=lambda i: (i.start, i.end, i.name))), times[final], actions)


def _reached(
    task: Task, instances: Sequence[OrderedInstance], instance: OrderedInstance, times: Sequence[float]
) -> float | None:
    block = task.domain.block_by_name[instance.block]
    return round(times[instance.begin] + _expected(task, block, instance, instances), 6) if block.hold else None


def _guesses(task: Task, instances: Sequence[OrderedInstance], instance: OrderedInstance) -> dict[str, float]:
    block = task.domain.block_by_name[instance.block]
    binding = task.bind({**instance.slots, **instance.targets})
    guesses = block.guesses(binding, _state_before(task, instances, instance))
    return {name: float(value) for name, value in guesses.items()}


def _durations(task: Task, instances: Sequence[OrderedInstance], ends: Sequence[int]) -> Iterator[Constraint]:
    for instance, end in zip(instances, ends, strict=True):
        block = task.domain.block_by_name[instance.block]
        expected = _expected(task, block, instance, instances)
        yield (instance.begin, end, expected, f"{instance.name} lasts {expected:.2f} s")
        if not block.hold:
            yield (end, instance.begin, -expected, f"{instance.name} lasts {expected:.2f} s")


def _expected(task: Task, block: Block, instance: OrderedInstance, instances: Sequence[OrderedInstance]) -> float:
    binding = task.bind({**instance.slots, **instance.targets})
    state = _state_before(task, instances, instance)
    expected = block.duration.expected(binding, state, block.guesses(binding, state))
    bounded = float(np.clip(expected, block.duration.minimum, block.duration.maximum))
    # Whole ticks here already, so that every time that is built from it agrees with the network's.
    return round(math.ceil(bounded / _TICK - 1e-6) * _TICK, 6)


def _state_before(task: Task, instances: Sequence[OrderedInstance], instance: OrderedInstance) -> State:
    """Estimate the state in which an instance begins: what earlier ones brought to a place is there."""
    state = task.state
    for earlier in instances:
        if earlier.end is None or earlier.end > instance.begin:
            continue
        block = task.domain.block_by_name[earlier.block]
        roles = {**earlier.slots, **earlier.targets}
        for literal in block.exit:
            state = _placed(task, state, literal, roles)
    return state


def _placed(task: Task, state: State, literal: Literal, roles: dict[str, str]) -> State:
    """Put a token at the middle of the place that an exit condition says it has come to."""
    index = literal.predicate.functional_index
    if not literal.positive or index is None or len(literal.arguments) != 2:
        return state
    thing, place = (roles.get(literal.arguments[i], "") for i in (1 - index, index))
    if thing not in task.token_by_name or place not in task.token_by_name or not task.token_by_name[place].place:
        return state
    position = np.concatenate([state[place, "position"][..., :2], state[thing, "position"][..., 2:]], axis=-1)
    return state.replace({(thing, "position"): position})


def _conflicts(task: Task, instances: Sequence[OrderedInstance], ends: Sequence[int]) -> Iterator[Constraint]:
    """Keep the plan's order where one instance reads or needs what another changes."""
    for one, (first, first_end) in enumerate(zip(instances, ends, strict=True)):
        block = task.domain.block_by_name[first.block]
        for second in instances[one + 1 :]:
            if first.begin < second.begin < first_end and block.hold and _touch(task, first, second):
                # It is read while it holds: not before it has come to its exit.
                expected = _expected(task, block, first, instances)
                yield (first.begin, second.begin, expected, f"{second.name} reads what {first.name} holds")
            if second.begin < first_end:
                continue
            if _touch(task, first, second) or _touch(task, second, first):
                yield (first_end, second.begin, 0.0, f"{second.name} after {first.name}")
    yield from _needs(task, instances, ends)


def _touch(task: Task, writer: OrderedInstance, reader: OrderedInstance) -> bool:
    """Say whether the writer changes a property that the reader reads of a target."""
    writes = task.domain.block_by_name[writer.block].writes
    for target in task.domain.block_by_name[reader.block].targets:
        for slot, token in writer.slots.items():
            if reader.targets[target.name] == token and set(writes.get(slot, ())) & set(target.reads):
                return True
    return False


def _needs(task: Task, instances: Sequence[OrderedInstance], ends: Sequence[int]) -> Iterator[Constraint]:
    """An entry condition waits for what made it true, and comes before what may change it."""
    effects = [_atoms(task, i, "exit") for i in instances]
    for index, instance in enumerate(instances):
        for atom in _atoms(task, instance, "entry"):
            makers = [j for j in range(index) if instances[j].begin < instance.begin and _changes(effects[j], atom)]
            if makers:
                yield _after(task, instances, ends, makers[-1], instance, atom)
            for later in range(index + 1, len(instances)):
                if instances[later].begin > instance.begin and _changes(effects[later], atom):
                    reason = f"{instances[later].name} may change {atom}"
                    yield (instance.begin, instances[later].begin, 0.0, reason)


def _after(
    task: Task,
    instances: Sequence[OrderedInstance],
    ends: Sequence[int],
    maker: int,
    instance: OrderedInstance,
    atom: Atom,
) -> Constraint:
    """An instance begins after the end of what made its condition true, or while that holds it."""
    made = instances[maker]
    reason = f"{instance.name} needs {atom} of {made.name}"
    if ends[maker] <= instance.begin:
        return (ends[maker], instance.begin, 0.0, reason)
    expected = _expected(task, task.domain.block_by_name[made.block], made, instances)
    return (made.begin, instance.begin, expected, reason)


def _atoms(task: Task, instance: OrderedInstance, side: str) -> list[Atom]:
    block = task.domain.block_by_name[instance.block]
    roles = task.bind({**instance.slots, **instance.targets})
    literals = block.entry if side == "entry" else block.exit
    return [literal.ground(roles) for literal in literals if not literal.predicate.static]


def _changes(effects: Sequence[Atom], atom: Atom) -> bool:
    return any(effect.matches(Atom(atom.predicate, atom.arguments)) for effect in effects)


def _earliest(constraints: Sequence[Constraint]) -> list[float]:
    """Return the earliest time of each event [s]: the longest path from event 0."""
    graph: nx.DiGraph[int] = nx.DiGraph()
    for source, target, least, reason in constraints:
        ticks = round(least / _TICK)
        if not graph.has_edge(source, target) or -ticks < graph[source][target]["weight"]:
            graph.add_edge(source, target, weight=-ticks, reason=reason)
    try:
        lengths = nx.single_source_bellman_ford_path_length(graph, 0)
    except nx.NetworkXUnbounded as error:
        cycle = nx.find_negative_cycle(graph, 0)
        reasons = [graph[i][j]["reason"] for i, j in pairwise(cycle)]
        raise InfeasibleScheduleError("these cannot all be so: " + "; ".join(dict.fromkeys(reasons))) from error
    return [round(-lengths[event] * _TICK, 6) for event in sorted(lengths)]
