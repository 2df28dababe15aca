"""From a goal atom backwards: which blocks could bring it about, what they wait for, and why others are of no use.

What a block deletes is left out of account (the delete relaxation of planning), and of the network it is only asked
whether edges lead a token to a slot at all: an atom that cannot be reached so cannot be reached at all.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field

from hybrid_tamp.feasibility.bindings import (
    MOST,
    Bound,
    Margins,
    TooMany,
    completed,
    feasible,
    static_entry,
)
from hybrid_tamp.feasibility.passages import Passages
from hybrid_tamp.feasibility.reasons import BLOCK, reason_of
from hybrid_tamp.feasibility.shares import amount, best_choice, failing
from hybrid_tamp.model.bindings import Choices
from hybrid_tamp.model.block import Block, Slot
from hybrid_tamp.model.explanation import Reason, ReasonKind
from hybrid_tamp.model.facts import StaticFacts, facts
from hybrid_tamp.model.predicate import Atom, Literal
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token


@dataclass
class Ways:
    """The ways to bring an atom about.

    Attributes:
        waits: for each way, the atoms that must have been brought about before, each once.
        reasons: why blocks that could bring it about are of no use.
    """

    waits: dict[tuple[Atom, ...], None] = field(default_factory=dict)
    reasons: list[Reason] = field(default_factory=list)


class Backwards:
    """The ways to a task's goal atoms.

    Attributes:
        ways: atom that does not hold at the beginning to the ways to it.
    """

    def __init__(self, task: Task) -> None:
        self.task = task
        self.ways: dict[Atom, Ways] = {}
        self._margins = Margins(task)
        self._facts = facts(task)
        self._static = StaticFacts(task)
        self._passages = Passages(task)
        self._count = 0

    def holds(self, atom: Atom) -> bool:
        """Say whether an atom holds at the beginning."""
        static = self.task.domain.predicate_by_name[atom.predicate].static
        return atom in self._static if static else atom in self._facts

    def direct(self, goal: Atom) -> list[Reason]:
        """Return why no block at all can bring an atom about; an empty list where one has something to wait for."""
        try:
            self.ways[goal] = self._ways(goal)
        except TooMany:
            return []
        return [] if self.ways[goal].waits else self.ways[goal].reasons

    def explore(self, goal: Atom) -> bool:
        """Find all ways to an atom and to all that they wait for, and say whether it can be reached.

        Raises:
            TooMany: there are more ways than are looked at.
        """
        open_atoms, seen = [goal], set[Atom]()
        while open_atoms:
            atom = open_atoms.pop()
            if atom not in seen and not self.holds(atom):
                seen.add(atom)
                self.ways[atom] = self.ways.get(atom) or self._ways(atom)
                open_atoms.extend({wait: None for waits in self.ways[atom].waits for wait in waits})
        return self.holds(goal) or goal in self.reached()

    def reached(self) -> set[Atom]:
        """Return the atoms that can be brought about, of those explored."""
        found: set[Atom] = set()
        before = -1
        while len(found) > before:
            before = len(found)
            found |= {atom for atom, ways in self.ways.items() if any(found.issuperset(waits) for waits in ways.waits)}
        return found

    def _ways(self, atom: Atom) -> Ways:
        ways, never = Ways(), list[Reason]()
        for block, fixed in self._achievers(atom):
            member = _no_member(self.task, block, fixed)
            allowed = self.task.choices(block, fixed)
            literals = static_entry(block)
            if member:
                ways.reasons.append(member)
            elif not feasible(self._margins, filter(_over_symbols, literals), allowed):
                outcome = ", ".join(value for value in fixed.values() if isinstance(value, str))
                never.append(reason_of(block, "no_block", f"{BLOCK} never brings about {outcome or atom.predicate}"))
            elif missing := self._missing(block, literals, allowed):
                ways.reasons.extend(missing)
            elif bounds := feasible(self._margins, literals, allowed):
                ways.waits.update(self._waits(block, bounds, allowed))
                ways.reasons.extend(self._passages.missing(block, allowed))
            else:
                ways.reasons.extend(self._infeasible(block, literals, allowed))
        if not ways.waits and not ways.reasons:
            message = f"no block of {self.task.domain.name} brings about {atom.predicate}, whatever its conditions are"
            ways.reasons = never or [Reason((), "", "no_block", message)]
        return ways

    def at_hand(self, atom: Atom, reached: set[Atom]) -> list[Reason]:
        """Return why an atom is not brought about from what is reached, for want of feasibility alone.

        Where a block would have to wait for something else first, nothing is said.
        """
        found: list[Reason] = []
        for block, fixed in self._achievers(atom):
            allowed = self._narrowed(block, self.task.choices(block, fixed), reached)
            literals = static_entry(block)
            symbols = list(filter(_over_symbols, literals))
            rows = feasible(self._margins, symbols, allowed)
            if rows and all(allowed.values()):
                bound = {role: tuple(dict.fromkeys(row[role] for row in rows)) for role in rows[0]}
                found += failing(
                    self._margins, block, [each for each in literals if each not in symbols], {**allowed, **bound}
                )
        return found

    def _narrowed(self, block: Block, allowed: Choices, reached: set[Atom]) -> Choices:
        """Keep of every role what its changing conditions leave, if only what is reached may hold."""
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
        """Yield the blocks with an exit condition that is the atom, unless they ask for it at their beginning."""
        for block in self.task.domain.blocks:
            for literal in block.exit:
                if literal.positive and literal.predicate.name == atom.predicate and literal not in block.entry:
                    names = zip(literal.arguments, atom.arguments, strict=True)
                    yield block, {argument: self.task.value(name) for argument, name in names}

    def _waits(self, block: Block, bounds: list[Bound], allowed: Choices) -> Iterator[tuple[tuple[Atom, ...], None]]:
        literals = [literal for literal in block.changing_entry if literal.positive]
        for bound in completed(bounds, allowed):
            self._count += 1
            if self._count > MOST:
                raise TooMany
            if not self._passages.allow(block, bound):
                continue
            atoms = (literal.ground(bound) for literal in literals)
            yield tuple(atom for atom in atoms if not self.holds(atom)), None

    def _missing(self, block: Block, literals: tuple[Literal, ...], allowed: Choices) -> list[Reason]:
        """Slots of one class need as many different tokens; what cannot be filled is named.

        That more tokens would do is said only if those that are there meet what is asked alike of all of them.
        """
        found: list[Reason] = []
        for slot, wanted, have in _short_slots(self.task, block):
            unable = failing(self._margins, block, literals, allowed, alike=True)
            message = (
                f"no token can fill slot {slot.name} of {BLOCK}: {BLOCK} needs {wanted} of class "
                f"{slot.object_class.name}, the task has {have}; {wanted - have} more "
                f"{'like these would not be enough' if unable else 'would be enough'}"
            )
            kind: ReasonKind = "too_few_tokens" if have else "no_token"
            found += [reason_of(block, kind, message, lacks=slot.object_class), *unable]
        return found

    def _infeasible(self, block: Block, literals: tuple[Literal, ...], allowed: Choices) -> list[Reason]:
        found = failing(self._margins, block, literals, allowed)
        if found:
            return found
        literal, bound, margin = best_choice(self._margins, literals, allowed)
        atom = literal.ground(bound)
        said = literal.predicate.sentence(atom.arguments, not literal.positive)
        message = (
            f"{BLOCK} is impossible: no choice of tokens meets all its conditions at once; in the best one {said} "
            f"(off by {amount(-margin, literal.predicate.unit)})"
        )
        return [reason_of(block, "not_feasible", message, atom, margin, literal.predicate.unit)]


def _no_member(task: Task, block: Block, fixed: Bound) -> Reason | None:
    for role, value in fixed.items():
        sort = block.roles.get(role)
        if isinstance(value, Token) and isinstance(sort, type) and value not in task.values_of(sort):
            message = f"{value.name} is not a member of {sort.name}, which {role} of {BLOCK} needs"
            return reason_of(block, "no_token", message, lacks=sort)
    return None


def _short_slots(task: Task, block: Block) -> Iterator[tuple[Slot, int, int]]:
    """Yield the last slot of each class of which there are too few tokens, how many it takes and how many there are."""
    for slot in {each.object_class: each for each in block.slots}.values():
        wanted = sum(each.object_class is slot.object_class for each in block.slots)
        have = len(task.values_of(slot.object_class))
        if have < wanted:
            yield slot, wanted, have


def _over_symbols(literal: Literal) -> bool:
    return literal.predicate.rows is not None
