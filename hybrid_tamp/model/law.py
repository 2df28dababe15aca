"""The law of assignment and its one checker.

1. At every instant each token is in exactly one slot of exactly one instance; places are exempt.
2. A running instance has exactly one token in each slot, a member of the slot's class.
3. A token passes from slot to slot only along an edge of the network.
4. The tokens of an instance enter it at one instant and leave it at one; none has length zero.
5. At that instant the exit conditions of every ending and the entry conditions of every starting block hold, and
   nothing that a running instance reads of its targets is changed by another.
6. Each instance lasts within its block's bounds; blocks abut, and what must wait holds.
7. The plan starts in the initial state and assignment, and the goal holds at its end with every bounded block ended.

The checker knows nothing of how a plan was made. It judges conditions on symbols (effects of blocks, for a plan) or
on measured margins (for a recording).
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.facts import facts, static_facts
from hybrid_tamp.model.plan import TIME_TOLERANCE, BlockInstance, TaskPlan, at
from hybrid_tamp.model.predicate import Atom, Literal
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task

Measured = Callable[[float], State]
"""Time [s] to the state measured at that instant."""


@dataclass(frozen=True)
class Violation:
    """One breach of the law: its number, the instant [s], the instance or token, and what is wrong."""

    law: int
    time: float
    where: str
    message: str

    def __str__(self) -> str:
        return f"law {self.law} at {self.time:.3f} s, {self.where}: {self.message}"


def check_law(task: Task, plan: TaskPlan, measured: Measured | None = None) -> list[Violation]:
    """Return every breach of the law by the plan.

    Args:
        task: the task that the plan is for.
        plan: the timeline; of a recording, with the instants at which reassignments happened.
        measured: the state at an instant, to judge conditions by their measured margins instead of by the
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
    judge = _Symbols(task, plan) if measured is None else _Margins(task, plan, measured)
    return [*found, *judge.violations()]


def _names(task: Task, plan: TaskPlan) -> Iterator[Violation]:
    for instance in plan.instances:
        if instance.block not in task.domain.block_by_name:
            yield Violation(2, instance.start, instance.name, f"there is no block {instance.block}")
        for token in instance.slots.values():
            if token not in task.token_by_name:
                yield Violation(1, instance.start, instance.name, f"there is no token {token}")


def _instances(task: Task, plan: TaskPlan) -> Iterator[Violation]:
    """Laws 2 and 4: complete, well-typed instances that have a length and one name each."""
    names = [instance.name for instance in plan.instances]
    for instance in plan.instances:
        block = task.domain.block_by_name[instance.block]
        yield from (Violation(2, instance.start, instance.name, said) for said in _typing(task, block, instance))
        if instance.end - instance.start <= TIME_TOLERANCE:
            yield Violation(4, instance.start, instance.name, "the instance has length zero")
        if names.count(instance.name) > 1:
            yield Violation(4, instance.start, instance.name, "tokens of one instance enter or leave apart")


def _typing(task: Task, block: Block, instance: BlockInstance) -> Iterator[str]:
    slots = {slot.name for slot in block.slots}
    if set(instance.slots) != slots:
        yield f"needs one token in each of {sorted(slots)}, has {sorted(instance.slots)}"
    if set(instance.targets) != {target.name for target in block.targets}:
        yield f"needs the targets {sorted(t.name for t in block.targets)}, has {sorted(instance.targets)}"
    for role, name in instance.roles.items():
        sort = block.roles.get(role)
        if sort is not None and name not in {v if isinstance(v, str) else v.name for v in task.values_of(sort)}:
            yield f"{name} in {role} is not of {sort.name}"
    tokens = [name for name in instance.roles.values() if name in task.token_by_name]
    if len(set(tokens)) < len(tokens):
        yield "one token has two roles"


def _conservation(task: Task, plan: TaskPlan) -> Iterator[Violation]:
    """Laws 1, 3 and the assignment part of 7: each token's instances tile the time, along edges."""
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
        wanted = task.assignment.get(token.name, task.domain.resting)
        if timeline and timeline[0][0].block != wanted:
            yield Violation(7, 0.0, token.name, f"starts in {timeline[0][0].block}, assigned to {wanted}")


def _durations(task: Task, plan: TaskPlan) -> Iterator[Violation]:
    """Law 6. What the plan's end cuts short may be shorter than its block's minimum."""
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
    """Law 5, last part: nothing changes what a running instance reads of its targets.

    A block that holds changes something until its exit conditions hold; from then on others may read it.
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
    """Law 7: at the end only blocks that hold are running."""
    for instance in plan.instances:
        if at(instance.end, plan.makespan) and not task.domain.block_by_name[instance.block].hold:
            yield Violation(7, plan.makespan, instance.name, "a block without a hold has not ended")


class _Judge:
    """Law 5 and the goal of law 7, by conditions at the instants of reassignment."""

    def __init__(self, task: Task, plan: TaskPlan) -> None:
        self.task = task
        self.plan = plan
        self.static = static_facts(task)

    def block(self, instance: BlockInstance) -> Block:
        return self.task.domain.block_by_name[instance.block]

    def violations(self) -> Iterator[Violation]:
        for time in self.plan.instants:
            final = at(time, self.plan.makespan)
            self.reach(time)
            ending = [i for i in self.plan.instances if at(i.end, time)]
            for instance in ending:
                yield from self.leave(time, instance, final and self.block(instance).hold)
            for instance in self.plan.instances:
                if at(instance.start, time) and time > TIME_TOLERANCE:
                    yield from self.enter(time, instance)
            if not final:
                self.forget(ending)
        for atom in self.task.goal:
            if not self.reached(atom):
                yield Violation(7, self.plan.makespan, str(atom), "the goal does not hold at the end")

    def enter(self, time: float, instance: BlockInstance) -> Iterator[Violation]:
        roles = self.task.bind(instance.roles)
        for literal in self.block(instance).entry:
            atom = literal.ground(roles)
            if literal.predicate.static:
                fine = (Atom(atom.predicate, atom.arguments) in self.static) == literal.positive
            else:
                fine = self.holds(time, literal, instance)
            if not fine:
                yield Violation(5, time, instance.name, f"entry condition {atom} does not hold")

    def leave(self, time: float, instance: BlockInstance, final: bool) -> Iterator[Violation]:
        raise NotImplementedError

    def reach(self, time: float) -> None:
        """Take note of what blocks that hold have brought about by now."""

    def forget(self, ended: list[BlockInstance]) -> None:
        """Void what the ended instances maintained."""

    def holds(self, time: float, literal: Literal, instance: BlockInstance) -> bool:
        raise NotImplementedError

    def reached(self, atom: Atom) -> bool:
        raise NotImplementedError


class _Symbols(_Judge):
    """Judges by the declared effects: deletes before adds, at the end of each instance."""

    def __init__(self, task: Task, plan: TaskPlan) -> None:
        super().__init__(task, plan)
        self.facts = set(facts(task))
        self.owned: dict[str, set[Atom]] = {}
        self.applied: set[str] = set()

    def reach(self, time: float) -> None:
        holding = [i for i in self.plan.instances if i.reached is not None and i.reached <= time + TIME_TOLERANCE]
        for instance in sorted(holding, key=lambda i: (i.reached, i.name)):
            self.apply(instance)

    def leave(self, time: float, instance: BlockInstance, final: bool) -> Iterator[Violation]:
        self.apply(instance)
        return iter(())

    def apply(self, instance: BlockInstance) -> None:
        """Apply the effects of an instance, once: deletes before adds."""
        if instance.name in self.applied:
            return
        self.applied.add(instance.name)
        block = self.block(instance)
        roles = self.task.bind(instance.roles)
        for literal in sorted(block.exit, key=lambda literal: literal.positive):
            atom = literal.ground(roles)
            index = literal.predicate.functional_index
            pattern = atom if index is None or not literal.positive else _wild(atom, index)
            if not literal.positive or index is not None:
                self.facts = {fact for fact in self.facts if not pattern.matches(fact)}
            if literal.positive:
                self.facts.add(atom)
                if literal.predicate.maintained:
                    self.owned.setdefault(instance.name, set()).add(atom)

    def forget(self, ended: list[BlockInstance]) -> None:
        for instance in ended:
            self.facts -= self.owned.pop(instance.name, set())

    def holds(self, time: float, literal: Literal, instance: BlockInstance) -> bool:
        return literal.ground(self.task.bind(instance.roles)) in self.facts

    def reached(self, atom: Atom) -> bool:
        positive = Atom(atom.predicate, atom.arguments)
        static = self.task.domain.predicate_by_name[atom.predicate].static
        return (positive in (self.static if static else self.facts)) == atom.positive


class _Margins(_Judge):
    """Judges by the margins measured at the instants."""

    def __init__(self, task: Task, plan: TaskPlan, measured: Measured) -> None:
        super().__init__(task, plan)
        self.measured = measured

    def leave(self, time: float, instance: BlockInstance, final: bool) -> Iterator[Violation]:
        for literal in self.block(instance).exit:
            if "*" not in literal.arguments and not self.holds(time, literal, instance) and not final:
                atom = literal.ground(self.task.bind(instance.roles))
                yield Violation(5, time, instance.name, f"exit condition {atom} does not hold")

    def holds(self, time: float, literal: Literal, instance: BlockInstance) -> bool:
        return float(literal.margin(self.measured(time), self.task.bind(instance.roles))) >= 0

    def reached(self, atom: Atom) -> bool:
        return self.task.margin(atom, self.measured(self.plan.makespan)) >= 0


def _wild(atom: Atom, index: int) -> Atom:
    return Atom(atom.predicate, (*atom.arguments[:index], "*", *atom.arguments[index + 1 :]))
