"""The law of assignment and its one checker.

1. At every instant each token is in exactly one slot of exactly one instance; places are exempt.
2. A running instance has exactly one token in each slot, a member of the slot's class.
3. A token passes from slot to slot only along an edge of the network.
4. All tokens of an instance enter it at one instant and leave it at a later one.
5. At each instant of reassignment, the exit conditions of ending blocks and the entry conditions of starting blocks
   hold. No other instance changes a property that a running instance reads from its targets.
6. The duration of each instance is within the bounds of its block; only a block with a hold waits.
7. The plan starts in the initial state and assignment. At its end the goal holds and only blocks with a hold run.

The checker is independent of the planner. The effects of blocks (for a plan) or measured margins (for a recording)
decide the conditions.
"""

from collections import Counter
from collections.abc import Iterator

from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.conditions import Measured, Violation, condition_faults
from hybrid_tamp.model.plan import TIME_TOLERANCE, BlockInstance, TaskPlan, at
from hybrid_tamp.model.predicate import SymbolSort
from hybrid_tamp.model.task import Task


def check_law(task: Task, plan: TaskPlan, measured: Measured | None = None) -> list[Violation]:
    """Return every breach of the law by the plan.

    Args:
        task: the task of the plan.
        plan: the timeline; for a recording, with the measured instants of reassignment.
        measured: returns the measured state at an instant, whose margins decide the conditions instead of the
            declared effects.
    """
    unknown = list(_names(task, plan))
    if unknown:
        return unknown
    found = [
        *_instances(task, plan),
        *_conservation(task, plan),
        *_durations(task, plan),
        *_targets(task, plan),
        *_ends(task, plan),
    ]
    return [*found, *condition_faults(task, plan, measured)]


def _names(task: Task, plan: TaskPlan) -> Iterator[Violation]:
    for instance in plan.instances:
        if instance.block not in task.domain.block_by_name:
            yield Violation(2, instance.start, instance.name, f"there is no block {instance.block}")
        for token in instance.slots.values():
            if token not in task.token_by_name:
                yield Violation(1, instance.start, instance.name, f"there is no token {token}")


def _instances(task: Task, plan: TaskPlan) -> Iterator[Violation]:
    """Laws 2 and 4: each instance is complete and well-typed and has a duration and a unique name."""
    names = Counter(instance.name for instance in plan.instances)
    for instance in plan.instances:
        block = task.domain.block_by_name[instance.block]
        yield from (Violation(2, instance.start, instance.name, said) for said in _typing(task, block, instance))
        if instance.end - instance.start <= TIME_TOLERANCE:
            yield Violation(4, instance.start, instance.name, "the instance has length zero")
        if names[instance.name] > 1:
            yield Violation(4, instance.start, instance.name, "tokens of one instance do not enter and leave together")


def _typing(task: Task, block: Block, instance: BlockInstance) -> Iterator[str]:
    slots = {slot.name for slot in block.slots}
    if set(instance.slots) != slots:
        yield f"needs one token in each of {sorted(slots)}, has {sorted(instance.slots)}"
    if set(instance.targets) != {target.name for target in block.targets}:
        yield f"needs the targets {sorted(t.name for t in block.targets)}, has {sorted(instance.targets)}"
    for role, name in instance.roles.items():
        sort = block.roles.get(role)
        if sort is not None and not _of_sort(task, name, sort):
            yield f"{name} in {role} is not of {sort.name}"
    tokens = [name for name in instance.roles.values() if name in task.token_by_name]
    if len(set(tokens)) < len(tokens):
        yield "one token has two roles"


def _of_sort(task: Task, name: str, sort: type[ObjectClass] | SymbolSort) -> bool:
    if isinstance(sort, SymbolSort):
        return name in sort.symbols
    return name in task.token_by_name and task.token_by_name[name].is_member(sort)


def _conservation(task: Task, plan: TaskPlan) -> Iterator[Violation]:
    """Laws 1, 3 and the assignment part of 7: each token's instances cover the plan without overlap, along edges."""
    for token in task.assigned:
        timeline = plan.timeline(token.name)
        clock = 0.0
        for index, (instance, slot) in enumerate(timeline):
            if not at(instance.start, clock):
                fault = "in no slot" if instance.start > clock else "in two slots"
                yield Violation(1, clock, token.name, f"{fault} before {instance.name}")
            clock = instance.end
            if index:
                before, slot_before = timeline[index - 1]
                source, target = (before.block, slot_before), (instance.block, slot)
                if not task.domain.network.allows(source, target):
                    edge = f"{'.'.join(source)} -> {'.'.join(target)}"
                    yield Violation(3, instance.start, token.name, f"the network has no edge {edge}")
        if not at(clock, plan.makespan):
            fault = "in no slot" if clock < plan.makespan else "in a slot beyond the plan's end"
            yield Violation(1, clock, token.name, fault)
        wanted = task.start_block(token.name).name
        if timeline and timeline[0][0].block != wanted:
            yield Violation(7, 0.0, token.name, f"starts in {timeline[0][0].block}, assigned to {wanted}")


def _durations(task: Task, plan: TaskPlan) -> Iterator[Violation]:
    """Law 6; a holding instance that the end of the plan interrupts may be shorter than the minimum of its block."""
    for instance in plan.instances:
        block = task.domain.block_by_name[instance.block]
        length = instance.end - instance.start
        cut = block.hold and at(instance.end, plan.makespan) and not block.exit
        if length < block.duration.minimum - TIME_TOLERANCE and not cut:
            yield Violation(6, instance.start, instance.name, f"lasts {length:.3f} s < {block.duration.minimum} s")
        if instance.reached is not None and instance.reached > instance.end + TIME_TOLERANCE:
            late = instance.reached - instance.end
            yield Violation(6, instance.end, instance.name, f"ends {late:.3f} s before its exit conditions hold")
        if not block.hold and length > block.duration.maximum + TIME_TOLERANCE:
            yield Violation(6, instance.end, instance.name, f"lasts {length:.3f} s > {block.duration.maximum} s")


def _targets(task: Task, plan: TaskPlan) -> Iterator[Violation]:
    """Law 5, last part: no other instance changes a property that a running instance reads from its targets.

    A block with a hold changes its tokens only until its exit conditions hold.
    """
    for reader in plan.instances:
        for target in task.domain.block_by_name[reader.block].targets:
            name = reader.targets.get(target.name)
            for writer, slot in plan.timeline(name) if name is not None else ():
                written = task.domain.block_by_name[writer.block].writes.get(slot, ())
                if set(written) & set(target.reads) and writer.name != reader.name and _meet(writer, reader):
                    said = f"its target {name} is changed by {writer.name}"
                    yield Violation(5, max(reader.start, writer.start), reader.name, said)


def _meet(writer: BlockInstance, reader: BlockInstance) -> bool:
    begins_within = reader.start + TIME_TOLERANCE < writer.start < reader.end - TIME_TOLERANCE
    return begins_within or writer.active.overlaps(reader)


def _ends(task: Task, plan: TaskPlan) -> Iterator[Violation]:
    """Law 7: only blocks with a hold run at the end."""
    for instance in plan.instances:
        if at(instance.end, plan.makespan) and not task.domain.block_by_name[instance.block].hold:
            yield Violation(7, plan.makespan, instance.name, "a block without a hold has not ended")
