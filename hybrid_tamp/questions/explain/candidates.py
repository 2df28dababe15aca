"""Candidates for single changes that might make a task solvable."""

from collections.abc import Iterable, Iterator, Mapping, Set
from itertools import product

from hybrid_tamp.feasibility.bindings import order_conditions
from hybrid_tamp.feasibility.reachable_slots import Passages
from hybrid_tamp.feasibility.safety_figures import with_unit
from hybrid_tamp.model.affordance import ObjectClass, is_place
from hybrid_tamp.model.bindings import enumerate_bindings, order_roles
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.change import (
    AddEdge,
    Change,
    CopyToken,
    GrantFact,
    IdealToken,
    JoinClass,
    SetFactor,
    SetProperty,
)
from hybrid_tamp.model.explanation import Reason
from hybrid_tamp.model.facts import StaticFacts
from hybrid_tamp.model.network import SlotName
from hybrid_tamp.model.plan import split_mode
from hybrid_tamp.model.predicate import Atom, Literal, Value
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.questions.changes import propose_copies, task_root
from hybrid_tamp.questions.explain.property_changes import find_factor_changes, find_property_changes


def propose_changes(task: Task, reasons: Iterable[Reason]) -> Iterator[Change]:
    """Yield each change of a task once. Changes that remove the cause of a reason come first."""
    seen: set[Change] = set()
    for change in _Space(task).ordered(reasons):
        # Several failing facts may lead to the same property change.
        if change not in seen:
            seen.add(change)
            yield change


def find_answers(task: Task, reason: Reason) -> Iterator[Change]:
    """Yield the changes that each remove the cause of a reason."""
    return _Space(task).pointed(reason)


def points_to(reason: Reason, change: Change) -> bool:
    """Return whether a change removes the cause of a reason."""
    match change:
        case CopyToken(like):
            return reason.lacks in like.classes
        case IdealToken(object_class) | JoinClass(_, object_class):
            return reason.lacks is object_class
        case AddEdge(_, target):
            return reason.lacks == target
        case GrantFact(atom) | SetProperty(atom=atom) | SetFactor(atom=atom):
            return reason.atom == atom


class _Space:
    """The set of all changes of one task. Each change alone might make the task solvable."""

    def __init__(self, task: Task) -> None:
        self.task = task
        self._facts = StaticFacts(task)
        self._passages = Passages(task)
        self._slots = {(b.name, s.name): s.object_class for b in task.domain.blocks for s in b.slots}

    def ordered(self, reasons: Iterable[Reason]) -> Iterator[Change]:
        """Yield all changes, most promising changes first. Some changes occur more than once."""
        for reason in reasons:
            yield from self.pointed(reason)
        yield from self.tokens()
        yield from self.classes()
        failing = self.failing()
        yield from map(self.fact, failing)
        yield from self.edges()
        for atom in failing:
            yield from find_factor_changes(self.task, atom)
            yield from find_property_changes(self.task, atom)

    def pointed(self, reason: Reason) -> Iterator[Change]:
        """Yield the changes that each remove the cause of a reason."""
        if isinstance(reason.lacks, tuple):
            yield from self.edges(reason.lacks)
        elif reason.lacks is not None and reason.lacks in self.task.domain.classes:
            yield from self.tokens(reason.lacks)
            yield from self.classes(reason.lacks)
        elif reason.atom is not None and self.task.domain.predicate_by_name[reason.atom.predicate].static:
            yield from find_factor_changes(self.task, reason.atom)
            yield from find_property_changes(self.task, reason.atom)
            yield self.fact(reason.atom)

    def tokens(self, wanted: type[ObjectClass] | None = None) -> Iterator[Change]:
        """Yield changes that copy a token, and changes that add a first member to a class without members."""
        for token in self.task.assigned:
            if wanted is None or token.is_member(wanted):
                yield from propose_copies(self.task, token)
        for each in self.task.domain.classes if wanted is None else (wanted,):
            # If a base class has members, a copy of a member is proposed already.
            bases = (base for base in self.task.domain.classes if issubclass(each, base))
            if not is_place(each) and not any(self.task.values_of(base) for base in bases):
                yield IdealToken(each)

    def classes(self, wanted: type[ObjectClass] | None = None) -> Iterator[Change]:
        """Yield changes that make a token a member of one more class."""
        relations = self.task.domain.relations
        for each, token in product(self.task.domain.classes if wanted is None else (wanted,), self.task.assigned):
            own = set(token.classes) - {task_root(self.task)}
            if is_place(each) or each in own or self._is_idle(each, token):
                continue
            if all(relations.can_share_token(each, one) for one in own):
                yield JoinClass(token, each)

    def _is_idle(self, object_class: type[ObjectClass], token: Token) -> bool:
        """Return whether a class opens no slot to a token, because the token already is a member of a base class."""
        bases = (each for each in self.task.domain.classes if issubclass(object_class, each))
        return object_class not in self._slots.values() and any(map(token.is_member, bases))

    def edges(self, towards: SlotName | None = None) -> Iterator[Change]:
        """Return changes that add an edge from a reachable slot. Edges to unreachable slots come first."""
        sources = {slot for token in self.task.assigned for slot in self._passages.slots(token)}
        network, relations = self.task.domain.network, self.task.domain.relations
        pairs = [
            (one, other)
            for one, other in product(sorted(sources), [towards] if towards else sorted(self._slots))
            if not network.allows(one, other) and relations.can_share_token(self._slots[one], self._slots[other])
        ]
        out_of = {(one, split_mode(other[0])[0]) for one, other in network.edges}
        into = {(split_mode(one[0])[0], other) for one, other in network.edges}

        def likely(one: SlotName, other: SlotName) -> bool:
            """Say whether the network has an edge that differs only in the slot or the mode of one end."""
            return (one, split_mode(other[0])[0]) in out_of or (split_mode(one[0])[0], other) in into

        # Edges within one block come last, because they only let an action follow itself.
        pairs.sort(key=lambda pair: (pair[1] in sources, not likely(*pair), pair[0][0] == pair[1][0]))
        return (AddEdge(source, target) for source, target in pairs)

    def fact(self, atom: Atom) -> Change:
        """Return the change that makes a feasibility fact hold."""
        predicate = self.task.domain.predicate_by_name[atom.predicate]
        return GrantFact(atom, with_unit(-self.task.margin(atom), predicate.unit))

    def failing(self) -> list[Atom]:
        """Return each fact that is the only failing fact of at least one binding. Smallest violations come first."""
        found: dict[Atom, float] = {}
        for block in self.task.domain.blocks:
            for failure in self._single_failures(block):
                found |= failure
        return sorted(found, key=lambda atom: (-found[atom], atom))

    def _single_failures(self, block: Block) -> Iterator[dict[Atom, float]]:
        """Yield the result of `_failure` for each binding of a block in which at most one fact fails."""
        conditions = order_conditions(block)
        roles = {argument for literal in conditions for argument in literal.arguments if argument in block.roles}
        choices = {role: values for role, values in self.task.choices(block).items() if role in roles}

        def few_fail(_: Literal, bound: Mapping[str, Value]) -> bool:
            return self._failure(conditions, roles, bound) is not None

        for bound in enumerate_bindings(order_roles(choices, conditions), conditions, few_fail):
            yield self._failure(conditions, roles, bound) or {}

    def _failure(
        self, conditions: Iterable[Literal], roles: Set[str], bound: Mapping[str, Value]
    ) -> dict[Atom, float] | None:
        """Return a dict from the only failing fact to its margin, as a multiple of the predicate's scale.

        If no fact fails, the dict is empty. Return None if several facts fail, or if a fact about symbols fails.
        """
        found: dict[Atom, float] = {}
        for literal in conditions:
            # Conditions whose roles are not all bound are skipped.
            decided = all(argument in bound for argument in literal.arguments if argument in roles)
            margin = self._facts.margin(literal, bound) if decided else 0.0
            if margin < 0:
                found[literal.ground(bound)] = margin / literal.predicate.scale
                # No change can grant a fact about symbols.
                if literal.predicate.rows is not None or len(found) > 1:
                    return None
        return found
