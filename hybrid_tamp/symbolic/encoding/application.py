"""Actions applied one after the other, as STRIPS says: a judge of plans that no planner made as a whole."""

from collections.abc import Sequence

from hybrid_tamp.model.plan import PlannedAction
from hybrid_tamp.symbolic.encoding.problem import Compilation
from hybrid_tamp.symbolic.pddl.operators import Fact, ground


def applicable(compilation: Compilation, actions: Sequence[PlannedAction]) -> bool:
    """Say whether every action can be applied in turn and the goal holds after the last.

    Facts of feasibility are decided as they are asked for: a large task has too many to write them all down.
    """
    operators = {operator.name: operator for operator in compilation.encoded.planning.operators}
    facts: set[Fact] = set(compilation.changing)
    for action in actions:
        operator = operators.get(action.name)
        if operator is None or len(operator.parameters) != len(action.arguments):
            return False
        binding = operator.bind(action)
        needed = [ground(fact, binding) for fact in operator.precondition]
        if not all(fact in facts or compilation.always(fact) for fact in needed):
            return False
        facts.difference_update([ground(fact, binding) for fact in operator.delete])
        facts.update([ground(fact, binding) for fact in operator.add])
    return all(fact in facts or compilation.always(fact) for fact in compilation.goal)
