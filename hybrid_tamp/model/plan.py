"""The task plan: a timeline of assignments of tokens to block instances."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

from hybrid_tamp.model.tables import Rows, Tabular

TIME_TOLERANCE = 1e-6
"""Instants closer than this are one instant [s]."""


@dataclass(frozen=True)
class BlockInstance:
    """One execution of a block.

    Attributes:
        name: unique name, e.g. ``"ROLLING-1"``.
        block: name of the block.
        slots: slot to the name of the token in it.
        start: instant at which its tokens enter [s].
        end: instant at which they leave, or the plan's makespan [s].
        targets: target to the name of the token or symbol.
        hyperparameters: hyperparameter to value.
        reached: for a block with a hold, when its exit conditions first held [s]; later it changes nothing.
    """

    name: str
    block: str
    slots: Mapping[str, str]
    start: float
    end: float
    targets: Mapping[str, str] = field(default_factory=dict)
    hyperparameters: Mapping[str, float] = field(default_factory=dict)
    reached: float | None = None

    @property
    def action(self) -> str:
        """The block's name without its mode."""
        return split_mode(self.block)[0]

    @property
    def mode(self) -> str | None:
        """The mode of the block, or None."""
        return split_mode(self.block)[1]

    @property
    def roles(self) -> dict[str, str]:
        """Slots and targets together."""
        return {**self.slots, **self.targets}

    @property
    def text(self) -> str:
        """The name with the roles, e.g. ``ROLLING-1(hand=hand, object=drum, region=goal)``."""
        return f"{self.name}({', '.join(f'{role}={name}' for role, name in self.roles.items())})"

    def during(self, start: float, end: float) -> "BlockInstance":
        """Return the instance at other times; the time from its start to its exit is the same."""
        reached = None if self.reached is None else self.reached + start - self.start
        return replace(self, start=start, end=end, reached=reached)

    @property
    def active(self) -> "BlockInstance":
        """The instance until its exit conditions held, or the whole instance if that is unknown."""
        return self if self.reached is None else replace(self, end=min(self.reached, self.end))

    def overlaps(self, other: "BlockInstance") -> bool:
        """Say whether the two run at once for longer than an instant."""
        return min(self.end, other.end) - max(self.start, other.start) > TIME_TOLERANCE


@dataclass(frozen=True)
class PlannedAction:
    """One action of a plan, with the names in its PDDL.

    Attributes:
        name: name of the operator.
        arguments: the objects bound to its parameters.
    """

    name: str
    arguments: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """The action as a line of a PDDL plan: ``(name first second)``."""
        return f"({' '.join((self.name, *self.arguments))})"

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True)
class Step:
    """An interval in which no token is reassigned, with the instances that run."""

    index: int
    start: float
    end: float
    instances: tuple[BlockInstance, ...]


@dataclass(frozen=True)
class TaskPlan(Tabular):
    """A timeline of block instances.

    Attributes:
        instances: all block instances, resting ones included, by start.
        makespan: end of the plan [s].
        actions: the actions that the planner returned; empty if the plan has another origin.
    """

    instances: tuple[BlockInstance, ...]
    makespan: float
    actions: tuple[PlannedAction, ...] = ()

    @property
    def rows(self) -> Rows:
        """The steps as a table."""
        return [(f"{each.start:.2f} to {each.end:.2f} s", each.instances) for each in self.steps]

    def set_hyperparameters(self, values: Mapping[tuple[str, str], float]) -> "TaskPlan":
        """Return the plan with other values of some hyperparameters, by (instance, hyperparameter)."""
        mine: dict[str, dict[str, float]] = {}
        for (instance, name), value in values.items():
            mine.setdefault(instance, {})[name] = value
        instances = (
            replace(each, hyperparameters={**each.hyperparameters, **mine.get(each.name, {})})
            for each in self.instances
        )
        return replace(self, instances=tuple(instances))

    @cached_property
    def instants(self) -> tuple[float, ...]:
        """The instants of reassignment, the beginning and the end included, ascending [s]."""
        return merge_instants(t for i in self.instances for t in (i.start, i.end))

    @property
    def steps(self) -> Iterator[Step]:
        """The intervals between reassignments, with the instances that run in each (paper, under Fig. 3)."""
        for index, (start, end) in enumerate(zip(self.instants, self.instants[1:], strict=False), start=1):
            middle = (start + end) / 2
            yield Step(index, start, end, tuple(i for i in self.instances if i.start <= middle < i.end))

    def timeline(self, token: str) -> tuple[tuple[BlockInstance, str], ...]:
        """Return the (instance, slot) pairs of a token, by start."""
        return self._timelines.get(token, ())

    def before(self, instance: BlockInstance, token: str) -> tuple[BlockInstance, str] | None:
        """Return the (instance, slot) pair that a token was in before it entered an instance, None if there is none."""
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
    """Split the name of a block into action and mode; the mode is None if the action has only one."""
    action, colon, mode = block.partition(":")
    return (action, mode) if colon else (block, None)


def merge_instants(times: Iterable[float]) -> tuple[float, ...]:
    """Return the distinct instants, ascending; times within the tolerance are one instant."""
    merged: list[float] = []
    for time in sorted(times):
        if not merged or time - merged[-1] > TIME_TOLERANCE:
            merged.append(time)
    return tuple(merged)


def at(one: float, other: float) -> bool:
    """Say whether two times are one instant."""
    return abs(one - other) <= TIME_TOLERANCE
