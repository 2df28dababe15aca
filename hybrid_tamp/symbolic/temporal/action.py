"""Builder of the durative action that runs a block. The module `encoder` explains the fluents."""

from dataclasses import dataclass
from itertools import combinations

from hybrid_tamp.model.affordance import TOKEN, ObjectClass
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.predicate import ANY, Literal, SymbolSort
from hybrid_tamp.symbolic.pddl.naming import legal, variable_of
from hybrid_tamp.symbolic.pddl.operators import Fact
from hybrid_tamp.symbolic.temporal.problem import Condition, DurativeAction, Effect, Value, When
from hybrid_tamp.symbolic.temporal.words import NOBODY, Words


@dataclass(frozen=True)
class Running:
    """The block that an action runs.

    Attributes:
        block: Name of the block.
        along: Slots whose tokens come from the same instance as the anchor.
        roles: Maps each role of the block to the index of its parameter.
    """

    block: str
    along: frozenset[str]
    roles: dict[str, int]


class ActionMaker:
    """Builder of one durative action."""

    def __init__(self, words: Words, block: Block, along: frozenset[str]) -> None:
        """Start the action that runs a block. Tokens of the slots `along` come from the anchor's last instance."""
        self.words, self.vocabulary = words, words.vocabulary
        self.block, self.along = block, along
        self.parameters: dict[str, str] = {}
        self.conditions: dict[Condition, None] = {}
        self.effects: dict[Effect, None] = {}
        self.changes: dict[Fact, int] = {}
        self.roles = {role: self._declare(role, sort) for role, sort in block.roles.items()}

    def build(self) -> tuple[DurativeAction, Running]:
        """Return the action and a description of the block that it runs."""
        block = self.block
        self._distinct()
        self._entry()
        self._keep()
        for slot in block.slots:
            self._take(slot.name)
        self._lock()
        self._exit()
        name = "-".join(["run", legal(block.name), *(f"along-{legal(slot)}" for slot in sorted(self.along))])
        duration = (self.words("lasts", block.name), *self.roles.values())
        order = list(self.parameters)
        changes = [Effect("start", fact, change, add=True) for fact, change in self.changes.items() if change]
        effects = (*self.effects, *changes)
        action = DurativeAction(name, tuple(self.parameters.items()), duration, tuple(self.conditions), effects)
        return action, Running(block.name, self.along, {role: order.index(v) for role, v in self.roles.items()})

    # -- pieces -------------------------------------------------------------------------------------------------

    def _declare(self, base: str, sort: type[ObjectClass] | SymbolSort | str) -> str:
        variable = variable_of(base, self.parameters)
        if isinstance(sort, str):
            self.parameters[variable] = sort
        else:
            self.parameters[variable] = self.vocabulary.type_of(sort)
            for fact in self.vocabulary.guard(variable, sort):
                self.require(fact)
        return variable

    def require(self, fact: Fact, value: Value = True, when: When = "start") -> None:
        """Add a condition."""
        self.conditions[Condition(when, fact, value)] = None

    def at_start(self, fact: Fact, value: Value = True) -> None:
        """Set a value at the start of the action."""
        self.effects[Effect("start", fact, value)] = None

    def count(self, word: str, variable: str, change: int) -> None:
        """Change a number at the start of the action. Several changes of the same number are summed."""
        fact = (self.words(word), variable)
        self.changes[fact] = self.changes.get(fact, 0) + change

    def at_end(self, fact: Fact, value: Value = True) -> None:
        """Set a value at the end of the action."""
        self.effects[Effect("end", fact, value)] = None

    def _arguments(self, literal: Literal) -> tuple[str, ...]:
        return tuple(
            ANY if a == ANY else self.roles[a] if a in self.roles else self.vocabulary.symbol(a)
            for a in literal.arguments
        )

    def _distinct(self) -> None:
        sorts = self.block.roles
        for one, other in combinations(sorts, 2):
            first, second = sorts[one], sorts[other]
            if isinstance(first, SymbolSort) or isinstance(second, SymbolSort):
                continue
            if self.vocabulary.domain.relations.can_share_token(first, second):
                self.require(("distinct", self.roles[one], self.roles[other]))

    def _entry(self) -> None:
        for literal in self.block.entry:
            arguments = self._arguments(literal)
            word = self.vocabulary.predicate(literal.predicate.name, literal.positive)
            if literal.predicate.static:
                self.require((word, *arguments))
            else:
                self.require(*self.words.stated(literal.predicate, word, arguments))

    def _keep(self) -> None:
        for literal in self.block.invariants:
            word = self.vocabulary.predicate(literal.predicate.name, literal.positive)
            self.require(*self.words.stated(literal.predicate, word, self._arguments(literal)), "over all")

    def _take(self, slot: str) -> None:
        """Move a token from its old slot to a slot of the block, and release its old instance."""
        variable, block, along = self.roles[slot], self.block, slot in self.along
        sources = self.words.sources(block, slot, along)
        constants = [self.words.slot(old, before) for old, before in sources]
        place, own = (self.words("place"), variable), self.words.slot(block, slot)
        before = constants[0]
        if len(constants) > 1:
            before = self._declare(f"{slot}-from", self.words("slot"))
            self.require((self.words("passes"), before, own))
        # The fluent keeps the old slot until the end, so that no other action can take the token meanwhile.
        self.require(place, (before,), "throughout")
        self.at_end(place, (own,))
        self._part(slot, along, sources)
        self._stop_reading(slot, sources)
        self._void(slot, sources)
        if block.hold and any(not old.hold for old, _ in sources):
            self.at_start((self.words("completed"), variable))
        elif not block.hold:
            self.at_start((self.words("completed"), variable), False)

    def _part(self, slot: str, along: bool, sources: list[tuple[Block, str]]) -> None:
        """Update the fluents `partner`, `let-go` and `crew` for a token that leaves its last instance."""
        variable, block = self.roles[slot], self.block
        partner = (self.words("partner"), variable)
        anchor = self.roles[block.anchor]
        if along:
            self.require(partner, (anchor,))
        else:
            bound = any(before != old.anchor for old, before in sources)
            if bound:
                last = self._declare(f"{slot}-partner", self.vocabulary.type_of(TOKEN))
                self.require(partner, (last,))
                self.require((self.words("let-go"), last))
                self.count("crew", last, -1)
            if slot != block.anchor:
                self.at_start(partner, (anchor,))
            elif bound:
                self.at_start(partner, (self.words(NOBODY),))
        if self.words.conditions.claimable(block, slot) and any(
            before == old.anchor and old.others for old, before in sources
        ):
            self.at_start((self.words("let-go"), variable))
        if slot == block.anchor and self.words.conditions.claimable(block, slot):
            joining = len(block.others) - len(self.along)
            self.count("crew", variable, joining)
            self.require((self.words("crew"), variable), len(block.others), "end")
            if block.others:
                self.at_end((self.words("let-go"), variable), False)

    def _stop_reading(self, slot: str, sources: list[tuple[Block, str]]) -> None:
        """If the token was the anchor of its last instance, release the targets that the instance read."""
        locked = self.words.conditions.locked
        for number in range(self.words.locks):
            readers = [old for old, before in sources if before == old.anchor and len(locked(old)) > number]
            if not readers:
                continue
            reads = (self.words.reads(number), self.roles[slot])
            last = self._last_read(slot, sources, number)
            self.require(reads, (last,))
            self.count("readers", last, -1)
            if slot != self.block.anchor or len(locked(self.block)) <= number:
                self.at_start(reads, (self.words(NOBODY),))

    def _last_read(self, slot: str, sources: list[tuple[Block, str]], number: int) -> str:
        """Return the variable of a target that the token's last instance read. Unified roles share a variable."""
        named = set()
        for old, before in sources:
            locked = self.words.conditions.locked(old) if before == old.anchor else ()
            unified = self.words.conditions.unified(old, before, self.block, slot)
            named.add(unified.get(locked[number].name) if len(locked) > number else None)
        role = named.pop() if len(named) == 1 else None
        if role is not None and role in self.roles:
            return self.roles[role]
        return self._declare(f"{slot}-read", self.vocabulary.type_of(TOKEN))

    def _void(self, slot: str, sources: list[tuple[Block, str]]) -> None:
        """Clear the conditions that the last instance of the token maintained and that the block does not maintain."""
        maintained = {c.predicate: None for old, before in sources for c in self._kept(old, before)}
        anew = {literal.predicate for literal in self._kept(self.block, slot)}
        for predicate in maintained:
            if predicate not in anew and len(self.words.key(predicate)) < len(predicate.parameters):
                fact = (self.vocabulary.predicate(predicate.name), self.roles[slot])
                self.at_start(fact, self.words.none(predicate))

    def _kept(self, block: Block, slot: str) -> list[Literal]:
        return self.words.conditions.maintained_by(block, slot)

    def _lock(self) -> None:
        """Lock the targets that the block reads. Require that no instance reads a token that the block changes."""
        conditions, block = self.words.conditions, self.block
        for number, target in enumerate(conditions.locked(block)):
            self.at_start((self.words.reads(number), self.roles[block.anchor]), (self.roles[target.name],))
            self.count("readers", self.roles[target.name], 1)
        for slot in block.slots:
            if conditions.readable(block, slot.name) and conditions.changes(block, slot.name):
                self.require((self.words("readers"), self.roles[slot.name]), 0, "over all")

    def _exit(self) -> None:
        entry = {(c.fact, c.value) for c in self.conditions if c.when == "start"}
        literals = sorted(self.block.exit, key=lambda literal: literal.positive)
        stated: dict[Fact, Value] = {}
        for literal in literals:
            predicate, word = literal.predicate, self.vocabulary.predicate(literal.predicate.name)
            if predicate.static or (predicate.maintained and not literal.positive):
                continue
            fact, value = self.words.stated(predicate, word, self._arguments(literal))
            if ANY not in fact:
                none: Value = self.words.none(predicate) if value is not True else False
                stated[fact] = value if literal.positive else none
        for fact, value in stated.items():
            if (fact, value) not in entry:
                self.at_end(fact, value)
