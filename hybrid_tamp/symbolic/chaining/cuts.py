"""Cuts, which divide a series of blocks where a plan may have to stop or another block may have to begin.

The planner applies a chain as one action, so no other action comes between its blocks. No plan is lost if the following
conditions hold at each junction between two blocks of the chain:

* No other block requires a fact that holds at the junction but not at the end of the chain. If tokens may stay at the
  junction, the goal requires no such fact. No other block deletes an effect that the chain has after the junction.
* If tokens may stay at the junction, the later blocks have no new entry conditions (`composing`), and tokens may also
  stay at the end of the chain.
* All blocks of the chain lock the same targets. If one block of the chain changes a token that other blocks may read,
  all blocks of the chain change this token.

A token in the chain is in no other block. So conditions on slots of two different blocks never concern one token.
"""

from collections.abc import Iterator

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.predicate import ANY, Atom, Literal, SymbolSort
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.chaining.composing import within
from hybrid_tamp.symbolic.chaining.series import Link, Series, Sort, key, list_deleted, rename_roles, with_any_value
from hybrid_tamp.symbolic.encoding.conditions import Conditions
from hybrid_tamp.symbolic.encoding.vocabulary import Vocabulary


class Cuts:
    """Decides which series of blocks need no cut in a task."""

    def __init__(self, task: Task) -> None:
        self.task = task
        self.domain: Domain = task.domain
        self.conditions = Conditions(Vocabulary(task.domain))

    def is_uncut(self, series: Series) -> bool:
        """Return whether the series can be compiled as one block without a loss of plans."""
        inside = {link.block.name for link in series.links}
        # Other tokens may pass through the same series, so the series is one of the other blocks.
        others = [*(b for b in self.domain.blocks if b.name not in inside), series.block("the whole")]
        return (
            self._encodable(series)
            and len({self._footprint(link) for link in series.links}) == 1
            and self._comes_to_stay(series)
            and not any(self._needed(series, junction, others) for junction in series.junctions)
            and not self._overruled(series, others)
        )

    def _encodable(self, series: Series) -> bool:
        """Return whether the encoder has operators for all edges into and out of the series."""
        first, last = series.links[0], series.last
        if len(first.block.slots) == 1:
            return True
        ways = [
            end for slot in last.block.slots for end in self.domain.network.destinations((last.block.name, slot.name))
        ]
        returns = any(block == first.block.name for block, _ in ways)
        alone = all(len(self.domain.block_by_name[block].slots) == 1 for block, _ in ways)
        return not returns and (alone or last.roles[last.block.anchor] == series.anchor)

    def _footprint(self, link: Link) -> tuple[frozenset[str], frozenset[str]]:
        """Return the locked targets, and the slots with tokens that the block changes and other blocks may read."""
        locked = frozenset(link.roles[target.name] for target in self.conditions.locked(link.block))
        slots = [slot.name for slot in link.block.slots if self.conditions.changes(link.block, slot.name)]
        return locked, frozenset(link.roles[slot] for slot in slots)

    def _comes_to_stay(self, series: Series) -> bool:
        """Return whether tokens may stay or rest after the last block. Return True if tokens may stay in no block."""
        if series.last.block.hold or not any(link.block.hold for link in series.links):
            return True
        _, changed = self._footprint(series.last)
        return not changed and all(self._may_rest(series, slot.name) for slot in series.last.block.slots)

    def _may_rest(self, series: Series, slot: str) -> bool:
        """Return whether the token in a slot of the last block can always enter the resting block."""
        block, resting = series.last.block, self.domain.resting_block
        role = series.last.roles[slot]
        wanted = [rename_roles(literal, {resting.anchor: role}) for literal in resting.entry]
        return (
            self.domain.network.allows((block.name, slot), (resting.name, resting.anchor))
            and within(series.sorts[role], resting.slot(resting.anchor).object_class)
            and all(literal in series.known for literal in wanted)
            and not resting.exit
            and not resting.targets
        )

    # -- facts that hold only inside ----------------------------------------------------------------------------

    def _needed(self, series: Series, junction: Series, others: list[Block]) -> bool:
        """Return whether another block or the goal requires a fact that holds at the junction but not at the end."""
        lost = list(_lost(series, junction))
        wanted = junction.last.block.hold and any(self._is_goal(series, fact) for fact in lost)
        return wanted or any(
            fact.predicate is literal.predicate and literal.positive and self._meet(series, fact, block, literal)
            for fact in lost
            for block in others
            for literal in block.entry
        )

    def _is_goal(self, series: Series, fact: Literal) -> bool:
        return any(
            atom.predicate == fact.predicate.name and self._could_be(series, fact, atom) for atom in self.task.goal
        )

    def _could_be(self, series: Series, fact: Literal, atom: Atom) -> bool:
        return all(
            mine in (ANY, name) or (mine in series.sorts and self._is_of(name, series.sorts[mine]))
            for mine, name in zip(fact.arguments, atom.arguments, strict=True)
        )

    def _is_of(self, name: str, sort: Sort) -> bool:
        if isinstance(sort, SymbolSort):
            return name in sort.symbols
        return name in self.task.token_by_name and self.task.token_by_name[name].is_member(sort)

    # -- effects that another block deletes ---------------------------------------------------------------------

    def _overruled(self, series: Series, others: list[Block]) -> bool:
        """Return whether another block may delete an effect of the second or a later block of the series."""
        coming = [literal for link in series.links[1:] for literal in link.exit if literal in series.exit]
        return any(
            fact.positive and fact.predicate is undone.predicate and self._meet(series, fact, block, undone)
            for fact in coming
            for block in others
            for undone in list_deleted(block)
        )

    def _meet(self, series: Series, mine: Literal, block: Block, theirs: Literal) -> bool:
        """Return whether a literal of the series and a literal of another block may be the same atom."""
        slots = {slot.name for slot in block.slots}
        for one, other in zip(mine.arguments, theirs.arguments, strict=True):
            apart = one in series.slots and other in slots
            overlapping = self._overlap(series.sorts.get(one, one), block.roles.get(other, other))
            if ANY not in (one, other) and (apart or not overlapping):
                return False
        return True

    def _overlap(self, one: Sort | str, other: Sort | str) -> bool:
        """Return whether two classes, sorts or symbols may share a member."""
        if isinstance(one, str) or isinstance(other, str):
            ours = {one} if isinstance(one, str) else set(getattr(one, "symbols", ()))
            theirs = {other} if isinstance(other, str) else set(getattr(other, "symbols", ()))
            return bool(ours & theirs)
        if isinstance(one, SymbolSort) or isinstance(other, SymbolSort):
            return one is other
        return self.domain.relations.can_share_token(one, other)


def _lost(series: Series, junction: Series) -> Iterator[Literal]:
    """Yield the facts that may hold at the junction but not at the end. `ANY` stands for an unknown value."""
    for literal in junction.last.exit:
        if literal.predicate.maintained and literal.positive and literal not in series.exit:
            yield literal
    for link in series.links[len(junction.links) :]:
        for literal in link.exit:
            if not literal.predicate.maintained:
                yield from (fact for fact in _there(junction, literal) if fact not in series.exit)


def _there(junction: Series, literal: Literal) -> Iterator[Literal]:
    """Yield the facts that may hold at the junction and that the exit condition `literal` deletes."""
    index = literal.predicate.functional_index
    if index is None:
        if not literal.positive and (literal not in junction.exit or ~literal in junction.exit):
            yield ~literal
        return
    same = [each for each in junction.exit if each.predicate is literal.predicate and key(each) == key(literal)]
    held = [each for each in junction.known if each.predicate is literal.predicate and key(each) == key(literal)]
    # If a block before the junction has deleted the value, no fact is lost.
    yield from held if held or same else [with_any_value(literal, index)]
