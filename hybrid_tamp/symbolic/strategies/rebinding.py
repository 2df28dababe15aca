"""Rebinding of interchangeable tokens to shorten the makespan: list scheduling by local search.

A sequential planner has no reason to distribute work over several hands. An *episode* of a token lasts from leaving
RESTING until it rests again. A token can take over an episode of another if the two have equal classes, properties and
shapes and no goal atom names them. The search rebinds one episode at a time, or swaps two tokens in the whole plan,
until nothing improves or the time is up. Every candidate is applied action by action, so that conditions on the place
of a token, such as its workspace, are checked.
"""

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

from hybrid_tamp.model.plan import PlannedAction, TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.decode import NotAPlanError
from hybrid_tamp.symbolic.encoding.problem import Compilation
from hybrid_tamp.symbolic.estimates import Estimates
from hybrid_tamp.symbolic.pddl.operators import rename_arguments
from hybrid_tamp.symbolic.schedule import schedule_actions

Use = tuple[int, int]
"""Indices of an action and of its parameter that names a token."""


@dataclass
class Episode:
    """The places where actions name one token between two rests."""

    token: str
    uses: list[Use]


def interchangeable(task: Task) -> list[list[str]]:
    """Return groups of two or more tokens that differ only in their state."""
    named = {argument for atom in task.goal for argument in atom.arguments}
    groups: dict[tuple[object, ...], list[str]] = {}
    for token in task.assigned:
        if token.name not in named:
            kind = (tuple(c.name for c in token.classes), tuple(sorted(token.properties.items())), token.shape)
            groups.setdefault(kind, []).append(token.name)
    return [group for group in groups.values() if len(group) > 1]


def rebind_tokens(compilation: Compilation, plan: TaskPlan, seconds: float, estimates: Estimates) -> TaskPlan:
    """Return the plan, or a shorter one with rebound tokens.

    Args:
        compilation: the compiled task.
        plan: the scheduled plan with its actions.
        seconds: time limit [s].
        estimates: the estimates of the task.
    """
    until = time.monotonic() + seconds
    best = plan
    improved = True
    while improved:
        improved = False
        for candidate in _neighbours(compilation, best.actions):
            if time.monotonic() > until:
                return best
            shorter = _schedule(compilation, candidate, estimates)
            if shorter is not None and shorter.makespan < best.makespan - 1e-6:
                best, improved = shorter, True
                break
    return best


def _neighbours(compilation: Compilation, actions: Sequence[PlannedAction]) -> Iterator[list[PlannedAction]]:
    """Yield the actions with one episode given to another token, then those with two tokens swapped."""
    for episode in _episodes(compilation, actions):
        yield from _rebind(compilation, actions, episode)
    for group in interchangeable(compilation.task):
        for one, other in combinations(map(compilation.words.name, group), 2):
            swap = {one: other, other: one}
            yield [rename_arguments(action, swap) for action in actions]


def _episodes(compilation: Compilation, actions: Sequence[PlannedAction]) -> list[Episode]:
    """Return the episodes of interchangeable tokens, in the order in which they begin."""
    names = {compilation.words.name(name) for group in interchangeable(compilation.task) for name in group}
    resting = compilation.task.domain.resting
    current: dict[str, Episode] = {}
    found: list[Episode] = []
    for index, action in enumerate(actions):
        meaning = compilation.encoded.meanings[action.name]
        for place, name in enumerate(action.arguments):
            if name not in names:
                continue
            if name not in current:
                current[name] = Episode(name, [])
                found.append(current[name])
            current[name].uses.append((index, place))
        if meaning.block == resting:
            current.pop(action.arguments[meaning.roles[meaning.slot]], None)
    return found


def _rebind(
    compilation: Compilation, actions: Sequence[PlannedAction], episode: Episode
) -> Iterator[list[PlannedAction]]:
    """Yield the actions with one episode given to each other token of its group."""
    groups = [list(map(compilation.words.name, group)) for group in interchangeable(compilation.task)]
    for group in groups:
        for other in group if episode.token in group else ():
            if other != episode.token:
                changed = list(actions)
                for row, place in episode.uses:
                    arguments = changed[row].arguments
                    changed[row] = replace(changed[row], arguments=(*arguments[:place], other, *arguments[place + 1 :]))
                yield changed


def _schedule(compilation: Compilation, actions: Sequence[PlannedAction], estimates: Estimates) -> TaskPlan | None:
    """Return the schedule of the actions if they are a plan, else None."""
    if not compilation.reaches_goal(actions):
        return None
    try:
        return schedule_actions(compilation, actions, estimates)
    except NotAPlanError:
        return None  # The candidate is not a plan; the current plan stays.
