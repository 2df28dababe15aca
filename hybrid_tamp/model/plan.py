"""Task plans: timelines of the assignment of tokens to block instances."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

from hybrid_tamp.model.tables import Rows, Tabular

Fewest = Literal["proven fewest", "no shorter one found", "first found"]
"""What is known about a plan's number of actions. "No shorter one found" means that a counted search looked for one."""

TIME_TOLERANCE = 1e-6
"""Largest difference between two times that are treated as the same instant [s]."""


@dataclass(frozen=True)
class BlockInstance:
    """One execution of a block.

    Attributes:
        name: unique name of the instance, e.g. ``"ROLLING-1"``.
        block: name of the block.
        slots: maps each slot to the name of its token.
        start: instant at which the tokens enter the slots [s].
        end: instant at which the tokens leave the slots, at most the makespan of the plan [s].
        targets: maps each target to the name of its token or symbol.
        hyperparameters: maps each hyperparameter to its value.
        reached: instant at which the exit conditions first hold, for a block with `hold` [s]. The instance changes
            nothing after this instant. None if unknown, and for blocks without `hold`.
        path: corners of a path [m] for the position of the token in the slot `Block.path`. Empty if the movement
            follows no planned path.
    """

    name: str
    block: str
    slots: Mapping[str, str]
    start: float
    end: float
    targets: Mapping[str, str] = field(default_factory=dict)
    hyperparameters: Mapping[str, float] = field(default_factory=dict)
    reached: float | None = None
    path: tuple[tuple[float, float, float], ...] = ()

    @property
    def action(self) -> str:
        """Name of the block without the mode."""
        return split_mode(self.block)[0]

    @property
    def mode(self) -> str | None:
        """Mode of the block, or None if the block has no mode."""
        return split_mode(self.block)[1]

    @property
    def roles(self) -> dict[str, str]:
        """Maps each slot and target to the name of its token or symbol."""
        return {**self.slots, **self.targets}

    @property
    def text(self) -> str:
        """Name of the instance with its roles, e.g. ``ROLLING-1(hand=hand, object=drum, region=goal)``."""
        return f"{self.name}({', '.join(f'{role}={name}' for role, name in self.roles.items())})"

    def during(self, start: float, end: float) -> "BlockInstance":
        """Return the instance with another start and end. The time from `start` to `reached` does not change."""
        reached = None if self.reached is None else self.reached + start - self.start
        return replace(self, start=start, end=end, reached=reached)

    @property
    def active(self) -> "BlockInstance":
        """Copy of the instance with `reached` as its end, or the unchanged instance if `reached` is None."""
        return self if self.reached is None else replace(self, end=min(self.reached, self.end))

    def overlaps(self, other: "BlockInstance") -> bool:
        """Return whether both instances run at the same time for longer than `TIME_TOLERANCE`."""
        return min(self.end, other.end) - max(self.start, other.start) > TIME_TOLERANCE


@dataclass(frozen=True)
class PlannedAction:
    """An action of a PDDL plan.

    Attributes:
        name: PDDL name of the operator.
        arguments: PDDL names of the objects that are bound to the parameters of the operator.
    """

    name: str
    arguments: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """Action as a line of a PDDL plan, e.g. ``(name first second)``."""
        return f"({' '.join((self.name, *self.arguments))})"

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True)
class Step:
    """A time interval [s] without reassignments, and the instances that run in this interval."""

    index: int
    start: float
    end: float
    instances: tuple[BlockInstance, ...]


@dataclass(frozen=True)
class TaskPlan(Tabular):
    """A timeline of block instances.

    Attributes:
        instances: all block instances, including instances of the resting block, sorted by start.
        makespan: end of the plan [s].
        actions: actions that the planner returned. Empty if the plan was not returned by a planner.
        order: pairs of (first, second) instances. The second instance starts only after the first one has reached its
            exit, because their movements would meet otherwise.
    """

    instances: tuple[BlockInstance, ...]
    makespan: float
    actions: tuple[PlannedAction, ...] = ()
    order: tuple[tuple[str, str], ...] = ()

    @property
    def rows(self) -> Rows:
        """Rows of the table of steps."""
        return [(f"{each.start:.2f} to {each.end:.2f} s", each.instances) for each in self.steps]

    def set_hyperparameters(self, values: Mapping[tuple[str, str], float]) -> "TaskPlan":
        """Return the plan with new values. `values` maps pairs of (instance, hyperparameter) to values."""
        mine: dict[str, dict[str, float]] = {}
        for (instance, name), value in values.items():
            mine.setdefault(instance, {})[name] = value
        instances = (
            replace(each, hyperparameters={**each.hyperparameters, **mine.get(each.name, {})})
            for each in self.instances
        )
        return replace(self, instances=tuple(instances))

    def with_path(self, name: str, path: Iterable[Iterable[float]]) -> "TaskPlan":
        """Return the plan with a path ``(n, 3)`` [m] for one instance."""
        corners = tuple((float(x), float(y), float(z)) for x, y, z in path)
        instances = (replace(each, path=corners) if each.name == name else each for each in self.instances)
        return replace(self, instances=tuple(instances))

    def with_order(self, first: str, second: str) -> "TaskPlan":
        """Return the plan in which the instance `second` starts only after `first` has reached its exit."""
        return replace(self, order=(*self.order, (first, second)))

    def retime(self, times: Mapping[str, tuple[float, float | None, float]]) -> "TaskPlan":
        """Return the plan with new times. `times` maps each instance to its start, `reached` and end [s]."""
        moved = [
            replace(each, start=start, reached=reached, end=end)
            for each in self.instances
            for start, reached, end in [times[each.name]]
        ]
        moved.sort(key=lambda each: (each.start, each.end, each.name))
        return replace(self, instances=tuple(moved), makespan=max(each.end for each in moved))

    @cached_property
    def instants(self) -> tuple[float, ...]:
        """Instants of reassignment, including the start and the end of the plan, in ascending order [s]."""
        return merge_instants(t for i in self.instances for t in (i.start, i.end))

    @property
    def steps(self) -> Iterator[Step]:
        """Intervals between reassignments, each with its running instances (paper, below Fig. 3)."""
        for index, (start, end) in enumerate(zip(self.instants, self.instants[1:], strict=False), start=1):
            middle = (start + end) / 2
            yield Step(index, start, end, tuple(i for i in self.instances if i.start <= middle < i.end))

    def timeline(self, token: str) -> tuple[tuple[BlockInstance, str], ...]:
        """Return pairs of (instance, slot) for all instances that contain the token, sorted by start."""
        return self._timelines.get(token, ())

    def before(self, instance: BlockInstance, token: str) -> tuple[BlockInstance, str] | None:
        """Return the pair of (instance, slot) that contained a token just before an instance started, or None."""
        timeline = self.timeline(token)
        index = next(i for i, (other, _) in enumerate(timeline) if other is instance)
        return timeline[index - 1] if index else None

    @cached_property
    def _timelines(self) -> Mapping[str, tuple[tuple[BlockInstance, str], ...]]:
        found: dict[str, list[tuple[BlockInstance, str]]] = {}
        for instance in sorted(self.instances, key=lambda i: (i.start, i.end, i.name)):
            for slot, token in instance.slots.items():
                found.setdefault(token, []).append((instance, slot))
        return {token: tuple(pairs) for token, pairs in found.items()}


def split_mode(block: str) -> tuple[str, str | None]:
    """Return the action and the mode of a block's name. The mode is None if the block has no mode."""
    action, colon, mode = block.partition(":")
    return (action, mode) if colon else (block, None)


def merge_instants(times: Iterable[float]) -> tuple[float, ...]:
    """Return the instants in ascending order. Times within `TIME_TOLERANCE` are merged into one instant."""
    merged: list[float] = []
    for time in sorted(times):
        if not merged or time - merged[-1] > TIME_TOLERANCE:
            merged.append(time)
    return tuple(merged)


def at(one: float, other: float) -> bool:
    """Return whether two times are the same instant."""
    return abs(one - other) <= TIME_TOLERANCE
