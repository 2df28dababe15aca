"""Blocks in series as one: the entry and exit conditions of the whole, and its links.

The whole has roles of its own. Each link maps the roles of its block to roles of the whole.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.block import Block, Duration, Slot, Target
from hybrid_tamp.model.predicate import ANY, Literal, SymbolSort

Sort = type[ObjectClass] | SymbolSort


@dataclass(frozen=True, eq=False)
class Link:
    """One block of a chain.

    Attributes:
        block: the block.
        roles: its roles to roles of the whole, or to the symbols that they must be.
    """

    block: Block
    roles: Mapping[str, str]

    @property
    def entry(self) -> tuple[Literal, ...]:
        """The block's entry conditions over roles of the whole."""
        return tuple(rename_roles(literal, self.roles) for literal in self.block.entry)

    @property
    def exit(self) -> tuple[Literal, ...]:
        """The block's exit conditions over roles of the whole."""
        return tuple(rename_roles(literal, self.roles) for literal in self.block.exit)


@dataclass(frozen=True, eq=False)
class Series:
    """Blocks that follow each other and are composed so far.

    Attributes:
        links: the blocks, first to last.
        sorts: roles of the whole, slots first, to their classes or sorts.
        entry: the entry conditions of the whole.
        exit: the conditions that hold once its last block has reached its exit.
        known: the changing conditions that hold then, whether or not the series brought them about.
        before: the series without its last block, None if it has only one.
    """

    links: tuple[Link, ...]
    sorts: Mapping[str, Sort]
    entry: tuple[Literal, ...]
    exit: tuple[Literal, ...]
    known: tuple[Literal, ...]
    before: "Series | None" = None

    @property
    def last(self) -> Link:
        """The last link."""
        return self.links[-1]

    @property
    def slots(self) -> frozenset[str]:
        """The roles of the whole that are slots."""
        return frozenset(self.links[0].roles[slot.name] for slot in self.links[0].block.slots)

    @property
    def anchor(self) -> str:
        """The anchor of the whole, which is that of its first block."""
        return self.links[0].roles[self.links[0].block.anchor]

    @property
    def junctions(self) -> Iterator["Series"]:
        """The shorter series with which it begins, longest first: one for each junction between two blocks."""
        junction = self.before
        while junction is not None:
            yield junction
            junction = junction.before

    def block(self, name: str) -> Block:
        """Return the whole as one block."""
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
            # The links are scheduled, never the whole.
            duration=Duration(shortest, sum(block.duration.maximum for block in blocks), lambda *_: shortest),
            targets=tuple(
                Target(role, sort, _united(_read(link, role) for link in self.links))
                for role, sort in self.sorts.items()
                if role not in self.slots
            ),
            entry=self.entry,
            exit=self.exit,
            writes={
                role: _united(link.block.writes.get(own, ()) for link in self.links for own in _called(link, role))
                for role in sorted(self.slots)
            },
            keeps=tuple(dict.fromkeys(predicate for block in blocks for predicate in block.keeps)),
            hold=self.last.block.hold,
            description=f"{first.name} to {self.last.block.name}, in series",
        )


def _read(link: Link, role: str) -> tuple[str, ...]:
    """Return the properties that the block of the link reads of a target of the whole."""
    targets = {target.name: target.reads for target in link.block.targets}
    return _united(targets.get(own, ()) for own in _called(link, role))


def _called(link: Link, role: str) -> Iterator[str]:
    return (own for own, name in link.roles.items() if name == role)


def _united(names: Iterable[tuple[str, ...]]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(name for some in names for name in some))


def rename_roles(literal: Literal, roles: Mapping[str, str]) -> Literal:
    """Return the literal with other names for its roles; symbols and `ANY` stay."""
    return replace(literal, arguments=tuple(roles.get(argument, argument) for argument in literal.arguments))


def list_deleted(block: Block) -> Iterator[Literal]:
    """Yield the literals that the block deletes; `ANY` stands for the old value of a functional predicate."""
    for literal in block.exit:
        index = literal.predicate.functional_index
        if index is not None:
            yield Literal(literal.predicate, (*literal.arguments[:index], ANY, *literal.arguments[index + 1 :]))
        elif not literal.positive:
            yield ~literal
