"""Shorter in time: list scheduling that rebinds interchangeable tokens.

A sequential planner has no reason to spread work over hands. An *episode* of a token is what it does from leaving
RESTING until it rests again; a token that equals another in classes, properties and shape, and that no goal atom
names, can take over an episode of the other. Episodes are rebound one by one, in their order, to a token that gives
an earlier end, and tokens change places as a whole, until nothing improves or the time is up. Every candidate is
applied action by action, so that what depends on where a token is (its workspace, say) is respected.
"""

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

from hybrid_tamp.model.plan import PlannedAction, TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.symbolic.decode import UndecodableError, decode
from hybrid_tamp.symbolic.encoding.problem import Compilation
from hybrid_tamp.symbolic.estimates import Estimates
from hybrid_tamp.symbolic.pddl.operators import rename_arguments
from hybrid_tamp.symbolic.schedule import InfeasibleScheduleError, schedule

Use = tuple[int, int]
"""Action and parameter at which a token is named."""


@dataclass
class Episode:
    """What one token does between two rests: where the actions name it."""

    token: str
    uses: list[Use]


def interchangeable(task: Task) -> list[list[str]]:
    """Return groups of two or more tokens that nothing but their place tells apart."""
    named = {argument for atom in task.goal for argument in atom.arguments}
    groups: dict[tuple[object, ...], list[str]] = {}
    for token in task.assigned:
        if token.name not in named:
            groups.setdefault(_kind(token), []).append(token.name)
    return [group for group in groups.values() if len(group) > 1]


def _kind(token: Token) -> tuple[object, ...]:
    return (tuple(c.name for c in token.classes), tuple(sorted(token.properties.items())), token.shape)


def rebind_tokens(
    compilation: Compilation,
    plan: TaskPlan,
    seconds: float,
    estimates: Estimates,
) -> TaskPlan:
    """Return the plan, or one with rebound tokens that ends earlier.

    Args:
        compilation: the compiled task.
        plan: the plan as it is scheduled, with its actions.
        seconds: how long to try [s].
        estimates: those of the task.
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
    """Yield the actions with one episode given to another token, and with two tokens in each other's place."""
    for episode in _episodes(compilation, actions):
        yield from _rebind(compilation, actions, episode)
    for group in interchangeable(compilation.task):
        for one, other in combinations(map(compilation.name, group), 2):
            swap = {one: other, other: one}
            yield [rename_arguments(action, swap) for action in actions]


def _episodes(compilation: Compilation, actions: Sequence[PlannedAction]) -> list[Episode]:
    """Return the episodes of interchangeable tokens, in the order in which they begin."""
    names = {compilation.name(name) for group in interchangeable(compilation.task) for name in group}
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
    for group in interchangeable(compilation.task):
        others = [compilation.name(name) for name in group]
        if episode.token not in others:
            continue
        for other in others:
            if other != episode.token:
                changed = list(actions)
                for row, place in episode.uses:
                    arguments = changed[row].arguments
                    changed[row] = replace(changed[row], arguments=(*arguments[:place], other, *arguments[place + 1 :]))
                yield changed


def _schedule(compilation: Compilation, actions: Sequence[PlannedAction], estimates: Estimates) -> TaskPlan | None:
    """Return the schedule of actions that can be applied one after the other and reach the goal, else None."""
    if not compilation.reaches_goal(actions):
        return None
    try:
        return schedule(compilation.task, decode(compilation, actions), actions, estimates)
    except (UndecodableError, InfeasibleScheduleError):
        return None  # this candidate is none; the plan as it was still stands
