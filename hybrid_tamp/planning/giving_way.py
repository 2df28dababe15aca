"""Resting hands that give way to a movement.

A task planner does not know where hands rest. If a movement hits a resting hand, the hand withdraws before the movement
begins: a block that only moves a token along a path is inserted while the hand rests, and the plan orders the two
movements. The hand moves straight to a place that the movement, and if possible all later ones, pass at a distance.
"""

import logging
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from hybrid_tamp.collision.bodies import Body, Pose, bodies_of, find_nearest, pose_of
from hybrid_tamp.collision.sweeps import find_clearance
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.making_way import makes_way
from hybrid_tamp.model.plan import BlockInstance, TaskPlan, at
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.paths.free_space import Carried, FreeSpace, OutOfChecks
from hybrid_tamp.planning.clearance import Neighbour, Sweep
from hybrid_tamp.planning.detours import CLEARANCE, obstacle_near
from hybrid_tamp.planning.meetings import put_in_order
from hybrid_tamp.planning.turning_paths import directions_upwards
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.reencode import reencode

_LOG = logging.getLogger(__name__)

_DISTANCES = (0.15, 0.25, 0.4, 0.6, 0.9)
"""Distances by which a hand may withdraw [m]."""
_MOST_CHECKS = 20_000
_RESTS, _WITHDRAWS = 0.1, 1.0
"""Estimated durations of a rest and of a withdrawal [s], until the plan is rolled out."""


def make_room(task: Task, plan: TaskPlan, movements: Sequence[Sweep], movement: Sweep, name: str) -> TaskPlan | None:
    """Return the plan in which a resting hand withdraws before a movement that hits it, or None if it cannot.

    Args:
        task: task of the plan.
        plan: plan whose times are those of the rollout.
        movements: movements of the plan in the order of their starts.
        movement: the movement that hits the hand.
        name: name of the hand.
    """
    rest = _find_rest(task, plan, movement.instance, name)
    block = None if rest is None else _find_block(task, name)
    if rest is None or block is None or _has_given_way(plan, movement.instance, name):
        return None
    path = _find_path(task, block, movements, movement, name)
    inserted = None if path is None else _insert(task, plan, rest, movement.instance, block)
    if path is None or inserted is None:
        return None
    changed, withdrawal = inserted
    ordered = put_in_order(task, changed.with_path(withdrawal, path), withdrawal, movement.instance.name)
    # The durations are estimates until the next rollout, so law 6 is not checked here.
    if ordered is None or any(violation.law != 6 for violation in check_law(task, ordered)):
        return None
    _LOG.info("%s gives way to %s", name, movement.instance.name)
    return replace(ordered, actions=tuple(reencode(compile_task(task), ordered)))


def waiting_for(plan: TaskPlan, name: str) -> str:
    """Return the instance for which an instance was inserted, or the name itself if the instance was not inserted."""
    withdrawals = {each.name for each in plan.instances if not each.targets and each.path}
    return next((second for first, second in plan.order if first == name and name in withdrawals), name)


def _find_rest(task: Task, plan: TaskPlan, instance: BlockInstance, name: str) -> BlockInstance | None:
    """Return the instance in which a token rests when another instance starts, or None if the token does not rest."""
    begun = [each for each, _ in plan.timeline(name) if each.start <= instance.start or at(each.start, instance.start)]
    last = begun[-1] if begun else None
    return last if last is not None and last.block == task.domain.resting_block.name else None


def _find_block(task: Task, name: str) -> Block | None:
    """Return the block that only moves a resting token along a path, or None if the domain has no such block."""
    token, resting = task.token_by_name[name], task.domain.resting_block
    rests = resting.name, resting.anchor
    for block in task.domain.blocks:
        slot = block.name, block.anchor
        network = task.domain.network
        there_and_back = network.allows(rests, slot) and network.allows(slot, rests)
        if makes_way(block) and there_and_back and token.is_member(block.slots[0].object_class):
            return block
    return None


def _has_given_way(plan: TaskPlan, instance: BlockInstance, name: str) -> bool:
    """Return whether a token already withdraws before an instance."""
    slots = {each.name: each.slots.values() for each in plan.instances}
    return any(
        second == instance.name and waiting_for(plan, first) != first and name in slots[first]
        for first, second in plan.order
    )


def _find_path(task: Task, block: Block, movements: Sequence[Sweep], movement: Sweep, name: str) -> FloatArray | None:
    """Return the straight path ``(2, 3)`` [m] of a hand to a place where it is not in the way, or None."""
    bodies, world = bodies_of(task), movement.trace.world
    here = pose_of(world, name)
    mine = set(movement.instance.slots.values())
    others = [Neighbour(bodies[each], pose_of(world, each)) for each in bodies if each not in (name, *mine)]
    distances = [find_nearest(bodies[name], here, each.body, each.pose).distance for each in others]
    obstacles = [obstacle_near(*pair) for pair in zip(others, distances, strict=True)]
    space = FreeSpace(
        [Carried(bodies[name], np.zeros(3), here.orientation)],
        obstacles,
        lambda position: _margin(task, block, movement, name, position),
        _MOST_CHECKS,
    )
    later = [each for each in movements if name not in each.instance.slots.values()]
    later = later[later.index(movement) :]
    places = list(_places(space, here))
    for passing in (later, [movement]):
        for place in places:
            if all(_is_clear(each, bodies[name], Pose(place, here.orientation)) for each in passing):
                return np.array([here.position, place])
    return None


def _places(space: FreeSpace, here: Pose) -> Iterator[FloatArray]:
    """Yield places ``(3,)`` [m] to which the hand can move straight, the nearest ones first."""
    try:
        for distance in _DISTANCES:
            for direction in directions_upwards():
                place = here.position + distance * direction
                if space.slack(place) > 0.0 and space.is_free(here.position, place):
                    yield place
    except OutOfChecks:
        return


def _margin(task: Task, block: Block, movement: Sweep, name: str, position: FloatArray) -> FloatArray:
    """Return the least margin ``(...)`` [m] of the invariants of the block if the hand is at positions ``(..., 3)``."""
    world, binding = movement.trace.world, task.bind({block.anchor: name})
    moved = world.replace({(name, "position"): position})
    margins = [each.margin(moved, binding) for each in block.invariants if each.predicate.unit == "m"]
    return np.asarray(np.min(margins, axis=0) if margins else np.inf)


def _is_clear(movement: Sweep, body: Body, pose: Pose) -> bool:
    """Return whether a movement passes a body at a distance."""
    return find_clearance(movement.tracks, [(body, pose)], limit=CLEARANCE) is None


def _insert(
    task: Task, plan: TaskPlan, rest: BlockInstance, waits: BlockInstance, block: Block
) -> tuple[TaskPlan, str] | None:
    """Return the plan with an instance of a block while a token rests, and the name of the instance.

    The instance is before `waits`. All instances that start with `waits`, or later, start later by the duration of a
    rest and of the new instance. The result is None if an instance that ends there cannot last longer.
    """
    instant, delay = waits.start, 2.0 * _RESTS + _WITHDRAWS
    delayed, longer = _delayed(plan, waits)
    blocks = task.domain.block_by_name
    if rest.name in delayed or not all(blocks[each.block].hold for each in plan.instances if each.name in longer):
        return None
    begin = max(instant, rest.start + _RESTS)
    names = [_new_name(plan, each) for each in (block.name, rest.block)]
    instances: list[BlockInstance] = []
    for each in plan.instances:
        late = each.start > instant and not at(each.start, instant)
        later = each.end > instant and not at(each.end, instant)
        start = each.start + delay * (late or each.name in delayed)
        moved = each.during(start, each.end + delay * (later or each.name in longer))
        if each is not rest:
            instances.append(moved)
            continue
        end = begin + _WITHDRAWS
        withdrawal = BlockInstance(names[0], block.name, {block.anchor: rest.slots["token"]}, begin, end, reached=end)
        again = replace(rest, name=names[1], start=end, end=moved.end, reached=end + _RESTS)
        instances += [replace(rest, end=begin), withdrawal, again]
    instances.sort(key=lambda each: (each.start, each.end, each.name))
    return replace(plan, instances=tuple(instances), makespan=plan.makespan + delay), names[0]


def _delayed(plan: TaskPlan, waits: BlockInstance) -> tuple[set[str], set[str]]:
    """Return the instances that must start together with an instance, and those that end at this instant."""
    delayed, longer, queue = {waits.name}, set[str](), [waits]
    while queue:
        instance = queue.pop()
        for token in instance.slots.values():
            before = plan.before(instance, token)
            if before is None or before[0].name in longer:
                continue
            longer.add(before[0].name)
            for other in before[0].slots.values():
                after = next((each for each, _ in plan.timeline(other) if at(each.start, before[0].end)), None)
                if after is not None and after.name not in delayed:
                    delayed.add(after.name)
                    queue.append(after)
    return delayed, longer


def _new_name(plan: TaskPlan, block: str) -> str:
    """Return an unused name of an instance of a block."""
    used, number = {each.name for each in plan.instances}, 1
    while f"{block}-{number}" in used:
        number += 1
    return f"{block}-{number}"
