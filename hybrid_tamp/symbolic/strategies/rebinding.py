"""Local search that rebinds interchangeable tokens to shorten the makespan.

A sequential planner has no reason to distribute work over several hands. An *episode* of a token lasts from the time
when the token leaves RESTING until it rests again. Two tokens are interchangeable if they have equal classes,
properties and shapes and no goal atom names them. The search rebinds one episode to another token, or swaps two tokens
in the whole plan, as long as the makespan improves, up to `MOST_ACTIONS`. Every candidate is checked action by action,
because some conditions depend on the token's position, e.g. its workspace.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.expectation import Beginning
from hybrid_tamp.model.plan import BlockInstance, PlannedAction, TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.decode import NotAPlanError
from hybrid_tamp.symbolic.encoding.problem import Compilation
from hybrid_tamp.symbolic.estimates import Estimates
from hybrid_tamp.symbolic.pddl.operators import rename_arguments
from hybrid_tamp.symbolic.schedule import schedule_actions
from hybrid_tamp.symbolic.strategies.search import Candidate, Search
from hybrid_tamp.symbolic.whereabouts.predicted import predict_states

REBOUND = "interchangeable tokens rebound"
SWAPPED = "interchangeable tokens swapped"

MOST_ACTIONS = 150_000
"""Number of actions in all candidates together, after which the search ends. The work grows with this number."""

Use = tuple[int, int]
"""Pair of (index of an action, index of an argument of the action)."""


@dataclass
class Episode:
    """The uses of a token between two rests. `token` is its PDDL name."""

    token: str
    uses: list[Use]


def interchangeable(task: Task) -> list[list[str]]:
    """Return the groups of two or more tokens that are interchangeable."""
    named = {argument for atom in task.goal for argument in atom.arguments}
    groups: dict[tuple[object, ...], list[str]] = {}
    for token in task.assigned:
        if token.name not in named:
            kind = (tuple(c.name for c in token.classes), tuple(sorted(token.properties.items())), token.shape)
            groups.setdefault(kind, []).append(token.name)
    return [group for group in groups.values() if len(group) > 1]


def rebind(search: Search, best: Candidate) -> Candidate:
    """Return a shorter lawful plan with interchangeable tokens rebound, or the given plan if there is none.

    Raises:
        LimitReached: If the deadline passes.
    """
    with search.stage("scheduling"):
        shorter = rebind_tokens(search.compilation, best.plan, search.estimates, search.deadline)
    if shorter is best.plan:
        return best
    return search.judge(Candidate(f"{best.way}, {REBOUND}", shorter)) or best


def swap_tokens(search: Search, best: Candidate) -> Candidate:
    """Return a lawful plan whose movements take less time in total, or the given plan if no swap of tokens helps.

    Pairs of interchangeable tokens that both move are swapped in the whole plan, so the number of actions stays the
    same. Only the first movement of each token then begins elsewhere. A pair is not tried if these two movements would
    take longer.

    Raises:
        LimitReached: If the deadline passes.
    """
    compilation = search.compilation
    resting = search.original.domain.resting
    moving = {name for each in best.plan.instances if each.block != resting for name in each.slots.values()}
    groups = [[name for name in group if name in moving] for group in interchangeable(search.task)]
    pairs = [pair for group in groups for pair in combinations(group, 2)]
    with search.stage("scheduling"):  # As one batch, the rollouts of all pairs cost little more than those of one pair.
        tried = [pair for pair in pairs if compilation.reaches_goal(_swap(compilation, best.plan.actions, pair))]
        search.expectations.of([each for pair in tried for each in _exchange(search, best.plan, pair)])
    for pair in pairs:
        search.deadline.check()
        actions = _swap(compilation, best.plan.actions, pair)
        with search.stage("scheduling"):
            possible = compilation.reaches_goal(actions) and _may_shorten(search, best.plan, pair)
            swapped = _schedule(compilation, actions, search.estimates) if possible else None
        if swapped is not None and _sum_times(swapped) < _sum_times(best.plan) - 1e-6:
            best = search.judge(Candidate(f"{best.way}, {SWAPPED}", swapped)) or best
    return best


def _swap(compilation: Compilation, actions: Sequence[PlannedAction], pair: tuple[str, str]) -> list[PlannedAction]:
    """Return the actions with two tokens swapped."""
    one, other = map(compilation.words.name, pair)
    return [rename_arguments(action, {one: other, other: one}) for action in actions]


def _may_shorten(search: Search, plan: TaskPlan, pair: tuple[str, str]) -> bool:
    """Return whether a swap of two tokens shortens their first movements, according to rollouts of these movements."""
    firsts = _first_movements(search, plan, pair)
    swapped = sum(expected.seconds for expected in search.expectations.of(_exchange(search, plan, pair)))
    return len(firsts) == 1 or swapped < sum(e.reached - e.start for e in firsts if e.reached is not None)


def _exchange(search: Search, plan: TaskPlan, pair: tuple[str, str]) -> list[Beginning]:
    """Return the beginnings of the first movements of two tokens after a swap, or nothing if they share a movement."""
    task, firsts = search.task, _first_movements(search, plan, pair)
    if len(firsts) == 1:
        return []
    states, swap = predict_states(task, plan, search.estimates), dict(zip(pair, reversed(pair), strict=True))
    beginnings = []
    for first in firsts:
        block = task.domain.block_by_name[first.block]
        mine = {swap[name] for name in first.slots.values() if name in swap}
        binding = task.bind({role: swap.get(name, name) for role, name in first.roles.items()})
        waiting = {key: task.state[key] for key in task.state.layout.slices if key[0] in mine}
        state = states[first.name].replace(waiting)
        beginnings.append(Beginning(block, binding, state, block.initial_values(binding, state)))
    return beginnings


def _first_movements(search: Search, plan: TaskPlan, pair: tuple[str, str]) -> list[BlockInstance]:
    """Return the first movement of each token, or one movement if it is the first one of both tokens."""
    firsts = [_first_movement(search, plan, name) for name in pair]
    return firsts if firsts[0] is not firsts[1] else firsts[:1]


def _first_movement(search: Search, plan: TaskPlan, token: str) -> BlockInstance:
    resting = search.task.domain.resting
    moving = [each for each in plan.instances if each.block != resting and token in each.slots.values()]
    return min(moving, key=lambda each: (each.start, each.name))


def _sum_times(plan: TaskPlan) -> float:
    """Return the sum over all instances of the time [s] from the beginning until the exit conditions hold."""
    return sum(instance.reached - instance.start for instance in plan.instances if instance.reached is not None)


def rebind_tokens(
    compilation: Compilation,
    plan: TaskPlan,
    estimates: Estimates,
    deadline: Deadline = NEVER,
    most_actions: int = MOST_ACTIONS,
) -> TaskPlan:
    """Return a shorter plan with rebound tokens, or the given plan if none is found.

    Args:
        compilation: Compiled task.
        plan: Scheduled plan with its actions.
        estimates: Estimates of the task.
        deadline: Deadline of the command.
        most_actions: Number of actions in all candidates together, after which the search ends.

    Raises:
        LimitReached: If the deadline passes.
    """
    left = most_actions
    best = plan
    improved = True
    while improved:
        improved = False
        for candidate in _neighbours(compilation, best.actions):
            deadline.check()
            left -= len(candidate)
            if left < 0:
                return best
            shorter = _schedule(compilation, candidate, estimates)
            if shorter is not None and shorter.makespan < best.makespan - 1e-6:
                best, improved = shorter, True
                break
    return best


def _neighbours(compilation: Compilation, actions: Sequence[PlannedAction]) -> Iterator[list[PlannedAction]]:
    """Yield the action sequences with one episode rebound, then the sequences with two tokens swapped."""
    for episode in _episodes(compilation, actions):
        yield from _rebind(compilation, actions, episode)
    for group in interchangeable(compilation.task):
        for one, other in combinations(map(compilation.words.name, group), 2):
            swap = {one: other, other: one}
            yield [rename_arguments(action, swap) for action in actions]


def _episodes(compilation: Compilation, actions: Sequence[PlannedAction]) -> list[Episode]:
    """Return the episodes of interchangeable tokens, in the order of their beginnings."""
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
    """Yield an action sequence for each token to which the episode can be rebound."""
    groups = [list(map(compilation.words.name, group)) for group in interchangeable(compilation.task)]
    for other in (name for group in groups if episode.token in group for name in group if name != episode.token):
        changed = list(actions)
        for row, place in episode.uses:
            arguments = changed[row].arguments
            changed[row] = replace(changed[row], arguments=(*arguments[:place], other, *arguments[place + 1 :]))
        yield changed


def _schedule(compilation: Compilation, actions: Sequence[PlannedAction], estimates: Estimates) -> TaskPlan | None:
    """Schedule the actions, or return None if they are not a plan."""
    if not compilation.reaches_goal(actions):
        return None
    try:
        return schedule_actions(compilation, actions, estimates)
    except NotAPlanError:
        return None  # The candidate is not a plan, so the current plan is kept.
