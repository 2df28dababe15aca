"""Plans of parts of a task, each found once however often the part occurs under other names.

Two parts are equal if renaming their tokens makes one planning problem of the other. So equal boxes with hands placed
alike need one search, whatever their number.
"""

from collections.abc import Mapping, Sequence

from hybrid_tamp.errors import LimitReached
from hybrid_tamp.model.plan import PlannedAction
from hybrid_tamp.symbolic.encoding.problem import Compilation, compile_task
from hybrid_tamp.symbolic.pddl.operators import Fact, PlanningProblem, ground, rename_arguments
from hybrid_tamp.symbolic.strategies.apart.groups import Group, own_task
from hybrid_tamp.symbolic.strategies.search import Search

Key = tuple[frozenset[Fact], frozenset[Fact], tuple[tuple[str, str], ...]]


class Templates:
    """Finds plans of groups with chosen helpers."""

    def __init__(self, search: Search, seconds: float) -> None:
        """Find plans for a search.

        Args:
            search: the search for a plan of the whole task.
            seconds: how long the planner may take for one part [s].
        """
        self._search = search
        self._seconds = seconds
        self._known: dict[Key, tuple[PlannedAction, ...] | None] = {}

    def plan(
        self, group: Group, helpers: Sequence[str], places: Sequence[str], *, returning: bool = False
    ) -> tuple[PlannedAction, ...] | None:
        """Return the actions, in the words of the whole task, by which a group's goal is reached, or None.

        Args:
            group: the group.
            helpers: the tokens that may help, in an order that is the same for equal groups.
            places: the places that may be used.
            returning: whether the helpers must be in the end as they were in the beginning.
        """
        order = (*group.tokens, *dict.fromkeys((*group.places, *places)), *helpers)
        whole = self._search.compilation
        with self._search.stage("compiling"):
            part = compile_task(own_task(self._search.task, group, helpers, places), whole)
            wanted = (*part.goal, *(_at_start(part, helpers) if returning else ()))
            label = {part.name(name): f"#{index}" for index, name in enumerate(order)}
            key = _key(part.problem, wanted, label)
        if key not in self._known:
            self._known[key] = self._found(part.problem, wanted, label)
        found = self._known[key]
        return None if found is None else self._named(found, order)

    def _found(
        self, problem: PlanningProblem, wanted: tuple[Fact, ...], label: Mapping[str, str]
    ) -> tuple[PlannedAction, ...] | None:
        goal = tuple(sorted(set(wanted)))
        try:
            part = PlanningProblem(problem.name, problem.domain, problem.objects, problem.init, goal, problem.comments)
            answer = self._search.ask(part, self._seconds)
        except LimitReached:
            return None  # The part is a try only; the whole task is still there.
        if answer.status != "solved":
            return None
        return tuple(rename_arguments(action, label) for action in answer.actions)

    def _named(self, actions: Sequence[PlannedAction], order: Sequence[str]) -> tuple[PlannedAction, ...]:
        whole = self._search.compilation
        names = {f"#{index}": whole.name(name) for index, name in enumerate(order)}
        return tuple(rename_arguments(action, names) for action in actions)


def _key(problem: PlanningProblem, wanted: Sequence[Fact], label: Mapping[str, str]) -> Key:
    objects = tuple(sorted((label.get(name, name), kind) for name, kind in problem.objects))
    init, goal = (frozenset(ground(fact, label) for fact in facts) for facts in (problem.init, wanted))
    return (init, goal, objects)


def _at_start(part: Compilation, helpers: Sequence[str]) -> list[Fact]:
    """Return the initial facts about the helpers that some action can change."""
    changed = {fact[0] for operator in part.encoded.planning.operators for fact in (*operator.add, *operator.delete)}
    names = {part.name(helper) for helper in helpers}
    return [fact for fact in part.changing if fact[0] in changed and names & set(fact[1:])]
