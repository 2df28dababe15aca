"""Backward search for blocks that could achieve a goal atom, with the reasons why other blocks cannot.

The search ignores the atoms that blocks delete (the delete relaxation of planning). A token is assumed to reach a slot
if the network has a path to this slot. So if the search cannot achieve an atom, no plan can.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field

from hybrid_tamp.feasibility.bindings import MOST, Bound, TooMany, complete, find_feasible, order_conditions
from hybrid_tamp.feasibility.load_shares import explain_unmet, find_best_choice
from hybrid_tamp.feasibility.mode_names import BLOCK
from hybrid_tamp.feasibility.reachable_slots import Passages
from hybrid_tamp.feasibility.safety_figures import describe_shortfall
from hybrid_tamp.model.bindings import Choices
from hybrid_tamp.model.block import Block, Slot
from hybrid_tamp.model.explanation import Reason, ReasonKind
from hybrid_tamp.model.facts import StaticFacts, facts
from hybrid_tamp.model.predicate import Atom, Literal
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token


@dataclass
class Ways:
    """The ways to achieve an atom.

    Attributes:
        waits: maps each way to the name of its block. A way is a tuple of atoms that must hold before the block starts.
        reasons: reasons why blocks that have the atom as an effect cannot run.
    """

    waits: dict[tuple[Atom, ...], str] = field(default_factory=dict)
    reasons: list[Reason] = field(default_factory=list)


class BackwardSearch:
    """The search for ways to achieve a task's goal atoms.

    Attributes:
        ways: maps each explored atom that does not hold initially to the ways to achieve it.
    """

    def __init__(self, task: Task) -> None:
        self.task = task
        self.ways: dict[Atom, Ways] = {}
        self._facts = facts(task)
        self._static = StaticFacts(task)
        self._passages = Passages(task)
        self._count = 0

    def holds(self, atom: Atom) -> bool:
        """Say whether an atom holds initially."""
        static = self.task.domain.predicate_by_name[atom.predicate].static
        return atom in (self._static if static else self._facts)

    def explain_directly(self, goal: Atom) -> list[Reason]:
        """Return the reasons why no block can achieve an atom, or an empty list if some block can."""
        try:
            self.ways[goal] = self._find_ways(goal)
        except TooMany:
            return []
        return [] if self.ways[goal].waits else self.ways[goal].reasons

    def explore(self, goal: Atom) -> bool:
        """Find the ways to achieve an atom and, recursively, each atom in these ways. Say whether the atom is possible.

        Raises:
            TooMany: the number of ways exceeds `MOST`.
        """
        open_atoms, seen = [goal], set[Atom]()
        while open_atoms:
            atom = open_atoms.pop()
            if atom not in seen and not self.holds(atom):
                seen.add(atom)
                self.ways[atom] = self.ways.get(atom) or self._find_ways(atom)
                open_atoms.extend({wait: None for waits in self.ways[atom].waits for wait in waits})
        return self.holds(goal) or goal in self.find_reached()

    def find_reached(self) -> set[Atom]:
        """Return the explored atoms that can be achieved."""
        found: set[Atom] = set()
        before = -1
        while len(found) > before:
            before = len(found)
            found |= {atom for atom, ways in self.ways.items() if any(found.issuperset(waits) for waits in ways.waits)}
        return found

    def _find_ways(self, atom: Atom) -> Ways:
        ways, never = Ways(), list[Reason]()
        for block, fixed in self._achievers(atom):
            member = _no_member(self.task, block, fixed)
            allowed = self.task.choices(block, fixed)
            conditions = order_conditions(block)
            if member:
                ways.reasons.append(member)
            elif not find_feasible(self._static, filter(_over_symbols, conditions), allowed):
                outcome = ", ".join(value for value in fixed.values() if isinstance(value, str))
                message = f"no binding of {BLOCK} achieves {outcome or atom.predicate}"
                never.append(Reason((), block.name, "no_block", message))
            elif missing := self._missing(block, conditions, allowed):
                ways.reasons.extend(missing)
            elif bounds := find_feasible(self._static, conditions, allowed):
                ways.waits |= dict.fromkeys(self._waits(block, bounds, allowed), block.name)
                ways.reasons.extend(self._passages.explain_missing(block, allowed))
            else:
                ways.reasons.extend(self._infeasible(block, conditions, allowed))
        if not ways.waits and not ways.reasons:
            message = f"no block of {self.task.domain.name} has {atom.predicate} as an effect"
            ways.reasons = never or [Reason((), "", "no_block", message)]
        return ways

    def explain_infeasible(self, atom: Atom, reached: set[Atom]) -> list[Reason]:
        """Return a reason for each feasibility condition that prevents blocks from achieving an atom.

        A block is examined only if the atoms that it needs, and that blocks can change, hold initially or are in
        `reached`.
        """
        found: list[Reason] = []
        for block, fixed in self._achievers(atom):
            allowed = self._narrowed(block, self.task.choices(block, fixed), reached)
            conditions = order_conditions(block)
            rows = find_feasible(self._static, filter(_over_symbols, conditions), allowed)
            if rows and all(allowed.values()):
                bound = {role: tuple(dict.fromkeys(row[role] for row in rows)) for role in rows[0]}
                others = [each for each in conditions if not _over_symbols(each)]
                found += explain_unmet(self.task, self._static, block, others, {**allowed, **bound})
        return found

    def _narrowed(self, block: Block, allowed: Choices, reached: set[Atom]) -> Choices:
        """Return the values of each role for which the changing conditions hold initially or are in `reached`."""
        kept = dict(allowed)
        for literal in block.changing_entry:
            if not literal.positive:
                continue
            atoms = [atom for atom in {*self._facts, *reached} if atom.predicate == literal.predicate.name]
            rows = [tuple(map(self.task.value, atom.arguments)) for atom in atoms]
            places = [(place, role) for place, role in enumerate(literal.arguments) if role in kept]
            rows = [row for row in rows if all(row[place] in kept[role] for place, role in places)]
            for place, role in places:
                found = {row[place] for row in rows}
                kept[role] = tuple(value for value in kept[role] if value in found)
        return kept

    def _achievers(self, atom: Atom) -> Iterator[tuple[Block, Bound]]:
        """Yield pairs of (block, binding) in which the atom is an effect of the block but not a precondition."""
        for block in self.task.domain.blocks:
            for literal in block.exit:
                if literal.positive and literal.predicate.name == atom.predicate and literal not in block.entry:
                    names = zip(literal.arguments, atom.arguments, strict=True)
                    yield block, {argument: self.task.value(name) for argument, name in names}

    def _waits(self, block: Block, bounds: list[Bound], allowed: Choices) -> Iterator[tuple[Atom, ...]]:
        literals = [literal for literal in block.changing_entry if literal.positive]
        for bound in complete(bounds, allowed):
            self._count += 1
            if self._count > MOST:
                raise TooMany
            if self._passages.allow(block, bound):
                atoms = (literal.ground(bound) for literal in literals)
                yield tuple(atom for atom in atoms if not self.holds(atom))

    def _missing(self, block: Block, conditions: tuple[Literal, ...], allowed: Choices) -> list[Reason]:
        """Return a reason for every class with fewer tokens in the task than slots in the block.

        More tokens like the present tokens do not help if the present tokens violate a condition of all these slots.
        """
        found: list[Reason] = []
        for slot, wanted, have in _short_slots(self.task, block):
            unable = explain_unmet(self.task, self._static, block, conditions, allowed, alike=True)
            message = (
                f"no token can fill slot {slot.name} of {BLOCK}: {BLOCK} needs {wanted} tokens of class "
                f"{slot.object_class.name}, but the task has {have}; {wanted - have} more token"
                f"{'s' * (wanted > have + 1)}{('', ' like the present one', ' like the present ones')[min(have, 2)]} "
                f"would {'not ' if unable else ''}be enough"
            )
            kind: ReasonKind = "too_few_tokens" if have else "no_token"
            found += [Reason((), block.name, kind, message, lacks=slot.object_class), *unable]
        return found

    def _infeasible(self, block: Block, conditions: tuple[Literal, ...], allowed: Choices) -> list[Reason]:
        found = explain_unmet(self.task, self._static, block, conditions, allowed)
        if found:
            return found
        literal, bound, margin = find_best_choice(self._static, conditions, allowed)
        atom, unit = literal.ground(bound), literal.predicate.unit
        values = tuple(bound.get(argument, argument) for argument in literal.arguments)
        shortfall = describe_shortfall(self.task, literal.predicate, values, margin)
        message = (
            f"{BLOCK} is impossible, because no binding satisfies all conditions at once; with the best binding, "
            f"{literal.predicate.sentence(atom.arguments, not literal.positive)} ({shortfall})"
        )
        return [Reason((), block.name, "not_feasible", message, atom, margin, unit)]


def _no_member(task: Task, block: Block, fixed: Bound) -> Reason | None:
    for role, value in fixed.items():
        sort = block.roles.get(role)
        if isinstance(value, Token) and isinstance(sort, type) and value not in task.values_of(sort):
            message = f"{value.name} cannot fill role {role} of {BLOCK}: {value.name} is not a member of {sort.name}"
            return Reason((), block.name, "no_token", message, lacks=sort)
    return None


def _short_slots(task: Task, block: Block) -> Iterator[tuple[Slot, int, int]]:
    """Yield (last slot of the class, tokens needed, tokens in the task) for each class with too few tokens."""
    for slot in {each.object_class: each for each in block.slots}.values():
        wanted = sum(each.object_class is slot.object_class for each in block.slots)
        have = len(task.values_of(slot.object_class))
        if have < wanted:
            yield slot, wanted, have


def _over_symbols(literal: Literal) -> bool:
    return literal.predicate.rows is not None
