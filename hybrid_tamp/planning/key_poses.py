"""Proofs that a movement fails, because each of its executions brings a body into a body that no block can move.

The proofs use the key poses of blocks. The object that a movement begins with must stand where it stands for certain:
at its initial pose, or where symbols alone determine its pose. If an earlier movement brings it to a place with a
tolerance, e.g. into a region, then the proof covers all places within this tolerance.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hybrid_tamp.collision.overlaps import Margins, Overlap, overlaps_everywhere
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.expectation import declared_key_poses
from hybrid_tamp.model.key_pose import KeyPose
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.predicate import Atom, Literal
from hybrid_tamp.model.refined import CLEAR, Shortfall
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.planning.clearance import Sweep
from hybrid_tamp.planning.proofs import EQUAL, find_movers, is_determined, obstruct


@dataclass(frozen=True)
class _Spread:
    """Where an object may be when a movement begins.

    Attributes:
        admits: function of the offset from the predicted place that is not negative where the object may be.
        inside: the atom that holds there, which says that the object is in a place.
    """

    admits: Margins
    inside: Atom


def prove_overlap(task: Task, movement: Sweep, before: Sequence[Sweep]) -> Shortfall | None:
    """Return why every execution of an instance brings a body into a fixed body, or None if this is not proven.

    Args:
        task: task of the plan.
        movement: movement of the instance.
        before: movements of the plan that start earlier, in order.
    """
    instance = movement.instance
    block = task.domain.block_by_name[instance.block]
    poses = declared_key_poses(block, task.bind(instance.roles), movement.trace.world)
    if not poses:
        return None
    loose = [name for name in instance.roles.values() if not is_determined(task, name, before)]
    spread = _find_spread(task, movement, loose[0], before) if len(loose) == 1 else None
    if loose and spread is None:
        return None
    obstructions = [obstruct(task, movement, each) for each in poses if not _may_begin(task, block, instance, each)]
    found = [each.find(np.zeros(3)) for each in obstructions]
    worst = max((each for each in found if each), key=lambda each: each.depth, default=None)
    if worst is None:
        return None
    if spread is None:
        return _describe(instance, worst, "which no execution of this movement avoids")
    if not overlaps_everywhere(obstructions, spread.admits):
        return None
    remark = f"and fixed bodies are in the way of this movement wherever {spread.inside.text} holds"
    return replace(_describe(instance, worst, remark), wherever=spread.inside)


def _find_spread(task: Task, movement: Sweep, name: str, before: Sequence[Sweep]) -> _Spread | None:
    """Return where an object may be that earlier movements have shifted but not turned."""
    movers = find_movers(name, before)
    turns = np.concatenate([next(t for t in each.tracks if t.body.name == name).orientations for each in movers])
    if name not in movement.instance.slots.values() or np.abs(turns - turns[0]).max() > EQUAL:
        return None
    last, world = movers[-1].instance, movement.trace.world
    slot = next(slot for slot, token in last.slots.items() if token == name)
    literal = _placing_exit(task.domain.block_by_name[last.block], slot)
    if literal is None:
        return None
    roles = task.bind(last.roles)

    def admits(offsets: FloatArray) -> FloatArray:
        positions = world[name, "position"] + offsets
        return literal.margin(world.repeated(len(offsets)).replace({(name, "position"): positions}), roles)

    return _Spread(admits, literal.ground(roles))


def _placing_exit(block: Block, slot: str) -> Literal | None:
    """Return the exit condition that says in which place the token of a slot is afterwards, or None."""
    for literal in block.measured_exits:
        index = literal.predicate.functional_index
        if literal.positive and index is not None and literal.predicate.unit == "m" and slot in literal.arguments:
            return literal
    return None


def _may_begin(task: Task, block: Block, instance: BlockInstance, pose: KeyPose) -> bool:
    """Return whether a hand is initially near its place, so that it may begin elsewhere than after a reach."""
    if not task.token_by_name[instance.slots[pose.slot]].basic_actions:
        return False
    roles = task.bind(instance.roles)
    asked = [each for each in block.measured_entries if each.predicate.maintained and pose.slot in each.arguments]
    return bool(asked) and all(float(each.margin(task.state, roles)) >= 0.0 for each in asked)


def _describe(instance: BlockInstance, worst: Overlap, remark: str) -> Shortfall:
    atom = Atom(CLEAR, (worst.moving, worst.other))
    return Shortfall(instance.name, atom, "m", -worst.depth, remark, worst.place, proven=True)
