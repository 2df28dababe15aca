"""Elimination of needless instances from a plan, e.g. of a tool that is put down and taken up again.

Action elimination (Nakhost and Mueller, "Action Elimination and Plan Neighborhood Graph Search: Two Algorithms for Plan
Improvement", ICAPS 2010) removes one action of a plan, and then every later action that is no longer applicable. If the
remaining actions achieve the goal, the shorter plan is kept. Each action is tried once, first to last.

A single reassignment is encoded as several PDDL actions, and their names depend on the blocks that the tokens leave. So
this module removes instances instead of actions. A later instance stays if the network lets its tokens enter from their
current slots, and if its entry conditions hold. The remaining instances are encoded again. The law checker judges every
shorter plan.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import groupby

from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.facts import facts
from hybrid_tamp.model.plan import PlannedAction, TaskPlan
from hybrid_tamp.model.predicate import ANY, Atom
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.decode import OrderedInstance, decode
from hybrid_tamp.symbolic.encoding.problem import Compilation
from hybrid_tamp.symbolic.reencode import reencode
from hybrid_tamp.symbolic.strategies.search import Candidate, Search

WITHOUT_NEEDLESS = "needless actions dropped"

MOST_INSTANCES = 20_000
"""Limit on the work: the elimination ends when the tried plans contain this many instances in total."""


def drop_needless(search: Search, best: Candidate, most_instances: int = MOST_INSTANCES) -> Candidate:
    """Return a lawful plan without needless instances, or the given plan if every instance is needed.

    If the makespan is minimised, a shorter plan with a larger makespan is not accepted.

    Args:
        search: Search for a plan of the whole task.
        best: Lawful plan with its actions.
        most_instances: Limit on the work. The elimination ends when the tried plans contain this many instances in
            total.

    Raises:
        LimitReached: If the deadline passes.
    """
    way = f"{best.way}, {WITHOUT_NEEDLESS}"
    with search.stage("scheduling"):
        instances = decode(search.compilation, best.plan.actions)
    index, left = len(search.task.assigned), most_instances
    while index < len(instances) and left >= len(instances):
        left -= len(instances)
        with search.stage("scheduling"):
            fewer = remove_instance(search.task, instances, index, search.deadline)
            actions = None if fewer is None else encode_again(search.compilation, fewer)
        shorter = actions is not None and len(actions) < len(best.plan.actions)
        found = search.try_actions(way, actions) if actions is not None and shorter else None
        if fewer is None or found is None or (search.task.objective == "makespan" and _is_later(found, best)):
            index += 1
        else:
            instances, best = fewer, found
    return best


def _is_later(one: Candidate, other: Candidate) -> bool:
    return one.plan.makespan > other.plan.makespan + 1e-6


def remove_instance(
    task: Task, instances: Sequence[OrderedInstance], index: int, deadline: Deadline = NEVER
) -> list[OrderedInstance] | None:
    """Return the plan without an instance and without all later instances that are then impossible.

    Args:
        task: Task of the plan, with a ground goal.
        instances: Instances in the order of their beginnings. The initial instances come first.
        index: Index of the instance to remove.
        deadline: Deadline of the command.

    Returns:
        The remaining instances, or None if they do not achieve the goal.

    Raises:
        LimitReached: If the deadline passes.
    """
    deadline.check()
    replay = _Replay(task, instances[: len(task.assigned)])
    removed = instances[index]
    for _, together in groupby(instances[len(task.assigned) :], key=lambda instance: instance.begin):
        replay.reassign([instance for instance in together if instance is not removed])
    return replay.done if replay.reaches_goal else None


def encode_again(compilation: Compilation, instances: Sequence[OrderedInstance]) -> list[PlannedAction] | None:
    """Return actions that carry out the instances, or None if there are no such actions."""
    final = max(instance.begin for instance in instances) + 1
    timed = [each.timed(each.begin, final if each.end is None else each.end, {}, None) for each in instances]
    actions = reencode(compilation, TaskPlan(tuple(timed), float(final)))
    return actions if compilation.reaches_goal(actions) else None


@dataclass
class _Place:
    """The slot of a running instance in which a token is."""

    instance: OrderedInstance
    slot: str


@dataclass
class _Replay:
    """Repetition of a plan, which leaves out impossible instances.

    All tokens leave an instance together. If some of its tokens cannot go on yet, the other tokens wait for them, and
    the next instances of the other tokens begin later.
    """

    task: Task
    initial: Sequence[OrderedInstance]
    done: list[OrderedInstance] = field(default_factory=list)
    waiting: list[OrderedInstance] = field(default_factory=list)
    reassignment: int = 0

    def __post_init__(self) -> None:
        self.facts = set(facts(self.task))
        self.where: dict[str, _Place] = {}
        self.kept: dict[str, set[Atom]] = {}
        for instance in self.initial:
            self._begin(instance)

    @property
    def reaches_goal(self) -> bool:
        """Whether the goal holds after the instances. Feasibility facts never change."""
        static = {predicate.name for predicate in self.task.domain.static_predicates}
        return all(
            atom.predicate in static or any(each in self.facts for each in self.task.groundings(atom)) == atom.positive
            for atom in self.task.goal
        )

    def reassign(self, wanted: Sequence[OrderedInstance]) -> None:
        """Begin the wanted and the waiting instances that are possible. Some of the others wait."""
        claimed = {token for instance in wanted for token in instance.slots.values() if self._is_possible(instance)}
        older = [each for each in self.waiting if claimed.isdisjoint(each.slots.values())]
        possible = [instance for instance in (*older, *wanted) if self._is_possible(instance)]
        together = self._leave_together(possible)
        self.waiting = [instance for instance in possible if instance not in together]
        if not together:
            return
        self.reassignment += 1
        for source in [self.where[token].instance for each in together for token in each.slots.values()]:
            source.end = self.reassignment
            self.facts -= self.kept.pop(source.name, set())
        for instance in together:
            self._begin(instance)

    def _is_possible(self, instance: OrderedInstance) -> bool:
        block, network = self.task.domain.block_by_name[instance.block], self.task.domain.network
        sources = ((self.where[token], slot) for slot, token in instance.slots.items())
        if not all(network.allows((old.instance.block, old.slot), (block.name, slot)) for old, slot in sources):
            return False
        roles = self.task.bind({**instance.slots, **instance.targets})
        return all(literal.ground(roles) in self.facts for literal in block.changing_entry)

    def _leave_together(self, instances: list[OrderedInstance]) -> list[OrderedInstance]:
        """Return those instances that can begin now. The tokens of each preceding instance must leave together."""
        before = None
        while before != instances:
            before = instances
            moved = {token for instance in instances for token in instance.slots.values()}
            instances = [
                instance
                for instance in instances
                if all(moved.issuperset(self.where[token].instance.slots.values()) for token in instance.slots.values())
            ]
        return instances

    def _begin(self, instance: OrderedInstance) -> None:
        """Begin an instance and apply its effects, deletes before adds. The encoder does the same."""
        instance = replace(instance, begin=self.reassignment, end=None)
        self.done.append(instance)
        self.where.update({token: _Place(instance, slot) for slot, token in instance.slots.items()})
        if self.reassignment == 0:
            return
        block = self.task.domain.block_by_name[instance.block]
        roles = self.task.bind({**instance.slots, **instance.targets})
        for literal in sorted(block.exit, key=lambda literal: literal.positive):
            atom, index = literal.ground(roles), literal.predicate.functional_index
            pattern = atom if index is None else _with_any(atom, index)
            if not literal.positive or index is not None:
                self.facts = {fact for fact in self.facts if not pattern.matches(fact)}
            if literal.positive:
                self.facts.add(atom)
                if literal.predicate.maintained:
                    self.kept.setdefault(instance.name, set()).add(atom)


def _with_any(atom: Atom, index: int) -> Atom:
    return Atom(atom.predicate, (*atom.arguments[:index], ANY, *atom.arguments[index + 1 :]))
