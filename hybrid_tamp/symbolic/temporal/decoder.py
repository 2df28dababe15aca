"""Durative actions back to block instances: who enters what at which reassignment.

An action begins an instance; what its tokens were in ends there. In time tokens may leave an instance a little after
its anchor; but the law has them leave at one instant, so all actions that take tokens out of one instance are one
reassignment, at the time of the first. A plan that contradicts itself then is refused; `schedule` gives the times.
"""

from collections import Counter
from collections.abc import Sequence

from hybrid_tamp.model.plan import split_mode
from hybrid_tamp.symbolic.decode import OrderedInstance, UndecodableError
from hybrid_tamp.symbolic.temporal.compilation import TemporalCompilation
from hybrid_tamp.symbolic.temporal.problem import TimedAction


def decode_durative(compilation: TemporalCompilation, actions: Sequence[TimedAction]) -> list[OrderedInstance]:
    """Return the instances of a temporal plan in the order in which they begin, initial ones first.

    Raises:
        UndecodableError: an action is not one of the compilation's, or the reassignments contradict each other.
    """
    return _Decoding(compilation, actions).instances()


class _Decoding:
    def __init__(self, compilation: TemporalCompilation, actions: Sequence[TimedAction]) -> None:
        self.task = compilation.task
        # Initial instances first; their reassignment is the start of the plan.
        self.found: list[OrderedInstance] = []
        for token in self.task.assigned:
            block = self.task.domain.block_by_name[self.task.assignment.get(token.name, self.task.domain.resting)]
            self.found.append(OrderedInstance("", block.name, {block.anchor: token.name}, {}, 0))
        self.initial = len(self.found)
        self.starts = [0.0] * self.initial
        for action in sorted(actions, key=lambda action: action.start):
            self.found.append(self._instance(compilation, action))
            self.starts.append(action.start)

    def _instance(self, compilation: TemporalCompilation, action: TimedAction) -> OrderedInstance:
        running = compilation.encoding.running.get(action.name)
        if running is None:
            raise UndecodableError(f"there is no action {action.name}")
        block = self.task.domain.block_by_name[running.block]
        roles = {role: compilation.user(action.arguments[index]) for role, index in running.roles.items()}
        slots = {slot.name: roles[slot.name] for slot in block.slots}
        return OrderedInstance("", block.name, slots, {target.name: roles[target.name] for target in block.targets}, 0)

    def instances(self) -> list[OrderedInstance]:
        """Return the instances, numbered and with their reassignments."""
        takers = self._takers()
        group = list(range(len(self.found)))
        for number, taken in takers.items():
            if taken and len(taken) < len(self.found[number].slots):
                missing = sorted(set(self.found[number].slots.values()) - set(taken))
                raise UndecodableError(f"{', '.join(missing)} stays in {self.found[number].block}, which has ended")
            for one in taken.values():
                _join(group, one, min(taken.values()))
        self._number([_root(group, number) for number in range(len(group))])
        for number, taken in takers.items():
            ends = {self.found[taker].begin for taker in taken.values()}
            self.found[number].end = min(ends, default=None)
            if ends and min(ends) <= self.found[number].begin:
                raise UndecodableError(
                    f"{self.found[number].block} of {self.found[number].slots} ends before it begins"
                )
        return sorted(self.found, key=lambda instance: instance.begin)

    def _takers(self) -> dict[int, dict[str, int]]:
        """Return for each instance which one takes each of its tokens out of it."""
        takers: dict[int, dict[str, int]] = {number: {} for number in range(len(self.found))}
        where: dict[str, int] = {}
        for number, instance in enumerate(self.found):
            for token in instance.slots.values():
                if token in where:
                    takers[where[token]][token] = number
                where[token] = number
        return takers

    def _number(self, roots: Sequence[int]) -> None:
        """Number the reassignments in the order of their first actions, and name the instances."""
        events = {root: number for number, root in enumerate(sorted(set(roots[self.initial :])), 1)}
        numbers: Counter[str] = Counter()
        for number, instance in enumerate(self.found):
            instance.begin = 0 if number < self.initial else events[roots[number]]
        for instance in sorted(self.found, key=lambda instance: instance.begin):
            action = split_mode(instance.block)[0]
            numbers[action] += 1
            instance.name = f"{action}-{numbers[action]}"


def _root(group: Sequence[int], member: int) -> int:
    while group[member] != member:
        member = group[member]
    return member


def _join(group: list[int], one: int, other: int) -> None:
    """Make two groups one; the earliest action stands for it."""
    first, second = sorted((_root(group, one), _root(group, other)))
    group[second] = first
