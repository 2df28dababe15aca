"""Exhaustive search in small planning problems, to check compilations."""

from collections import deque
from collections.abc import Iterable, Mapping
from itertools import product

from hybrid_tamp.model.plan import PlannedAction
from hybrid_tamp.symbolic.pddl.operators import Fact, PlanningProblem, ground


def shortest_plan(problem: PlanningProblem, limit: int = 20000) -> list[PlannedAction] | None:
    """Return a shortest plan by exhaustive search, or None if there is none.

    Raises:
        OverflowError: the search reaches more states than the limit.
    """
    actions = list(_ground(problem))
    first = frozenset(problem.init)
    came: dict[frozenset[Fact], tuple[frozenset[Fact], PlannedAction] | None] = {first: None}
    queue = deque([first])
    while queue:
        state = queue.popleft()
        if state.issuperset(problem.goal):
            return _path(came, state)
        for action, needed, add, delete in actions:
            following = (state - delete) | add
            if needed <= state and following not in came:
                came[following] = (state, action)
                queue.append(following)
        if len(came) > limit:
            raise OverflowError(problem.name)
    return None


def _path(
    came: Mapping[frozenset[Fact], tuple[frozenset[Fact], PlannedAction] | None], state: frozenset[Fact]
) -> list[PlannedAction]:
    actions: list[PlannedAction] = []
    while (step := came[state]) is not None:
        state, action = step
        actions.insert(0, action)
    return actions


def _ground(
    problem: PlanningProblem,
) -> Iterable[tuple[PlannedAction, frozenset[Fact], frozenset[Fact], frozenset[Fact]]]:
    parents, things = dict(problem.domain.types), (*problem.domain.constants, *problem.objects)
    changing = {fact[0] for operator in problem.domain.operators for fact in (*operator.add, *operator.delete)}
    lasting = {fact for fact in problem.init if fact[0] not in changing}

    def within(kind: str, wanted: str) -> bool:
        return kind == wanted or (kind in parents and within(parents[kind], wanted))

    for operator in problem.domain.operators:
        variables = [variable for variable, _ in operator.parameters]
        choices = [[name for name, kind in things if within(kind, wanted)] for _, wanted in operator.parameters]
        for values in product(*choices):
            binding = dict(zip(variables, values, strict=True))
            needed, add, delete = (
                frozenset(ground(fact, binding) for fact in some)
                for some in (operator.precondition, operator.add, operator.delete)
            )
            if all(fact[0] in changing or fact in lasting for fact in needed):
                yield PlannedAction(operator.name, values), needed, add, delete - add
