"""Proofs that nothing avoids a collision of a movement with bodies that no block can move.

A movement along a path is compared with the largest ball around the position of its leading token. The ball starts at
the token's initial position, because all movements are continuous. So a proof holds wherever the token is when the
movement starts. A movement that is always straight, e.g. a roll, is compared up to the first point of its goal.
"""

from collections.abc import Iterable, Iterator
from itertools import chain

import numpy as np

from hybrid_tamp.geometry.convex import ConvexBody, placed
from hybrid_tamp.geometry.nearness import inner_balls
from hybrid_tamp.model.predicate import Binding, Literal
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import rotate
from hybrid_tamp.paths.proofs import Ball, Margins, is_barred, is_cut_off
from hybrid_tamp.planning.clearance import Sweep

_ASIDE = 5e-3
"""Largest distance of a body from its straight way [m]."""
_TURNED = 1e-3
"""Largest displacement by which a ball counts as not turning around the body [m]."""


def prove_blocked(task: Task, movement: Sweep) -> str:
    """Return why nothing avoids the collision of a movement, as the end of a sentence. Empty if nothing is proven."""
    block = task.domain.block_by_name[movement.instance.block]
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
        if is_barred(balls, bodies, ahead, _arrives(task, movement, slot), _ASIDE):
            return "and this movement is always straight"
    return ""


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
