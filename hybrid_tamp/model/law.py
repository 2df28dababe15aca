"""The law of assignment, and a checker of the law. An instance is one execution of a block.

1. At every instant, each token is in exactly one slot of exactly one instance. Places are exempt.
2. A running instance has exactly one token in each slot, and the token is a member of the slot's class.
3. A token passes from one slot to another only along an edge of the network.
4. All tokens of an instance enter their slots at the same instant, and leave their slots together at a later instant.
5. At each reassignment, the exit conditions of ending instances and the entry conditions of starting instances hold. No
   other instance changes a property that a running instance reads from its targets.
6. The duration of each instance is within the bounds of its block. A block with `hold` can exceed its maximum, because
   such a block continues after its exit conditions hold.
7. The plan starts with the initial state and the initial assignment. At the end of the plan, the goal holds and only
   blocks with `hold` run.

The checker is independent of the planner. In a plan, the effects of blocks decide whether a condition holds. In a
recording, the measured margins decide.
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
    """Return every violation of the law by the plan.

    Args:
        task: task of the plan.
        plan: timeline to check. The timeline of a recording has measured instants.
        measured: function that returns the measured state at an instant. If None, declared effects are checked.
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
            yield Violation(2, instance.start, instance.name, f"the domain has no block {instance.block}")
        for token in instance.slots.values():
            if token not in task.token_by_name:
                yield Violation(1, instance.start, instance.name, f"the task has no token {token}")


def _instances(task: Task, plan: TaskPlan) -> Iterator[Violation]:
    """Check laws 2 and 4: each instance has well-typed tokens in all roles, a duration and a unique name."""
    names = Counter(instance.name for instance in plan.instances)
    for instance in plan.instances:
        block = task.domain.block_by_name[instance.block]
        yield from (Violation(2, instance.start, instance.name, said) for said in _typing(task, block, instance))
        if instance.end - instance.start <= TIME_TOLERANCE:
            yield Violation(4, instance.start, instance.name, "the duration of the instance must not be zero")
        if names[instance.name] > 1:
            yield Violation(4, instance.start, instance.name, "the name of the instance must be unique")


def _typing(task: Task, block: Block, instance: BlockInstance) -> Iterator[str]:
    slots = {slot.name for slot in block.slots}
    if set(instance.slots) != slots:
        yield f"the instance must have one token in each of the slots {sorted(slots)}, got {sorted(instance.slots)}"
    if set(instance.targets) != {target.name for target in block.targets}:
        targets = sorted(target.name for target in block.targets)
        yield f"the instance must have the targets {targets}, got {sorted(instance.targets)}"
    for role, name in instance.roles.items():
        sort = block.roles.get(role)
        if sort is not None and not _of_sort(task, name, sort):
            yield f"{name} cannot have the role {role}, because {name} is not a member of {sort.name}"
    tokens = [name for name in instance.roles.values() if name in task.token_by_name]
    if len(set(tokens)) < len(tokens):
        yield "a token must not have two roles of the same instance"


def _of_sort(task: Task, name: str, sort: type[ObjectClass] | SymbolSort) -> bool:
    if isinstance(sort, SymbolSort):
        return name in sort.symbols
    return name in task.token_by_name and task.token_by_name[name].is_member(sort)


def _conservation(task: Task, plan: TaskPlan) -> Iterator[Violation]:
    """Check laws 1, 3 and 7: the instances of each token follow one another along edges, without gaps or overlaps."""
    for token in task.assigned:
        timeline = plan.timeline(token.name)
        clock = 0.0
        for index, (instance, slot) in enumerate(timeline):
            if not at(instance.start, clock):
                fault = "in no slot just before" if instance.start > clock else "still in another slot at the start of"
                yield Violation(1, clock, token.name, f"the token is {fault} {instance.name}")
            clock = instance.end
            if index:
                before, slot_before = timeline[index - 1]
                source, target = (before.block, slot_before), (instance.block, slot)
                if not task.domain.network.allows(source, target):
                    edge = f"{'.'.join(source)} -> {'.'.join(target)}"
                    yield Violation(3, instance.start, token.name, f"the network has no edge {edge}")
        if not at(clock, plan.makespan):
            fault = "in no slot" if clock < plan.makespan else "in a slot after the end of the plan"
            yield Violation(1, clock, token.name, f"the token is {fault}")
        wanted = task.start_block(token.name).name
        if timeline and timeline[0][0].block != wanted:
            yield Violation(7, 0.0, token.name, f"the token must start in block {wanted}, got {timeline[0][0].block}")


def _durations(task: Task, plan: TaskPlan) -> Iterator[Violation]:
    """Check law 6. At the end of the plan, blocks with `hold` and without exit conditions have no minimum duration."""
    for instance in plan.instances:
        block = task.domain.block_by_name[instance.block]
        length = instance.end - instance.start
        cut = block.hold and at(instance.end, plan.makespan) and not block.exit
        if length < block.duration.minimum - TIME_TOLERANCE and not cut:
            said = f"the instance must last at least {block.duration.minimum} s, got {length:.3f} s"
            yield Violation(6, instance.start, instance.name, said)
        if instance.reached is not None and instance.reached > instance.end + TIME_TOLERANCE:
            late = instance.reached - instance.end
            said = f"the instance ends {late:.3f} s before its exit conditions hold"
            yield Violation(6, instance.end, instance.name, said)
        if not block.hold and length > block.duration.maximum + TIME_TOLERANCE:
            said = f"the instance must last at most {block.duration.maximum} s, got {length:.3f} s"
            yield Violation(6, instance.end, instance.name, said)


def _targets(task: Task, plan: TaskPlan) -> Iterator[Violation]:
    """Check law 5 for targets. An instance with `hold` changes its tokens only until its exit conditions hold."""
    for reader in plan.instances:
        for target in task.domain.block_by_name[reader.block].targets:
            name = reader.targets.get(target.name)
            for writer, slot in plan.timeline(name) if name is not None else ():
                written = task.domain.block_by_name[writer.block].writes.get(slot, ())
                if set(written) & set(target.reads) and writer.name != reader.name and _meet(writer, reader):
                    said = f"{writer.name} changes the target {name} of {reader.name}"
                    yield Violation(5, max(reader.start, writer.start), reader.name, said)


def _meet(writer: BlockInstance, reader: BlockInstance) -> bool:
    begins_within = reader.start + TIME_TOLERANCE < writer.start < reader.end - TIME_TOLERANCE
    return begins_within or writer.active.overlaps(reader)


def _ends(task: Task, plan: TaskPlan) -> Iterator[Violation]:
    """Check law 7: only blocks with `hold` run at the end of the plan."""
    for instance in plan.instances:
        if at(instance.end, plan.makespan) and not task.domain.block_by_name[instance.block].hold:
            said = "only instances of blocks with hold=True can run at the end of the plan"
            yield Violation(7, plan.makespan, instance.name, said)
