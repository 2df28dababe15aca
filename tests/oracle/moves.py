"""Lawful reassignments from a situation, i.e. from the states of all tokens and their assignment to blocks."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.network import SlotName
from oracle.world import Ends, Ids, Started, World

FREE = frozenset({"RESTING", "REACHING", "GRASPING", "CARRYING", "RELEASING", "TILTING", "HOLDING", "WITHDRAWING"})
"""Actions that prepare a movement and are not counted as movements."""
_WAITING = ("RESTING", "REACHING")
"""Actions in which the place of a hand is determined by the target or has no consequences."""


@dataclass(frozen=True)
class Situation:
    """States and running instances of all tokens. Tokens without an instance rest.

    Attributes:
        states: pairs of (token, number of its state), sorted.
        running: running instances other than RESTING.
    """

    states: tuple[tuple[str, int], ...]
    running: frozenset[Started]

    @property
    def ids(self) -> dict[str, int]:
        """Maps each token to the number of its state."""
        return dict(self.states)


@dataclass(frozen=True)
class Move:
    """A reassignment with the situation after its movements.

    Attributes:
        started: blocks that begin, other than RESTING.
        after: situation after the exit conditions of these blocks hold.
        movements: number of movements, without the actions in `FREE`.
    """

    started: tuple[Started, ...]
    after: Situation
    movements: int


@dataclass(frozen=True)
class _Partial:
    """An incomplete reassignment. Loose tokens have left a slot and have not entered another."""

    ended: frozenset[Started]
    started: tuple[Started, ...]
    placed: frozenset[str]

    @property
    def loose(self) -> list[str]:
        return sorted({name for instance in self.ended for _, name in instance.slots} - self.placed)


class Moves:
    """Enumeration of the reassignments that the law allows. One reassignment follows the movements of another."""

    def __init__(self, world: World) -> None:
        self.world, self.task = world, world.task
        domain = self.task.domain
        self._resting, self._network, self._blocks = domain.resting, domain.network, domain.block_by_name
        self._slot = self._blocks[self._resting].slots[0].name
        self._hands = {token.name for token in self.task.tokens if token.basic_actions}
        self._fitting = {
            (block.name, slot.name): [t.name for t in self.task.assigned if t.is_member(slot.object_class)]
            for block in domain.blocks
            for slot in block.slots
        }

    def first(self) -> Situation:
        """Return the initial situation, in which every token rests."""
        return Situation(tuple(sorted(self.world.start.items())), frozenset())

    def key(self, situation: Situation) -> tuple[object, ...]:
        """Return a key that is equal for merged situations. The place of a waiting hand is ignored."""
        busy = {name for each in situation.running if each.block.action not in _WAITING for _, name in each.slots}
        cells = tuple(
            self.world.cell(number) if name in busy or name not in self._hands else ()
            for name, number in situation.states
        )
        return (frozenset((each.block.name, each.roles) for each in situation.running), cells)

    def settled(self, situation: Situation) -> bool:
        """Return whether the plan may end, because every running block has `hold`."""
        return all(each.block.hold for each in situation.running)

    def find(self, situation: Situation, samples: int) -> Iterator[Move]:
        """Yield every reassignment."""
        ids = situation.ids
        where = self._where(situation)
        seen = set[tuple[frozenset[Started], frozenset[Started]]]()
        for partial in self._partials(situation, ids, where):
            key = (partial.ended, frozenset(partial.started))
            if key not in seen and self.lawful(situation, partial.ended, partial.started, ids):
                seen.add(key)
                yield from self._carried_out(situation, partial, ids, samples)

    def _where(self, situation: Situation) -> dict[str, tuple[SlotName, Started | None]]:
        found: dict[str, tuple[SlotName, Started | None]] = {
            token.name: ((self._resting, self._slot), None) for token in self.task.assigned
        }
        for each in situation.running:
            found |= {name: ((each.block.name, slot), each) for slot, name in each.slots}
        return found

    def _partials(
        self, situation: Situation, ids: Ids, where: dict[str, tuple[SlotName, Started | None]]
    ) -> Iterator[_Partial]:
        running = sorted(situation.running, key=lambda each: each.text)
        # A block without `hold` ends as soon as its exit conditions hold, so it ends first.
        bounded = [each for each in running if not each.block.hold]
        for each in bounded[:1] or running:
            yield from self._close(_Partial(frozenset({each}), (), frozenset()), ids, where)
        if not bounded:
            idle = {name for name, (_, instance) in where.items() if instance is None}
            for block in self._blocks.values():
                if block.name != self._resting:
                    for started in self._starts(block, {}, ids, where, idle):
                        yield _Partial(frozenset(), (started,), frozenset(name for _, name in started.slots))

    def _close(
        self, partial: _Partial, ids: Ids, where: dict[str, tuple[SlotName, Started | None]]
    ) -> Iterator[_Partial]:
        """Yield every completion of a partial reassignment, in which no token is loose."""
        if not partial.loose:
            yield partial
            return
        token = partial.loose[0]
        for name, slot in self._network.destinations(where[token][0]):
            block = self._blocks[name]
            if name == self._resting:
                if self.world.holds(block.entry, {slot: token}, ids):
                    yield from self._close(
                        _Partial(partial.ended, partial.started, partial.placed | {token}), ids, where
                    )
                continue
            for started in self._starts(block, {slot: token}, ids, where, set(where) - partial.placed):
                names = frozenset(each for _, each in started.slots)
                pulled = {where[each][1] for each in names} - {None}
                ended = partial.ended | pulled  # type: ignore[operator]
                yield from self._close(_Partial(ended, (*partial.started, started), partial.placed | names), ids, where)

    def _starts(
        self,
        block: Block,
        fixed: dict[str, str],
        ids: Ids,
        where: dict[str, tuple[SlotName, Started | None]],
        free: set[str],
    ) -> Iterator[Started]:
        """Yield the bindings of a block whose tokens can move along edges and whose entry conditions hold."""
        fitting: list[list[str]] = []
        for slot in block.slots:
            names = [fixed[slot.name]] if slot.name in fixed else self._fitting[block.name, slot.name]
            fitting.append(
                [
                    name
                    for name in names
                    if name in free
                    and name in self._fitting[block.name, slot.name]
                    and self._network.allows(where[name][0], (block.name, slot.name))
                ]
            )
        for chosen in product(*fitting):
            if len(set(chosen)) == len(chosen):
                tokens = {slot.name: name for slot, name in zip(block.slots, chosen, strict=True)}
                for roles in self.world.bindings(block, tokens, ids):
                    yield Started(block, roles)

    def lawful(self, situation: Situation, ended: frozenset[Started], started: tuple[Started, ...], ids: Ids) -> bool:
        """Return whether the exit conditions of ending blocks hold, and no block changes what another block reads."""
        if not all(self.world.holds(each.block.measured_exits, dict(each.roles), ids) for each in ended):
            return False
        if any(not self.world.holds(each.block.entry, dict(each.roles), ids) for each in started):
            return False
        readers = [*(situation.running - ended), *started]
        return not any(_disturbs(writer, reader) for writer in started for reader in readers if writer is not reader)

    def _carried_out(self, situation: Situation, partial: _Partial, ids: Ids, samples: int) -> Iterator[Move]:
        running = (situation.running - partial.ended) | set(partial.started)
        movements = sum(each.block.action not in FREE for each in partial.started)
        for ends in product(*(self.world.ends(each, ids, samples) for each in partial.started)):
            yield Move(partial.started, place(situation, ends, running), movements)


def place(situation: Situation, ends: tuple[Ends, ...], running: frozenset[Started]) -> Situation:
    """Return the situation with tokens at the ends of their movements and with other running instances."""
    ids = situation.ids
    for end in ends:
        ids |= dict(end)
    return Situation(tuple(sorted(ids.items())), frozenset(running))


def _disturbs(writer: Started, reader: Started) -> bool:
    roles = dict(reader.roles)
    read = {roles[target.name]: set(target.reads) for target in reader.block.targets}
    return any(set(writer.block.writes.get(slot, ())) & read.get(name, set()) for slot, name in writer.slots)
