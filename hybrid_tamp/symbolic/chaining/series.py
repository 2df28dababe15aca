"""Series of blocks that are composed into one block, which has its own roles, entry conditions and exit conditions.

Each link of the series maps the roles of one block to roles of the series.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.block import Block, Duration, Slot, Target
from hybrid_tamp.model.predicate import ANY, Literal, SymbolSort

Sort = type[ObjectClass] | SymbolSort


@dataclass(frozen=True, eq=False)
class Link:
    """One block of a series.

    Attributes:
        block: Original block.
        roles: Maps each role of the block to a role of the series, or to the only symbol that can fill the role.
    """

    block: Block
    roles: Mapping[str, str]

    @property
    def entry(self) -> tuple[Literal, ...]:
        """The block's entry conditions over roles of the series."""
        return tuple(rename_roles(literal, self.roles) for literal in self.block.entry)

    @property
    def exit(self) -> tuple[Literal, ...]:
        """The block's exit conditions over roles of the series."""
        return tuple(rename_roles(literal, self.roles) for literal in self.block.exit)


@dataclass(frozen=True, eq=False)
class Series:
    """Blocks in series. Each block follows the block before.

    Attributes:
        links: Blocks of the series, first to last.
        sorts: Maps each role of the series to its class or sort. Slots come first.
        entry: Entry conditions of the series.
        exit: Exit conditions of the series, which hold at the exit of its last block.
        known: Conditions that hold at the exit of the last block, including entry conditions that no block deletes.
        before: Series without the last block, or None if the series has one block.
    """

    links: tuple[Link, ...]
    sorts: Mapping[str, Sort]
    entry: tuple[Literal, ...]
    exit: tuple[Literal, ...]
    known: tuple[Literal, ...]
    before: "Series | None" = None

    @property
    def last(self) -> Link:
        """The last link of the series."""
        return self.links[-1]

    @property
    def slots(self) -> frozenset[str]:
        """The roles of the series that are slots."""
        return frozenset(self.links[0].roles[slot.name] for slot in self.links[0].block.slots)

    @property
    def anchor(self) -> str:
        """The role of the first block's anchor, which is the anchor of the series."""
        return self.links[0].roles[self.links[0].block.anchor]

    @property
    def junctions(self) -> Iterator["Series"]:
        """For each junction between two blocks, the series before the junction. The longest series is first."""
        junction = self.before
        while junction is not None:
            yield junction
            junction = junction.before

    def block(self, name: str) -> Block:
        """Return the series as one block."""
        first, blocks = self.links[0].block, [link.block for link in self.links]
        shortest = sum(block.duration.minimum for block in blocks)
        return Block(
            name=name,
            slots=tuple(
                Slot(role, sort)
                for role, sort in self.sorts.items()
                if role in self.slots and not isinstance(sort, SymbolSort)
            ),
            anchor=self.anchor,
            # The scheduler uses the durations of the single blocks, never this duration.
            duration=Duration(shortest, sum(block.duration.maximum for block in blocks), lambda *_: shortest),
            targets=tuple(
                Target(role, sort, _united(_read(link, role) for link in self.links))
                for role, sort in self.sorts.items()
                if role not in self.slots
            ),
            entry=self.entry,
            exit=self.exit,
            invariants=tuple(
                dict.fromkeys(rename_roles(each, link.roles) for link in self.links for each in link.block.invariants)
            ),
            writes={
                role: _united(link.block.writes.get(own, ()) for link in self.links for own in _called(link, role))
                for role in sorted(self.slots)
            },
            keeps=tuple(dict.fromkeys(predicate for block in blocks for predicate in block.keeps)),
            hold=self.last.block.hold,
            description=f"{first.name} to {self.last.block.name}, in series",
        )


def _read(link: Link, role: str) -> tuple[str, ...]:
    """Return the properties that the block of a link reads from a target of the series."""
    targets = {target.name: target.reads for target in link.block.targets}
    return _united(targets.get(own, ()) for own in _called(link, role))


def _called(link: Link, role: str) -> Iterator[str]:
    return (own for own, name in link.roles.items() if name == role)


def _united(names: Iterable[tuple[str, ...]]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(name for some in names for name in some))


def rename_roles(literal: Literal, roles: Mapping[str, str]) -> Literal:
    """Return the literal with its roles renamed. Symbols and `ANY` stay unchanged."""
    return replace(literal, arguments=tuple(roles.get(argument, argument) for argument in literal.arguments))


def key(literal: Literal) -> tuple[str, ...]:
    """Return the arguments except the functional argument. A literal replaces an earlier literal with an equal key."""
    index = literal.predicate.functional_index
    return literal.arguments if index is None else (*literal.arguments[:index], *literal.arguments[index + 1 :])


def with_any_value(literal: Literal, index: int) -> Literal:
    """Return a positive literal with `ANY` in place of the value of a functional predicate."""
    return Literal(literal.predicate, (*literal.arguments[:index], ANY, *literal.arguments[index + 1 :]))


def list_deleted(block: Block) -> Iterator[Literal]:
    """Yield the literals that the block deletes. `ANY` stands for the old value of a functional predicate."""
    for literal in block.exit:
        index = literal.predicate.functional_index
        if index is not None:
            yield with_any_value(literal, index)
        elif not literal.positive:
            yield ~literal
