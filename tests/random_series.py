"""Random tasks of blocks in series."""

import random
from collections.abc import Mapping, Sequence
from typing import Any

from serial import COLOURS, Part, Tool, block, changing, domain, in_series, predicate, task

from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.kind import Kind
from hybrid_tamp.model.predicate import Literal, SymbolSort
from hybrid_tamp.model.task import Task

Sorts = Mapping[str, type[ObjectClass] | SymbolSort]


class RandomSeries:
    """Two to four blocks in series and up to three other blocks. Some have `hold` or a second target."""

    def __init__(self, seed: int) -> None:
        self.rng = rng = random.Random(seed)
        self.plain = [changing(f"p{i}", Part, at_first=rng.random() < 0.4) for i in range(4)]
        self.colour = predicate(
            "colour-of", Part, COLOURS, holds=lambda _, value: value == "red", kind=Kind.FUNCTIONAL, value_of="x1"
        )
        fitting = {(one, other) for one in "01" for other in "01" if rng.random() < 0.6}
        self.fit = predicate(
            "fit", Part, Part, holds=lambda one, other: (one[-1], other[-1]) in fitting, kind=Kind.STATIC
        )
        self.targets: Sorts = {"other": Part} if rng.random() < 0.4 else {}
        self.several = rng.random() < 0.3

    def task(self) -> Task:
        """Return a task with two parts and a tool."""
        rng, series = self.rng, self._series()
        others = [self._other(f"C{i}") for i in range(rng.randint(1, 3))]
        edges = in_series(series) + [edge for other in others for edge in in_series([other])]
        if rng.random() < 0.3:
            edges.append((f"{series[-1].name}.part", f"{others[0].name}.part"))
        wanted = [literal for each in (*series, *others) for literal in each.exit if literal.positive]
        wanted = [rng.choice([*wanted, self._literal("part")]) for _ in range(rng.randint(1, 3))]
        goal = [(each.predicate.name, f"part {rng.randrange(2)}", *each.arguments[1:]) for each in wanted]
        assignment = {"part 0": rng.choice(series).name} if not self.several and rng.random() < 0.1 else {}
        of = domain([*series, *others], [*self.plain, self.colour, self.fit], edges)
        return task(of, goal, parts=2, tools=1, assignment=assignment)

    def _series(self) -> list[Block]:
        slots: dict[str, type[ObjectClass]] = {"part": Part, "tool": Tool} if self.several else {"part": Part}
        series: list[Block] = []
        for i in range(self.rng.randint(2, 4)):
            targets = self.targets if self.rng.random() < 0.6 else {}
            entry = self._entry(series[-1].exit if series else (), targets)
            anchor = self.rng.choice(list(slots)) if self.rng.random() < 0.3 else "part"
            series.append(self._block(f"B{i}", slots, entry, targets, anchor=anchor))
        return series

    def _entry(self, before: Sequence[Literal], targets: Sorts) -> list[Literal]:
        """Return conditions; most of them hold after the previous block."""
        held = [
            literal for literal in before if literal.positive and ("other" in targets or "part" in literal.arguments)
        ]
        entry = self.rng.sample(held, min(len(held), self.rng.randint(0, 2)))
        if not before or self.rng.random() < 0.1:
            entry.append(self._literal("part"))
        if targets and self.rng.random() < 0.7:
            entry.append(self.fit("part", "other"))
        return entry

    def _other(self, name: str) -> Block:
        targets = self.targets if self.rng.random() < 0.5 else {}
        entry = [self._literal(self.rng.choice(["part", *targets])) for _ in range(self.rng.randint(0, 2))]
        return self._block(name, {"part": Part}, entry, targets)

    def _block(
        self, name: str, slots: Mapping[str, type[ObjectClass]], entry: list[Literal], targets: Sorts, **named: Any
    ) -> Block:
        writes = {"part": ("position",)} if self.rng.random() < 0.3 else {}
        hold = self.rng.random() < 0.5
        return block(name, slots, entry, self._exit(["part", *targets]), targets, hold=hold, writes=writes, **named)

    def _exit(self, things: Sequence[str]) -> list[Literal]:
        found: dict[tuple[Any, str], Literal] = {}
        for _ in range(self.rng.choice([1, 1, 2, 3])):
            one = self._literal(self.rng.choice(things))
            denied = one.predicate is not self.colour and self.rng.random() < 0.4
            found[one.predicate, one.arguments[0]] = ~one if denied else one
        return list(found.values())

    def _literal(self, thing: str) -> Literal:
        if self.rng.random() < 0.3:
            return self.colour(thing, self.rng.choice(COLOURS.symbols))
        return self.rng.choice(self.plain)(thing)
