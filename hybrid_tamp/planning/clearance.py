"""Collisions of a plan's movements with bodies that the plan does not move.

The movements are those of the forward models. The poses of a movement are compared with each body at rest that takes no
part in the movement, by bisection on distances (`collision.sweeps`). Contacts that the block allows are left out.
"""

from collections.abc import Iterator

from hybrid_tamp.collision.bodies import Body, Pose, bodies_of, bound_distance, find_nearest, pose_of
from hybrid_tamp.collision.sweeps import Clearance, Track, find_clearance
from hybrid_tamp.midlevel.rollout import Rollouts
from hybrid_tamp.model.contacts import ContactRules
from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.refined import CLEAR, Shortfall
from hybrid_tamp.model.task import Task

_EVERY = 8
"""Number of control steps between two poses of a track."""
_TOUCHING = 1e-3
"""Largest distance of bodies that touch at the start of a movement, e.g. a block and its table [m]."""


def find_collision(task: Task, plan: TaskPlan, deadline: Deadline = NEVER) -> Shortfall | None:
    """Return the first movement of a plan that hits a body at rest, with the depth, or None if there is no such body.

    Args:
        task: task of the plan.
        plan: plan with a value for every hyperparameter.
        deadline: deadline of the command.

    Raises:
        LimitReached: the deadline passes.
    """
    obstacles = {name: body for name, body in bodies_of(task).items() if name not in _moved(task, plan)}
    if not obstacles:
        return None
    rollouts = Rollouts(task, plan, deadline)
    for instance in sorted(plan.instances, key=lambda i: (i.start, i.name)):
        others = {name: body for name, body in obstacles.items() if name not in instance.roles.values()}
        if others and task.domain.block_by_name[instance.block].moves:
            found = _find_least(task, instance, rollouts, others)
            if found is not None:
                return Shortfall(instance.name, Atom(CLEAR, (found.moving, found.other)), "m", found.distance)
    return None


def _moved(task: Task, plan: TaskPlan) -> set[str]:
    """Return the names of the tokens that some instance of the plan moves."""
    blocks = task.domain.block_by_name
    return {
        token
        for instance in plan.instances
        for slot, token in instance.slots.items()
        if blocks[instance.block].writes.get(slot)
    }


def _find_least(task: Task, instance: BlockInstance, rollouts: Rollouts, others: dict[str, Body]) -> Clearance | None:
    """Return the least distance of a movement from bodies at rest if it is negative, or else None."""
    rules = ContactRules(
        task.domain.block_by_name,
        [instance],
        [token.name for token in task.tokens if token.fixed_body],
        task.token_by_name,
    )
    best: Clearance | None = None
    for track in _tracks(task, instance, rollouts):
        begin = track.at(0.0)
        near = [
            (body, pose)
            for name, body in others.items()
            for pose in [pose_of(task.state, name)]
            if not rules.allow(track.body.name, name, task.state) and not _touch(track.body, begin, body, pose)
        ]
        limit = 0.0 if best is None else best.distance
        best = find_clearance([track], near, limit=limit) or best
    return best


def _touch(one: Body, at: Pose, other: Body, there: Pose) -> bool:
    return (
        bound_distance(one, at, other, there) <= _TOUCHING and find_nearest(one, at, other, there).distance <= _TOUCHING
    )


def _tracks(task: Task, instance: BlockInstance, rollouts: Rollouts) -> Iterator[Track]:
    """Yield the tracks of the tokens that an instance moves."""
    block, states = task.domain.block_by_name[instance.block], rollouts.trace(instance.name)
    last = len(states.values) - 1
    rows = [*range(0, last, _EVERY), last]
    for slot, name in instance.slots.items():
        token = task.token_by_name[name]
        if token.shape is not None and "position" in block.writes.get(slot, ()):
            body = Body(name, token.solid)
            yield Track(body, states[token, "position"][rows], states[token, "orientation"][rows])
