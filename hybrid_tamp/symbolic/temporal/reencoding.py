"""Conversion of a timeline to durative actions, so that PDDL validators can judge any task plan.

The conditions of an action must hold just before the action starts. So the actions of one instant start 0.01 s apart.
A timeline does not contain all parameters, e.g. the source slot of a token. The missing parameters follow from the
values of the fluents when the action starts.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from hybrid_tamp.model.plan import BlockInstance, TaskPlan, at
from hybrid_tamp.symbolic.pddl.operators import Fact, ground
from hybrid_tamp.symbolic.pddl.temporal_text import require_old_values
from hybrid_tamp.symbolic.reencode import group_by_source
from hybrid_tamp.symbolic.temporal.compilation import TemporalCompilation
from hybrid_tamp.symbolic.temporal.problem import DurativeAction, TemporalProblem, TimedAction, Value

_APART = 1e-2
"""Time between the starts of two actions of one instant [s]."""
_UNKNOWN = "unknown"
"""Value of a parameter that no fluent determines, because the timeline is unlawful."""


def reencode_durative(
    compilation: TemporalCompilation, plan: TaskPlan
) -> tuple[TemporalProblem, tuple[TimedAction, ...]]:
    """Return the problem with the durations of the plan, and the plan as a sequence of durative actions."""
    problem = _lasting(compilation, plan)
    return problem, tuple(_Following(compilation, problem, plan).actions())


def _lasting(compilation: TemporalCompilation, plan: TaskPlan) -> TemporalProblem:
    """Return the problem with the durations of the plan. If the plan repeats a run, the shortest duration is used."""
    lasts: dict[Fact, int] = {}
    for instance, action in _actions_of(compilation, plan):
        block = compilation.task.domain.block_by_name[instance.block]
        fact = (_duration(compilation, action), *(compilation.words.name(instance.roles[role]) for role in block.roles))
        end = instance.end if instance.reached is None else min(instance.reached, instance.end)
        seconds = round(1e3 * (end - instance.start))
        lasts[fact] = min(seconds, lasts.get(fact, seconds))
    kept = [(fact, value) for fact, value in compilation.problem.init if fact not in lasts]
    return replace(compilation.problem, init=tuple(sorted([*kept, *lasts.items()], key=str)))


def _duration(compilation: TemporalCompilation, action: str) -> str:
    return next(a.duration[0] for a in compilation.problem.domain.actions if a.name == action)


@dataclass
class _Begun:
    """An action that has started, with its bound parameters, its start [s] and its end [s]."""

    action: DurativeAction
    binding: dict[str, str]
    start: float
    end: float


class _Following:
    """Tracks the values of the fluents through a timeline."""

    def __init__(self, compilation: TemporalCompilation, problem: TemporalProblem, plan: TaskPlan) -> None:
        self.compilation = compilation
        self.plan = plan
        self.templates = {action.name: action for action in require_old_values(problem.domain).actions}
        self.values: dict[Fact, Value] = dict(problem.init)
        self.running: list[_Begun] = []

    def actions(self) -> Iterator[TimedAction]:
        """Yield the actions in the order of their starts."""
        begun = []
        for number, (instance, name) in enumerate(self._ordered(), 1):
            start = instance.start + number * _APART
            self._finish(start)
            begun.append(self._begin(instance, name, start))
            self.running.append(begun[-1])
        self._finish(float("inf"))
        for each in begun:
            arguments = tuple(each.binding.get(name, _UNKNOWN) for name, _ in each.action.parameters)
            yield TimedAction(round(each.start, 6), each.action.name, arguments, round(each.end - each.start, 6))

    def _begin(self, instance: BlockInstance, name: str, start: float) -> _Begun:
        action, running = self.templates[name], self.compilation.encoding.running[name]
        order = [parameter for parameter, _ in action.parameters]
        binding = {
            order[index]: self.compilation.words.name(instance.roles[role])
            for role, index in running.roles.items()
            if role in instance.roles
        }
        self._bind(action, binding, ("start", "throughout"))
        self._apply(action, binding, "start")
        lasts = self.values.get(ground(action.duration, binding), 0)
        assert isinstance(lasts, int)
        return _Begun(action, binding, start, start + lasts / 1e3)

    def _finish(self, time: float) -> None:
        """Apply the end effects of the actions that end before a time [s]."""
        for each in sorted(self.running, key=lambda each: each.end):
            if each.end < time:
                self._bind(each.action, each.binding, ("end",))
                self._apply(each.action, each.binding, "end")
                self.running.remove(each)

    def _bind(self, action: DurativeAction, binding: dict[str, str], times: Sequence[str]) -> None:
        """Bind the parameters that the values of the fluents determine."""
        for condition in action.conditions:
            value = self.values.get(ground(condition.fact, binding))
            if condition.when in times and isinstance(condition.value, tuple) and isinstance(value, tuple):
                for variable, found in zip(condition.value, value, strict=True):
                    if variable.startswith("?"):
                        binding.setdefault(variable, found)

    def _apply(self, action: DurativeAction, binding: Mapping[str, str], time: str) -> None:
        for effect in action.effects:
            if effect.when == time:
                fact, value = ground(effect.fact, binding), effect.value
                if effect.add:
                    self.values[fact] = int(self.values.get(fact, 0)) + value  # type: ignore[arg-type, operator]
                else:
                    self.values[fact] = ground(("", *value), binding)[1:] if isinstance(value, tuple) else value

    # -- order --------------------------------------------------------------------------------------------------

    def _ordered(self) -> Iterator[tuple[BlockInstance, str]]:
        """Yield pairs of (instance, action name) in the order of the instants."""
        # At one instant, readers of a token leave before a block changes the token. Instances that take tokens from the
        # same instance are consecutive, and the new instance of the anchor is first.
        everything = list(_actions_of(self.compilation, self.plan))
        for time in self.plan.instants:
            names = {id(instance): name for instance, name in everything if at(instance.start, time)}
            waiting = [instance for instance, _ in everything if id(instance) in names]
            groups = [
                [(instance, names[id(instance)]) for instance in sorted(group, key=self._takes_anchor, reverse=True)]
                for group in group_by_source(self.plan, waiting)
            ]
            yield from (pair for group in sorted(groups, key=self._changes) for pair in group)

    def _takes_anchor(self, instance: BlockInstance) -> bool:
        """Return whether an instance takes the anchor of an instance with several slots."""
        blocks = self.compilation.task.domain.block_by_name
        before = [found for token in instance.slots.values() if (found := self.plan.before(instance, token))]
        return any(len(old.slots) > 1 and slot == blocks[old.block].anchor for old, slot in before)

    def _changes(self, group: list[tuple[BlockInstance, str]]) -> bool:
        """Return whether a group has a block that changes a token and therefore requires a token without readers."""
        readers = self.compilation.encoding.names("readers")
        actions = [self.templates[name] for _, name in group]
        return any(c.fact[0] == readers for action in actions for c in action.conditions)


def _actions_of(compilation: TemporalCompilation, plan: TaskPlan) -> Iterator[tuple[BlockInstance, str]]:
    """Yield a pair of (instance, action name) for each instance except the initial instances."""
    blocks = compilation.task.domain.block_by_name
    names = {(r.block, r.along): name for name, r in compilation.encoding.running.items()}
    before: dict[str, BlockInstance] = {}
    for instance in sorted(plan.instances, key=lambda i: (i.start, i.end, i.name)):
        block = blocks[instance.block]
        home = before.get(instance.slots[block.anchor])
        along = frozenset(
            slot.name
            for slot in block.others
            if home is not None and home is before.get(instance.slots[slot.name]) and len(home.slots) > 1
        )
        if home is not None:
            yield instance, names[instance.block, along]
        before.update(dict.fromkeys(instance.slots.values(), instance))
