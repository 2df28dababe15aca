"""Preferences of blocks: static conditions that a plan meets if possible.

A preference makes the search smaller, e.g. because each hand stays on its side of a box. It is not a law: if the
preferences leave no plan, the planner ignores them.
"""

from dataclasses import replace

from hybrid_tamp.errors import LimitReached
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.strategies.search import Search, SearchResult
from hybrid_tamp.symbolic.with_whereabouts import Plan, plan_whereabouts


def prefer(task: Task) -> Task | None:
    """Return the task in which preferences are entry conditions, or None if no tokens fit a block that has some."""
    blocks = [
        replace(block, entry=(*block.entry, *block.preferences))
        for block in task.domain.blocks
        if block.preferences and all(map(task.values_of, block.roles.values()))
    ]
    predicates = [literal.predicate for block in blocks for literal in block.preferences]
    return task.replaced(domain=task.domain.with_blocks(blocks, predicates)) if blocks else None


def begin_with_preferences(search: Search) -> Search:
    """Return the search with the preferences, or the given search if there are none."""
    preferred = prefer(search.task)
    if preferred is None:
        return search
    return Search(preferred, search.planner, search.deadline, search.task, expectations=search.expectations)


def complete(search: Search, first: Search, found: SearchResult, relax: bool, plan: Plan) -> SearchResult:
    """Return the result of a task after its search with preferences.

    If the preferences leave no plan, or if helpers have to wait for each other, the task is planned without them.

    Args:
        search: Search for a plan of the task, which has not begun.
        first: Search with the preferences, or `search` itself if no block has preferences.
        found: Result of the first search.
        relax: Whether the delete relaxation examines the task first.
        plan: Function that searches for a plan with the facts of one task.

    Raises:
        LimitReached: If a limit was reached before any plan was found.
    """
    if first is not search and found.fewest == "proven fewest":
        found = replace(found, fewest="no shorter one found")  # Without the preferences, a shorter one may exist.
    if first is search or (found.status == "solved" and not first.waits):
        return plan_whereabouts(search, found, plan)
    try:
        other = plan_whereabouts(search, plan(search, relax), plan)
    except LimitReached as reached:
        if found.plan is None:
            raise
        return replace(found, stopped=reached)
    return min(other, found, key=lambda each: (each.cost, each.plan.makespan if each.plan else 0.0))
