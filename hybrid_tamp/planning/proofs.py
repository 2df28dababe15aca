"""Proofs that nothing avoids a collision of a movement with bodies that no block can move.

A movement along a path is compared with the largest ball around the position of its leading token. The ball starts at
the token's initial position, because all movements are continuous. So a proof holds wherever the token is when the
movement starts. A movement that is always straight, e.g. a roll, is compared up to the first point of its goal.
"""

from collections.abc import Iterable, Iterator, Sequence
from itertools import chain

import numpy as np

from hybrid_tamp.collision.bodies import Pose
from hybrid_tamp.collision.overlaps import Obstruction, convex_solids
from hybrid_tamp.geometry.convex import ConvexBody, placed
from hybrid_tamp.geometry.nearness import inner_balls
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.key_pose import KeyPose
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.predicate import Binding, Literal, SymbolSort
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import rotate
from hybrid_tamp.paths.proofs import Ball, Margins, is_barred, is_cut_off, way_to_goal
from hybrid_tamp.planning.clearance import Sweep

_ASIDE = 5e-3
"""Largest distance of a body from its straight way [m]."""
EQUAL = 1e-6
"""Largest difference of the components of equal orientations."""
_TURNED = 1e-3
"""Largest displacement by which a ball counts as not turning around the body [m]."""


def prove_blocked(task: Task, movement: Sweep, before: Sequence[Sweep]) -> str:
    """Return why nothing avoids the collision of a movement, as the end of a sentence. Empty if nothing is proven.

    Args:
        task: task of the plan.
        movement: the movement.
        before: movements of the plan that start earlier.
    """
    block, roles = task.domain.block_by_name[movement.instance.block], movement.instance.roles
    if not all(is_determined(task, name, before) for role, name in roles.items() if role != block.path):
        return ""
    bodies = list(chain(*_standing(task, movement.trace.world)))
    if block.path is not None:
        slot = block.path
        ball = next(_balls(task, movement, slot, task.state))
        cut_off = ball.radius > 0.0 and is_cut_off(
            ball, bodies, _admits(task, movement, slot), _arrives(task, movement, slot)
        )
        return "and no path avoids all bodies that stay where they are" if cut_off else ""
    for slot, direction in block.straight.items():
        balls = list(_balls(task, movement, slot, movement.trace.world))
        ahead = direction(task.bind(movement.instance.roles), movement.trace.world)
        arrives = _arrives(task, movement, slot)
        way = way_to_goal(balls[0], ahead, arrives, _ASIDE)
        if is_barred(balls, bodies, ahead, arrives, _ASIDE) or _hits(task, movement, slot, way):
            return "and this movement is always straight"
    return ""


def _hits(task: Task, movement: Sweep, slot: str, way: FloatArray) -> bool:
    """Return whether a token that does not turn hits a body on its way, given as offsets from its start [m]."""
    name = movement.instance.slots[slot]
    turns = next(each.orientations for each in movement.tracks if each.body.name == name)
    if np.abs(turns - turns[0]).max() > EQUAL:
        return False
    start = movement.trace.world[name, "position"]
    found = obstruct(task, movement, KeyPose(slot, start, turns[0], _ASIDE))
    return any(found.find(each) is not None for each in way)


def obstruct(task: Task, movement: Sweep, pose: KeyPose) -> Obstruction:
    """Return a body of a movement in a key pose, with the bodies that it must not hit and that no block can move."""
    name = movement.instance.slots[pose.slot]
    index = next(index for index, track in enumerate(movement.tracks) if track.body.name == name)
    others = {
        each.body.name: convex_solids(each.body, each.pose)
        for each in movement.neighbours[index]
        if not task.domain.moving_slots(task.token_by_name[each.body.name])
    }
    body = movement.tracks[index].body
    return Obstruction(name, convex_solids(body, Pose(pose.position, pose.orientation)), others, pose.within)


def is_determined(task: Task, name: str, before: Sequence[Sweep]) -> bool:
    """Return whether the initial state and the symbols of a plan determine where a token is after some movements.

    Hands count as determined, because conditions say where they begin.
    """
    token = task.token_by_name.get(name)
    if token is None or token.basic_actions:
        return True
    blocks = ((task.domain.block_by_name[each.instance.block], each.instance) for each in find_movers(name, before))
    return all(_ends_by_symbols(block, instance, name) for block, instance in blocks)


def find_movers(name: str, before: Sequence[Sweep]) -> list[Sweep]:
    """Return those movements that move a token."""
    return [each for each in before if any(track.body.name == name for track in each.tracks)]


def _ends_by_symbols(block: Block, instance: BlockInstance, name: str) -> bool:
    slot = next(slot for slot, token in instance.slots.items() if token == name)
    ends = block.ends.get(slot, ())
    return bool(ends) and all(isinstance(block.roles[role], SymbolSort) for role in ends)


def _standing(task: Task, world: State) -> Iterable[list[ConvexBody]]:
    """Yield the bodies that no block can move."""
    for token in task.tokens:
        if token.shape is not None and not task.domain.moving_slots(token):
            yield list(placed(token.solid, world[token, "position"], world[token, "orientation"]))


def _balls(task: Task, movement: Sweep, slot: str, start: State) -> Iterator[Ball]:
    """Yield balls within a moving token that do not turn around it, first the largest ball around its position."""
    token = task.token_by_name[movement.instance.slots[slot]]
    track = next(each for each in movement.tracks if each.body.name == token.name)
    for centre, radius in inner_balls(token.solid):
        offsets = rotate(track.orientations, centre)
        if np.abs(offsets - offsets[0]).max() <= _TURNED:
            yield Ball(radius, start[token, "position"] + offsets[0], track.positions[-1] + offsets[0])


def _arrives(task: Task, movement: Sweep, slot: str) -> Margins:
    """Return the least margin of the exit conditions on lengths that name no other token that the instance moves."""
    block, instance = task.domain.block_by_name[movement.instance.block], movement.instance
    others = {name for name in instance.slots if name != slot}
    exits = (each for each in block.measured_exits if slot in each.arguments and not others & {*each.arguments})
    return _margins(exits, task.bind(instance.roles), movement.trace.world, instance.slots[slot])


def _admits(task: Task, movement: Sweep, slot: str) -> Margins:
    """Return the least margin of the conditions on lengths that hold whenever the token moves.

    These conditions are invariants of all blocks that move the token, and name no other token.
    """
    token = task.token_by_name[movement.instance.slots[slot]]
    common = [
        {each.predicate.name: each for each in block.invariants if {*each.arguments} == {name}}
        for block, name in task.domain.moving_slots(token)
    ]
    shared = set.intersection(*(set(each) for each in common))
    block = task.domain.block_by_name[movement.instance.block]
    literals = (each for each in block.invariants if each.predicate.name in shared and {*each.arguments} == {slot})
    return _margins(literals, {slot: token}, movement.trace.world, token.name)


def _margins(literals: Iterable[Literal], binding: Binding, world: State, name: str) -> Margins:
    measured = [each for each in literals if each.predicate.unit == "m"]

    def margins(positions: FloatArray) -> FloatArray:
        states = world.repeated(len(positions)).replace({(name, "position"): positions})
        found = [np.full(len(positions), np.inf), *(each.margin(states, binding) for each in measured)]
        return np.asarray(np.min(found, axis=0))

    return margins
