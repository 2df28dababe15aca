"""A temporal problem as unified_planning holds it, for Aries, and its plans back in our names.

unified_planning is imported when a function is called, never with this module: the import is slow. Names need no care
here, because nothing is written to a file: each kind of thing gets a prefix of its own.

Three things about Aries (0.5), measured. Asked for any number of actions it tries ever more of each, and never says
that a plan is the shortest; so it is given a task network of the actions that there may be at most, and then it does.
A fluent with a default value is written down for all arguments there could be; so none has one. A tenth of a unit of
time lies between events, and its horizon is 10000 units. It crashes on some networks, more often on those in which
much is fixed.
"""

from collections import OrderedDict
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from importlib import import_module
from typing import Any

from hybrid_tamp.symbolic.pddl.operators import Fact, Typed
from hybrid_tamp.symbolic.temporal.problem import (
    Condition,
    DurativeAction,
    Effect,
    Fluent,
    Step,
    TemporalProblem,
    TimedAction,
    Value,
)

HORIZON = 9000
"""Units of time that a plan may take."""


class UnifiedTemporal:
    """A temporal problem of unified_planning with the way back to our names.

    Attributes:
        problem: the ``unified_planning.model.htn.HierarchicalProblem``.
    """

    def __init__(self, source: TemporalProblem, steps: Sequence[Step], unit: int) -> None:
        """Make the problem of arranging some of the steps.

        Args:
            source: the problem.
            steps: the actions that there may be.
            unit: milliseconds in a unit of time; durations are rounded down to whole units.
        """
        from unified_planning.environment import get_environment
        from unified_planning.model.metrics import MinimizeMakespan

        self._source, self._unit = source, unit
        self._environment = get_environment()
        self._environment.error_used_name = False
        self._environment.credits_stream = None
        self._parents = dict(source.domain.types)
        self.problem = _sparse()(source.name, self._environment)
        self._objects = {name: self._object(name, kind) for name, kind in (*source.domain.constants, *source.objects)}
        self._fluents = {
            f.name: [self._fluent(f, i) for i in range(max(1, len(f.values)))] for f in source.domain.fluents
        }
        self._actions = {action.name: self._action(action) for action in source.domain.actions}
        self._state()
        self._network(steps)
        self.problem.add_quality_metric(MinimizeMakespan(self._environment))

    def planned(self, plan: Any) -> tuple[TimedAction, ...]:
        """Return a plan of the network in our names."""
        seconds = self._unit / 1e3
        found = []
        for start, instance, duration in plan.action_plan.timed_actions:
            arguments = tuple(value.object().name.removeprefix("o-") for value in instance.actual_parameters)
            name = instance.action.name.removeprefix("a-")
            found.append(TimedAction(float(start) * seconds, name, arguments, float(duration or 0) * seconds))
        return tuple(sorted(found, key=lambda action: action.start))

    # -- declarations -------------------------------------------------------------------------------------------

    def _type(self, name: str) -> Any:
        parent = self._parents.get(name)
        return self._environment.type_manager.UserType(f"t-{name}", None if parent is None else self._type(parent))

    def _object(self, name: str, kind: str) -> Any:
        from unified_planning.model import Object

        made = Object(f"o-{name}", self._type(kind), self._environment)
        self.problem.add_object(made)
        return made

    def _signature(self, parameters: Iterable[Typed]) -> OrderedDict[str, Any]:
        return OrderedDict((f"p-{name}", self._type(kind)) for name, kind in parameters)

    def _fluent(self, fluent: Fluent, index: int) -> Any:
        from unified_planning.model import Fluent as UnifiedFluent

        manager = self._environment.type_manager
        kinds = {"truth": manager.BoolType(), "number": manager.IntType()}
        kind = kinds.get(fluent.kind) or self._type(fluent.values[index])
        made = UnifiedFluent(f"f{index}-{fluent.name}", kind, self._signature(fluent.parameters), self._environment)
        self.problem.add_fluent(made, default_initial_value=None)
        return made

    def _state(self) -> None:
        """Give the initial values and the goal. What is not given is never asked for."""
        manager = self._environment.expression_manager
        lasting = {action.duration[0] for action in self._source.domain.actions}
        for fact, value in self._source.init:
            for expression, each in self._pairs(fact, value, {}):
                self.problem.set_initial_value(expression, each // self._unit if fact[0] in lasting else each)
        for fact, value in self._source.goal:
            for expression, each in self._pairs(fact, value, {}):
                self.problem.add_goal(expression if each is True else manager.Equals(expression, each))

    # -- actions ------------------------------------------------------------------------------------------------

    def _action(self, action: DurativeAction) -> Any:
        from unified_planning.model import DurativeAction as UnifiedAction

        made = UnifiedAction(f"a-{action.name}", self._signature(action.parameters), self._environment)
        variables = dict(zip((name for name, _ in action.parameters), made.parameters, strict=True))
        [(duration, _)] = self._pairs(action.duration, 0, variables)
        made.set_fixed_duration(duration)
        for condition in action.conditions:
            self._condition(made, condition, variables)
        for effect in action.effects:
            self._effect(made, effect, variables)
        self.problem.add_action(made)
        return made

    def _condition(self, made: Any, condition: Condition, variables: Mapping[str, Any]) -> None:
        from unified_planning.model.timing import ClosedTimeInterval, EndTiming, LeftOpenTimeInterval, StartTiming

        manager = self._environment.expression_manager
        start, end = StartTiming(), EndTiming()
        times = {
            "start": start,
            "end": end,
            "over all": LeftOpenTimeInterval(start, end),
            "throughout": ClosedTimeInterval(start, end),
        }
        for expression, value in self._pairs(condition.fact, condition.value, variables):
            if isinstance(value, bool):
                asked = expression if value else manager.Not(expression)
            else:
                asked = manager.Equals(expression, value)
            made.add_condition(times[condition.when], manager.Not(asked) if condition.other else asked)

    def _effect(self, made: Any, effect: Effect, variables: Mapping[str, Any]) -> None:
        from unified_planning.model.timing import EndTiming, StartTiming

        time = StartTiming() if effect.when == "start" else EndTiming()
        for expression, value in self._pairs(effect.fact, effect.value, variables):
            if not effect.add:
                made.add_effect(time, expression, value)
            elif value > 0:
                made.add_increase_effect(time, expression, value)
            else:
                made.add_decrease_effect(time, expression, -value)

    def _pairs(self, fact: Fact, value: Value, variables: Mapping[str, Any]) -> list[tuple[Any, Any]]:
        """Return a fluent's expressions, one for each of its values, with the values."""

        def thing(name: str) -> Any:
            return variables[name] if name in variables else self._objects[name]

        name, *arguments = fact
        expressions = [fluent(*map(thing, arguments)) for fluent in self._fluents[name]]
        values = [thing(each) for each in value] if isinstance(value, tuple) else [value]
        return list(zip(expressions, values, strict=True))

    # -- the network --------------------------------------------------------------------------------------------

    def _network(self, steps: Sequence[Step]) -> None:
        """Put in every step as a task that is done or skipped."""
        tasks: dict[Step, Any] = {}
        for step in steps:
            if step not in tasks:
                tasks[step] = self._task(f"{step.action}-{len(tasks)}", step)
            self.problem.task_network.add_subtask(tasks[step])

    def _task(self, name: str, step: Step) -> Any:
        from unified_planning.model.htn import Method

        action, fixed = self._actions[step.action], dict(step.fixed)
        task = self.problem.add_task(f"task-{name}")
        free = {p.name: p.type for index, p in enumerate(action.parameters) if index not in fixed}
        done = Method(f"do-{name}", **free)
        done.set_task(task)
        arguments = [
            self._objects[fixed[index]] if index in fixed else done.parameter(p.name)
            for index, p in enumerate(action.parameters)
        ]
        done.add_subtask(action, *arguments)
        self.problem.add_method(done)
        if step.optional:
            skipped = Method(f"skip-{name}")
            skipped.set_task(task)
            self.problem.add_method(skipped)
        return task


@cache
def _sparse() -> Any:
    """Return a class of problems whose initial values are those that were given."""
    from unified_planning.model.htn import HierarchicalProblem

    class SparseProblem(HierarchicalProblem):  # type: ignore[misc]
        @property
        def initial_values(self) -> dict[Any, Any]:
            return dict(self.explicit_initial_values)

    return SparseProblem


def arranged(source: TemporalProblem, steps: Sequence[Step], unit: int, seconds: float) -> dict[str, Any]:
    """Have Aries arrange steps, and return the reply for JSON.

    Its ``status`` is ``solved``, with the ``actions``, or ``not_found``.
    """
    from unified_planning.model.htn import HierarchicalProblem

    unified = UnifiedTemporal(source, steps, unit)
    planner = import_module("up_aries.solver").Aries()
    # It writes down problems by their very class.
    planner._writer.functions[type(unified.problem)] = planner._writer.functions[HierarchicalProblem]
    best, status = None, "nothing"
    try:
        for result in planner.get_solutions(unified.problem, timeout=seconds):
            best, status = result.plan or best, result.status.name
    except import_module("grpc").RpcError as error:
        # Its server is gone; what it found before stands.
        status = f"a crash of its server ({error.code().name})"
    if best is None:
        return {"status": "not_found", "message": f"aries ended with {status}"}
    return {"status": "solved", "actions": [vars(action) for action in unified.planned(best)]}
