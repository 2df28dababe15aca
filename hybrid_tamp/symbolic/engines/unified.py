"""Convert planning problems to unified_planning, and convert its plans back to planned actions.

The functions import unified_planning when they are called, because the import is slow.
"""

from collections import ChainMap, OrderedDict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

from hybrid_tamp.model.plan import PlannedAction
from hybrid_tamp.symbolic.pddl.naming import unused
from hybrid_tamp.symbolic.pddl.operators import Fact, Operator, PlanningProblem, Typed


@dataclass(frozen=True)
class UnifiedProblem:
    """A problem of unified_planning, with a mapping from our PDDL names to its objects.

    Attributes:
        problem: Problem as a ``unified_planning.model.Problem``.
        actions: Maps our name of each operator to the action of unified_planning.
        objects: Maps our name of each object or constant to the object of unified_planning.
    """

    problem: Any
    actions: Mapping[str, Any]
    objects: Mapping[str, Any]

    def read_plan(self, plan: Any) -> tuple[PlannedAction, ...]:
        """Convert a plan of unified_planning to actions with our names. Unknown names stay, and `fault` reports them.

        Raises:
            unified_planning.exceptions.UPException: If the plan cannot be converted to a sequential plan.
        """
        from unified_planning.plans import PlanKind

        if plan.kind is not PlanKind.SEQUENTIAL_PLAN:
            plan = plan.convert_to(PlanKind.SEQUENTIAL_PLAN, self.problem)
        operators = {action.name: own for own, action in self.actions.items()}
        objects = {thing.name: own for own, thing in self.objects.items()}
        steps = ((each.action.name, map(str, each.actual_parameters)) for each in plan.actions)
        return tuple(
            PlannedAction(operators.get(name, name), tuple(objects.get(value, value) for value in values))
            for name, values in steps
        )

    def fault(self, actions: Sequence[PlannedAction]) -> str:
        """Return why the validator of unified_planning rejects a plan, or an empty string if the plan is valid."""
        from unified_planning.engines.plan_validator import SequentialPlanValidator
        from unified_planning.engines.results import ValidationResultStatus
        from unified_planning.plans import SequentialPlan

        for index, action in enumerate(actions, 1):
            misfit = self._misfit(action)
            if misfit:
                return f"action {index}, {action.text}: {misfit}"
        plan = SequentialPlan([self._instance(action) for action in actions], self.problem.environment)
        result = SequentialPlanValidator().validate(self.problem, plan)
        if result.status is ValidationResultStatus.VALID:
            return ""
        return "; ".join(entry.message for entry in result.log_messages or ()) or result.status.name

    def _misfit(self, action: PlannedAction) -> str:
        """Return why an action is not an instance of an operator, or an empty string if it is one."""
        if action.name not in self.actions:
            return f"there is no operator {action.name!r}"
        parameters = self.actions[action.name].parameters
        if len(parameters) != len(action.arguments):
            return f"the operator needs {len(parameters)} objects, got {len(action.arguments)}"
        for parameter, argument in zip(parameters, action.arguments, strict=True):
            if argument not in self.objects:
                return f"there is no object {argument!r}"
            if not parameter.type.is_compatible(self.objects[argument].type):
                return f"the type of {argument!r} does not fit parameter {parameter.name!r}"
        return ""

    def _instance(self, action: PlannedAction) -> Any:
        """Convert an instance of an operator (see `_misfit`) to an action instance of unified_planning."""
        from unified_planning.plans import ActionInstance

        express = self.problem.environment.expression_manager.ObjectExp
        return ActionInstance(self.actions[action.name], tuple(express(self.objects[n]) for n in action.arguments))


def unify(source: PlanningProblem, *, sparse: bool = False) -> UnifiedProblem:
    """Convert a planning problem to a problem of unified_planning.

    The problem belongs to the global environment, because a private environment breaks optimal Fast Downward.

    Args:
        source: Planning problem to convert.
        sparse: Whether false initial values are left out. Most engines ignore the false values, which may outnumber the
            true values by a factor of thousands.
    """
    from unified_planning.environment import get_environment

    environment = get_environment()
    environment.error_used_name = False
    environment.credits_stream = None
    return _Builder(source, environment, sparse).build()


class _Names:
    """Gives each item a unique name that is not a PDDL keyword. If possible, the item keeps its own name."""

    # unified_planning and its PDDL writer rename only items with colliding names, so our names can be restored.

    def __init__(self, keywords: Iterable[str]) -> None:
        self._taken = set(keywords)
        self._given: dict[tuple[str, str], str] = {}

    def __call__(self, own: str, kind: str) -> str:
        """Return the name of an item. The same item and kind always get the same name."""
        if (own, kind) not in self._given:
            self._given[own, kind] = unused(own.removeprefix("?"), self._taken)
            self._taken.add(self._given[own, kind])
        return self._given[own, kind]


@cache
def _sparse_class() -> Any:
    """Return a subclass of the problem class that has only the true initial values."""
    from unified_planning.model import Problem

    class SparseProblem(Problem):  # type: ignore[misc]
        @property
        def initial_values(self) -> dict[Any, Any]:
            return dict(self.explicit_initial_values)

    return SparseProblem


class _Builder:
    """Builds a problem of unified_planning from a planning problem."""

    def __init__(self, source: PlanningProblem, environment: Any, sparse: bool) -> None:
        from unified_planning.io import pddl_writer
        from unified_planning.model import Problem

        self._source = source
        self._environment = environment
        keywords = pddl_writer.PDDL3_KEYWORDS | pddl_writer.PDDL_PLUS_KEYWORDS
        self._names = _Names({"object", "total-cost", *keywords})
        self._parents = dict(source.domain.types)
        self._problem = (_sparse_class() if sparse else Problem)(source.name, environment)
        self._objects: dict[str, Any] = {}
        self._actions: dict[str, Any] = {}
        self._fluents: dict[str, Any] = {}

    def build(self) -> UnifiedProblem:
        """Return the problem. Each item is added before the items that refer to it."""
        from unified_planning.model import Fluent, Object

        domain = self._source.domain
        for name, kind in (*domain.constants, *self._source.objects):
            self._objects[name] = Object(self._names(name, "object"), self._type(kind), self._environment)
            self._problem.add_object(self._objects[name])
        for name, parameters in domain.predicates:
            signature = self._signature(parameters)
            fluent = Fluent(self._names(name, "predicate"), None, signature, self._environment)
            self._fluents[name] = self._problem.add_fluent(fluent, default_initial_value=False)
        for operator in domain.operators:
            self._actions[operator.name] = self._action(operator)
            self._problem.add_action(self._actions[operator.name])
        for fact in self._source.init:
            self._problem.set_initial_value(self._expression(fact), True)
        for fact in self._source.goal:
            self._problem.add_goal(self._expression(fact))
        return UnifiedProblem(self._problem, self._actions, self._objects)

    def _type(self, name: str) -> Any:
        """Return the user type for a PDDL type. An unused root type is left out."""
        parent = self._parents.get(name)
        topmost = parent is None or (parent == "object" and not self._root_is_used)
        make = self._environment.type_manager.UserType
        return make(self._names(name, "type"), None if topmost else self._type(str(parent)))

    @cached_property
    def _root_is_used(self) -> bool:
        """Whether an object or a parameter has exactly the root type."""
        domain = self._source.domain
        signatures = [domain.constants, self._source.objects, *(parameters for _, parameters in domain.predicates)]
        signatures += [operator.parameters for operator in domain.operators]
        return any(kind == "object" for signature in signatures for _, kind in signature)

    def _signature(self, parameters: Iterable[Typed]) -> OrderedDict[str, Any]:
        """Return an ordered dictionary that maps the name of each parameter to its type."""
        return OrderedDict((self._names(name, "parameter"), self._type(kind)) for name, kind in parameters)

    def _action(self, operator: Operator) -> Any:
        """Convert an operator to an action. Deletes precede adds, so a fact in both sets is left out of the deletes."""
        from unified_planning.model import InstantaneousAction

        signature = self._signature(operator.parameters)
        action = InstantaneousAction(self._names(operator.name, "operator"), signature, self._environment)
        variables = dict(zip((name for name, _ in operator.parameters), action.parameters, strict=True))
        for fact in dict.fromkeys(operator.precondition):
            action.add_precondition(self._expression(fact, variables))
        for fact in dict.fromkeys(operator.delete):
            if fact not in operator.add:
                action.add_effect(self._expression(fact, variables), False)
        for fact in dict.fromkeys(operator.add):
            action.add_effect(self._expression(fact, variables), True)
        return action

    def _expression(self, fact: Fact, variables: Mapping[str, Any] | None = None) -> Any:
        """Convert a fact over variables, constants and objects to an expression."""
        predicate, *arguments = fact
        things = ChainMap(dict(variables or {}), self._objects)
        return self._fluents[predicate](*(things[argument] for argument in arguments))
