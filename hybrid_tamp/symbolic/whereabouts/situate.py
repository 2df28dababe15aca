"""Conversion of a task to a task whose feasibility facts depend on the whereabouts of tokens.

Each block gets a target for the node of every token whose whereabouts the block requires or changes. Conditions on
poses become conditions on nodes. A movement changes the functional predicate `whereabouts`. Plans of the situated task
become plans of the original task when these targets are left out.
"""

from collections import Counter
from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace
from functools import cached_property
from math import prod

from hybrid_tamp.model.affordance import TOKEN
from hybrid_tamp.model.block import Block, Target
from hybrid_tamp.model.kind import Kind
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.predicate import Literal, Parameter, Predicate
from hybrid_tamp.model.relation import Membership
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.symbolic.pddl.naming import unused
from hybrid_tamp.symbolic.whereabouts.nodes import Nodes, Row, Whereabouts, find_nodes
from hybrid_tamp.symbolic.whereabouts.predicted import BrokenCondition
from hybrid_tamp.symbolic.whereabouts.situated_facts import SituatedFacts
from hybrid_tamp.symbolic.whereabouts.tracking import Tracking

MOST_ROWS = 200
"""Largest number of rows of a condition that a `fill` checks. With more rows, a problem would have too many fills."""

_Key = tuple[str, bool, int]
"""Triple of (predicate, whether positive, number of nodes) that identifies the conditions with the same relation."""
Excluded = tuple[_Key, Row]
"""A condition that counts as false for a row of names."""


class Situation:
    """A task with the whereabouts of its tokens.

    Attributes:
        task: the original task.
        tracking: conditions and slots that depend on whereabouts.
    """

    def __init__(self, task: Task) -> None:
        self.task = task
        self.tracking = Tracking(task.domain)

    @cached_property
    def nodes(self) -> Nodes:
        """The nodes of all tokens that some block moves."""
        return find_nodes(self.task, self.tracking)

    def situated_task(self, optimistic: bool, excluded: Collection[Excluded] = ()) -> Task:
        """Return the task in which conditions depend on nodes.

        Args:
            optimistic: whether a condition counts as true wherever it may be true (see `SituatedFacts`).
            excluded: conditions that count as false.
        """
        facts = SituatedFacts(self.task, self.tracking, self.nodes, optimistic)
        return _Conversion(self, facts, excluded).convert()

    def original_plan(self, plan: TaskPlan) -> TaskPlan:
        """Return the plan of the original task for a plan of the situated task."""
        blocks = self.task.domain.block_by_name

        def restore(instance: BlockInstance) -> BlockInstance:
            kept = {target.name for target in blocks[instance.block].targets}
            return replace(instance, targets={role: v for role, v in instance.targets.items() if role in kept})

        return replace(plan, instances=tuple(map(restore, plan.instances)))

    def situated_plan(self, situated: Task, plan: TaskPlan) -> TaskPlan:
        """Return the plan of a situated task for a plan of the original task."""
        at = {token: nodes[0].name for token, nodes in self.nodes.by_token.items()}
        instances = []
        for instance in sorted(plan.instances, key=lambda each: (each.start, each.end, each.name)):
            block = self.task.domain.block_by_name[instance.block]
            moving = self.tracking.moving_slots.get(block.name, ())
            after = {slot: self._follow(block, slot, instance, at) for slot in moving}
            targets = {name: at[instance.roles[role]] for role, name in before_names(self.tracking, block).items()}
            targets |= {name: after[slot] for slot, name in after_names(self.tracking, block).items()}
            at |= {instance.slots[slot]: node for slot, node in after.items()}
            kept = {target.name for target in situated.domain.block_by_name[block.name].targets}
            known = {**instance.targets, **{name: node for name, node in targets.items() if name in kept}}
            instances.append(replace(instance, targets=known))
        return replace(plan, instances=tuple(instances))

    def _follow(self, block: Block, slot: str, instance: BlockInstance, at: Mapping[str, str]) -> str:
        """Return the node to which an instance moves the token in a slot."""
        token = instance.slots[slot]
        targets = block.ends.get(slot, ()) if block.outcome is not None else ()
        row = (token, at[token], *(instance.targets[name] for name in targets))
        return next(each[-1] for each in self.nodes.rows[block.name, slot] if each[:-1] == row)

    def excluded(self, broken: Iterable[tuple[BrokenCondition, BlockInstance]]) -> set[Excluded]:
        """Return the conditions that failed, each given with its instance in a plan of a situated task.

        If a condition did not mention the nodes, no row is excluded. But because the condition is in the result, it
        mentions the nodes from now on.
        """
        found = set()
        for each, instance in broken:
            block = self.task.domain.block_by_name[instance.block]
            roles, names = dict(self.tracking.conditions(block))[each.literal], before_names(self.tracking, block)
            nodes = tuple(instance.targets[names[role]] for role in roles if names[role] in instance.targets)
            row = (*each.atom.arguments, *nodes) if len(nodes) == len(roles) else ()
            found.add((_key(each.literal, roles), row))
        return found


class _Conversion:
    """Conversion of one task with one set of facts."""

    def __init__(self, situation: Situation, facts: SituatedFacts, excluded: Collection[Excluded]) -> None:
        self.task = situation.task
        self.excluded = excluded
        self.nodes = situation.nodes
        self.facts = facts
        self.tracking = facts.tracking
        self._taken = {predicate.name for predicate in self.task.domain.predicates}
        self.whereabouts = Predicate(
            self._name("whereabouts"),
            (Parameter("token", TOKEN), Parameter("node", Whereabouts)),
            Membership(frozenset((token, nodes[0].name) for token, nodes in self.nodes.by_token.items())),
            kind=Kind.FUNCTIONAL,
            value_of="node",
            by_name=True,
        )
        self._conditions: dict[_Key, tuple[Predicate, set[Row]]] = {}
        self._movements: list[Predicate] = []

    def convert(self) -> Task:
        """Return the situated task."""
        blocks = tuple(map(self._convert_block, self.task.domain.blocks))
        filled = {
            empty.name: _relation(
                empty.name, empty.parameters, rows - {row for which, row in self.excluded if which == key}
            )
            for key, (empty, rows) in self._conditions.items()
        }
        blocks = tuple(
            replace(b, entry=tuple(replace(c, predicate=filled.get(c.predicate.name, c.predicate)) for c in b.entry))
            for b in blocks
        )
        domain = self.task.domain
        predicates = (*domain.predicates, self.whereabouts, *filled.values(), *self._movements)
        changed = replace(domain, classes=(*domain.classes, Whereabouts), predicates=predicates, blocks=blocks)
        nodes = [Token.make(node.name, [Whereabouts], {}) for each in self.nodes.by_token.values() for node in each]
        tokens, known = (*self.task.tokens, *nodes), self.task.state
        state = State.of(tokens, {(t.name, v.name): known[t, v.name] for t in self.task.tokens for v in t.varying})
        return self.task.replaced(domain=changed, tokens=tokens, state=state)

    def _convert_block(self, block: Block) -> Block:
        tracked = dict(self.tracking.conditions(block))
        before, after = before_names(self.tracking, block), after_names(self.tracking, block)
        moving = tuple(after)
        found = ((self._condition(block, c, tracked[c], before) if c in tracked else c) for c in block.entry)
        entry = [condition for condition in found if condition is not None]
        asked = {argument for condition in entry for argument in condition.arguments}
        roles = [role for role, name in before.items() if name in asked or role in moving]
        entry += [self.whereabouts(role, before[role]) for role in roles]
        entry += [self._movement(block, slot, before[slot], after[slot]) for slot in moving]
        exits = (self.whereabouts(slot, after[slot]) for slot in moving)
        targets = (Target(name, Whereabouts, reads=()) for name in (*(before[r] for r in roles), *after.values()))
        return replace(
            block,
            targets=(*block.targets, *targets),
            entry=tuple(entry),
            preferences=(),
            exit=(*block.exit, *exits),
        )

    def _condition(
        self, block: Block, literal: Literal, roles: tuple[str, ...], before: dict[str, str]
    ) -> Literal | None:
        """Return the condition on nodes, or None if the condition is left to the check of the predicted states.

        If a condition holds for all nodes of a token or for none, the condition does not mention the nodes.
        """
        key = _key(literal, roles)
        rows = set(self.facts.rows(block, literal, roles))
        if not any(which == key for which, _ in self.excluded):
            others = {slot.name for slot in block.others} & set(literal.arguments)
            if self._is_independent(rows, literal, roles):
                rows, roles = {row[: len(literal.arguments)] for row in rows}, ()
            elif others and len(rows) > MOST_ROWS:
                return None
        key = _key(literal, roles)
        if key not in self._conditions:
            where = "at" if roles else "anywhere"
            name = self._name(f"{'' if literal.positive else 'not '}{literal.predicate.name} {where}")
            nodes = (Parameter(f"node {number}", Whereabouts) for number, _ in enumerate(roles, start=1))
            self._conditions[key] = (_relation(name, (*literal.predicate.parameters, *nodes), ()), set())
        situated, known = self._conditions[key]
        known |= rows
        return Literal(situated, (*literal.arguments, *(before[role] for role in roles)))

    def _is_independent(self, rows: Collection[Row], literal: Literal, roles: tuple[str, ...]) -> bool:
        """Return whether each combination of arguments in the rows occurs with all nodes of its tokens."""
        size = len(literal.arguments)
        places = [literal.arguments.index(role) for role in roles]
        counts = Counter(row[:size] for row in rows)
        return all(count == prod(len(self.nodes.by_token[row[i]]) for i in places) for row, count in counts.items())

    def _movement(self, block: Block, slot: str, before: str, after: str) -> Literal:
        targets = block.ends.get(slot, ()) if block.outcome is not None else ()
        sorts = (Parameter(name, block.roles[name]) for name in targets)
        token = Parameter("token", block.slot(slot).object_class)
        parameters = (token, Parameter("before", Whereabouts), *sorts, Parameter("after", Whereabouts))
        name = self._name(f"{block.name} moves {slot}")
        self._movements.append(_relation(name, parameters, self.nodes.rows[block.name, slot]))
        return Literal(self._movements[-1], (slot, before, *targets, after))

    def _name(self, wanted: str) -> str:
        return _fresh(wanted, self._taken)


def before_names(tracking: Tracking, block: Block) -> dict[str, str]:
    """Return a dictionary that maps each tracked role of a block to the name of the target for its node."""
    taken = set(block.roles)
    return {role: _fresh(f"{role} before", taken) for role in tracking.roles(block)}


def after_names(tracking: Tracking, block: Block) -> dict[str, str]:
    """Return a dictionary that maps each slot whose token the block moves to the name of the target for its end."""
    taken = {*block.roles, *before_names(tracking, block).values()}
    return {slot: _fresh(f"{slot} after", taken) for slot in tracking.moving_slots.get(block.name, ())}


def _relation(name: str, parameters: tuple[Parameter, ...], rows: Iterable[Row]) -> Predicate:
    ordered = tuple(sorted(set(rows)))
    return Predicate(name, parameters, Membership(frozenset(ordered)), kind=Kind.STATIC, rows=ordered, by_name=True)


def _key(literal: Literal, roles: tuple[str, ...]) -> _Key:
    return literal.predicate.name, literal.positive, len(roles)


def _fresh(wanted: str, taken: set[str]) -> str:
    name = unused(wanted, taken)
    taken.add(name)
    return name
