"""Checks of law 5 and of the goal. Plans are checked by declared effects, and recordings by measured margins."""

from bisect import bisect_left, bisect_right
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.facts import StaticFacts, fact_margin, facts
from hybrid_tamp.model.plan import TIME_TOLERANCE, BlockInstance, TaskPlan, at
from hybrid_tamp.model.predicate import ANY, Atom, Literal, Predicate
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task

Measured = Callable[[float], State]
"""Function that takes an instant [s] and returns the state measured at this instant."""


@dataclass(frozen=True)
class Violation:
    """A violation of a law, at an instant [s]. `where` names an instance, a token or a goal atom."""

    law: int
    time: float
    where: str
    message: str

    def __str__(self) -> str:
        return self.text

    @property
    def text(self) -> str:
        """Violation as one line of text."""
        return f"law {self.law} at {self.time:.3f} s, {self.where}: {self.message}"


def condition_faults(task: Task, plan: TaskPlan, measured: Measured | None) -> list[Violation]:
    """Return the violations of law 5 and of the goal. If `measured` is None, the check uses the declared effects."""
    checker = _Symbols(task, plan) if measured is None else _Margins(task, plan, measured)
    return list(checker.violations())


class _Instants:
    """Index of instances by the instant at which they start or end."""

    def __init__(self, instances: Sequence[BlockInstance], side: str) -> None:
        self._instances = instances
        self._order = sorted((getattr(instance, side), index) for index, instance in enumerate(instances))

    def at(self, time: float) -> list[BlockInstance]:
        """Return the instances that start or end at this instant, in the order of the plan."""
        first = bisect_left(self._order, (time - TIME_TOLERANCE, -1))
        last = bisect_right(self._order, (time + TIME_TOLERANCE, len(self._order)))
        return [self._instances[index] for index in sorted(index for _, index in self._order[first:last])]


class _Checker:
    """Base class of the checks of law 5 and of the goal in law 7."""

    def __init__(self, task: Task, plan: TaskPlan) -> None:
        self.task = task
        self.plan = plan
        self.static = StaticFacts(task)
        self.movers: dict[tuple[str, str], set[Block]] = {}

    def block(self, instance: BlockInstance) -> Block:
        return self.task.domain.block_by_name[instance.block]

    def violations(self) -> Iterator[Violation]:
        starting, ending = (_Instants(self.plan.instances, side) for side in ("start", "end"))
        for time in self.plan.instants:
            final = at(time, self.plan.makespan)
            self.reach(time)
            ended = ending.at(time)
            for instance in ended:
                self.note_movements(instance)
            for instance in ended:
                yield from self.leave(time, instance, final and self.block(instance).hold)
            for instance in starting.at(time) if time > TIME_TOLERANCE else ():
                yield from self.enter(time, instance)
            if not final:
                self.forget(ended)
        for atom in self.task.goal:
            if not self.reached(atom):
                yield Violation(7, self.plan.makespan, atom.text, "the goal atom does not hold at the end of the plan")

    def enter(self, time: float, instance: BlockInstance) -> Iterator[Violation]:
        roles = self.task.bind(instance.roles)
        for literal in self.block(instance).entry:
            atom = literal.ground(roles)
            if literal.predicate.static and not self.may_have_changed(literal, instance):
                fine = (Atom(atom.predicate, atom.arguments) in self.static) == literal.positive
            else:
                fine = self.holds(time, literal, instance)
            if not fine:
                yield Violation(5, time, instance.name, f"entry condition {atom.text} does not hold")

    def note_movements(self, instance: BlockInstance) -> None:
        """Note which properties of which tokens an ended instance has changed."""
        block = self.block(instance)
        for slot, names in block.writes.items():
            for name in names:
                self.movers.setdefault((instance.slots.get(slot, ""), name), set()).add(block)

    def may_have_changed(self, literal: Literal, instance: BlockInstance) -> bool:
        """Return whether earlier instances have changed a property that a feasibility condition reads."""
        predicate, roles = literal.predicate, instance.roles
        if predicate.at_start:
            return False
        read = {
            (roles.get(argument, ""), name)
            for parameter, argument in zip(predicate.parameters, literal.arguments, strict=True)
            for name in predicate.reads.get(parameter.name, ())
        }
        return any(predicate not in block.keeps for each in read for block in self.movers.get(each, ()))

    def leave(self, time: float, instance: BlockInstance, final: bool) -> Iterator[Violation]:
        raise NotImplementedError

    def reach(self, time: float) -> None:
        """Apply the effects of all instances whose exit conditions hold by this time [s]."""

    def forget(self, ended: list[BlockInstance]) -> None:
        """Delete the facts that the ended instances maintained."""

    def holds(self, time: float, literal: Literal, instance: BlockInstance) -> bool:
        raise NotImplementedError

    def reached(self, atom: Atom) -> bool:
        raise NotImplementedError


class _Symbols(_Checker):
    """Checks by declared effects. The effects of an instance are applied when its exit conditions hold."""

    def __init__(self, task: Task, plan: TaskPlan) -> None:
        super().__init__(task, plan)
        self.facts = set(facts(task, predicates=self._read()))
        self.owned: dict[str, set[Atom]] = {}
        self.applied: set[str] = set()
        holding = [(i.reached, i.name, i) for i in plan.instances if i.reached is not None]
        self.to_come = deque(sorted(holding, key=lambda each: each[:2]))

    def _read(self) -> list[Predicate]:
        """Return the predicates that occur in the goal or in entry conditions of the plan's blocks."""
        blocks = {instance.block for instance in self.plan.instances}
        entries = (literal for block in blocks for literal in self.task.domain.block_by_name[block].entry)
        names = {literal.predicate.name for literal in entries} | {atom.predicate for atom in self.task.goal}
        return [predicate for predicate in self.task.domain.predicates if predicate.name in names]

    def reach(self, time: float) -> None:
        while self.to_come and self.to_come[0][0] <= time + TIME_TOLERANCE:
            self.apply(self.to_come.popleft()[-1])

    def leave(self, time: float, instance: BlockInstance, final: bool) -> Iterator[Violation]:
        self.apply(instance)
        return iter(())

    def apply(self, instance: BlockInstance) -> None:
        """Apply the effects of an instance, deletes before adds. Later calls for the same instance do nothing."""
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
        # Declared effects do not contain poses. The planner checks feasibility facts of moved tokens in rollouts.
        return literal.predicate.static or literal.ground(self.task.bind(instance.roles)) in self.facts

    def reached(self, atom: Atom) -> bool:
        static = self.task.domain.predicate_by_name[atom.predicate].static
        known = self.static if static else self.facts
        return any(each in known for each in self.task.groundings(atom)) == atom.positive


class _Margins(_Checker):
    """Checks by margins that were measured at the instants of reassignment."""

    def __init__(self, task: Task, plan: TaskPlan, measured: Measured) -> None:
        super().__init__(task, plan)
        self.measured = measured

    def leave(self, time: float, instance: BlockInstance, final: bool) -> Iterator[Violation]:
        for literal in self.block(instance).exit:
            if ANY not in literal.arguments and not self.holds(time, literal, instance) and not final:
                atom = literal.ground(self.task.bind(instance.roles))
                yield Violation(5, time, instance.name, f"exit condition {atom.text} does not hold")

    def holds(self, time: float, literal: Literal, instance: BlockInstance) -> bool:
        binding, state = self.task.bind(instance.roles), self.measured(time)
        if literal.predicate.static:
            return float(fact_margin(literal, self.task.state, state, binding)) >= 0
        return float(literal.margin(state, binding)) >= 0

    def reached(self, atom: Atom) -> bool:
        return self.task.margin(atom, self.measured(self.plan.makespan)) >= 0


def _wild(atom: Atom, index: int) -> Atom:
    return Atom(atom.predicate, (*atom.arguments[:index], ANY, *atom.arguments[index + 1 :]))
