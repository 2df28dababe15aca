"""What can happen at all, and how soon: the runs of blocks that a task's tokens can come to, if nothing is ever undone.

Every condition by itself is met as soon as something meets it (the heuristic h-max of Haslum and Geffner, 2001, over
runs of blocks). A run is expected to last as long as it would in the state that its soonest causes leave behind; this
depends on where its anchor comes from. So the durations are estimates, as those of a schedule are, which knows the
whole plan.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.facts import facts, static_facts
from hybrid_tamp.model.network import SlotName
from hybrid_tamp.model.predicate import Atom, Literal, SymbolSort, name_of
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.decode import OrderedInstance
from hybrid_tamp.symbolic.estimates import Estimate, Estimates, Poses

Sort = type[ObjectClass] | SymbolSort


@dataclass(frozen=True)
class Run:
    """A block with its tokens and targets, where its anchor comes from, and how long it is expected to last [s]."""

    block: str
    roles: tuple[tuple[str, str], ...]
    source: SlotName
    seconds: float


def reachable(task: Task) -> tuple[Run, ...]:
    """Return the runs that can be reached, each condition taken by itself, in the order of the domain's blocks."""
    return _Reaching(task).runs()


@dataclass(frozen=True)
class _Cause:
    """When something holds for the first time [s], and where the tokens are that brought it about."""

    time: float
    poses: Poses


class _Reaching:
    def __init__(self, task: Task) -> None:
        self.task = task
        start = _Cause(0.0, {})
        # In an order that does not change from run to run: of causes that come equally soon the first counts.
        self.atoms: dict[Atom, _Cause] = dict.fromkeys(sorted(static_facts(task) | facts(task)), start)
        self.places: dict[tuple[str, SlotName], _Cause] = {}
        self.known: dict[tuple[str, tuple[tuple[str, str], ...], SlotName], tuple[float, float, Estimate]] = {}
        for token in task.assigned:
            block = task.domain.block_by_name[task.assignment.get(token.name, task.domain.resting)]
            self.places[token.name, (block.name, block.anchor)] = start

    def runs(self) -> tuple[Run, ...]:
        """Return the runs."""
        changed = True
        while changed:
            changed = False
            for block in self.task.domain.blocks:
                for roles in list(self._bindings(block)):
                    for source in self.task.domain.network.sources((block.name, block.anchor)):
                        changed |= self._run(block, roles, source)
        order = {block.name: number for number, block in enumerate(self.task.domain.blocks)}
        found = sorted(self.known, key=lambda key: (order[key[0]], *key[1:]))
        return tuple(Run(*key, self.known[key][2].seconds) for key in found)

    def _run(self, block: Block, roles: dict[str, str], source: SlotName) -> bool:
        """Take in what a run brings about; say whether anything comes sooner by it."""
        causes = self._causes(block, roles, source)
        if causes is None:
            return False
        start = max((cause.time for cause in causes), default=0.0)
        key = (block.name, tuple(roles.items()), source)
        if key in self.known and self.known[key][0] <= start:
            return False
        estimate = self._estimate(block, roles, causes)
        self.known[key] = (start, start + estimate.seconds, estimate)
        made = _Cause(start + estimate.seconds, estimate.outcome)
        sooner = False
        for literal in block.exit:
            atom = literal.ground(self.task.bind(roles))
            if atom.positive and (atom not in self.atoms or made.time < self.atoms[atom].time):
                self.atoms[atom], sooner = made, True
        for slot in block.slots:
            place = (roles[slot.name], (block.name, slot.name))
            if place not in self.places or made.time < self.places[place].time:
                self.places[place], sooner = made, True
        return sooner

    def _causes(self, block: Block, roles: Mapping[str, str], source: SlotName) -> list[_Cause] | None:
        """Return the soonest causes of a run, or None if it has a condition that never holds."""
        bound = self.task.bind(roles)
        atoms = [atom for literal in block.entry if (atom := literal.ground(bound)).positive]
        found = [self.atoms.get(atom) for atom in atoms]
        for slot in block.slots:
            sources = self.task.domain.network.sources((block.name, slot.name))
            ways = [source] if slot.name == block.anchor else sources
            causes = [c for way in ways if (c := self.places.get((roles[slot.name], way))) is not None]
            found.append(min(causes, key=lambda cause: cause.time, default=None))
        certain = [cause for cause in found if cause is not None]
        return certain if len(certain) == len(found) else None

    def _estimate(self, block: Block, roles: Mapping[str, str], causes: list[_Cause]) -> Estimate:
        """Return what is expected of a run in the state that its causes leave; the last one to put a token counts."""
        poses = {key: value for cause in causes for key, value in cause.poses.items()}
        task = self.task.replaced(state=self.task.state.replace(poses)) if poses else self.task
        slots = {slot.name: roles[slot.name] for slot in block.slots}
        targets = {target.name: roles[target.name] for target in block.targets}
        return Estimates(task).of([OrderedInstance("", block.name, slots, targets, 0)])[0]

    # -- bindings -----------------------------------------------------------------------------------------------

    def _bindings(self, block: Block) -> Iterator[dict[str, str]]:
        """Yield every binding whose positive entry conditions can hold."""
        conditions = [literal for literal in block.entry if literal.positive]
        denied = [literal for literal in block.static_entry if not literal.positive]
        sorts = block.roles
        for roles in self._join(sorts, conditions, _Index(self.atoms), {}):
            if not any(self._holds(literal, roles) for literal in denied) and self._distinct(roles):
                yield {role: roles[role] for role in sorts}

    def _holds(self, literal: Literal, roles: dict[str, str]) -> bool:
        atom = literal.ground(self.task.bind(roles))
        return Atom(atom.predicate, atom.arguments) in self.atoms

    def _distinct(self, roles: Mapping[str, str]) -> bool:
        tokens = [name for name in roles.values() if name in self.task.token_by_name]
        return len(set(tokens)) == len(tokens)

    def _join(
        self, sorts: Mapping[str, Sort], conditions: list[Literal], index: "_Index", roles: dict[str, str]
    ) -> Iterator[dict[str, str]]:
        if not conditions:
            yield from self._fill(sorts, roles)
            return
        patterns = [(_pattern(literal, sorts, roles), literal) for literal in conditions]
        # The most constrained first.
        rows, chosen = min(
            ((index.rows(literal.predicate.name, pattern), literal) for pattern, literal in patterns),
            key=lambda found: len(found[0]),
        )
        rest = [condition for condition in conditions if condition is not chosen]
        for row in rows:
            extended = self._extend(sorts, chosen, row, roles)
            if extended is not None:
                yield from self._join(sorts, rest, index, extended)

    def _extend(
        self, sorts: Mapping[str, Sort], literal: Literal, row: tuple[str, ...], roles: dict[str, str]
    ) -> dict[str, str] | None:
        extended = dict(roles)
        for argument, value in zip(literal.arguments, row, strict=True):
            if argument in sorts and extended.setdefault(argument, value) != value:
                return None
            if argument in sorts and argument not in roles and not self._is_of(sorts[argument], value):
                return None
        return extended

    def _is_of(self, sort: Sort, name: str) -> bool:
        return isinstance(sort, SymbolSort) or self.task.token_by_name[name].is_member(sort)

    def _fill(self, sorts: Mapping[str, Sort], roles: dict[str, str]) -> Iterator[dict[str, str]]:
        """Yield the binding with every value for the roles that no condition binds."""
        free = next((role for role in sorts if role not in roles), None)
        if free is None:
            yield roles
            return
        for value in self.task.values_of(sorts[free]):
            yield from self._fill(sorts, {**roles, free: name_of(value)})


def _pattern(literal: Literal, sorts: Mapping[str, Sort], roles: Mapping[str, str]) -> tuple[str | None, ...]:
    """Return the known arguments of a condition, None for those that are open."""
    return tuple(roles.get(a) if a in sorts else a for a in literal.arguments)


class _Index:
    """Atoms by the values of some of their arguments."""

    def __init__(self, atoms: Iterable[Atom]) -> None:
        self._by_predicate: dict[str, list[tuple[str, ...]]] = {}
        for atom in atoms:
            self._by_predicate.setdefault(atom.predicate, []).append(atom.arguments)
        self._sorted: dict[tuple[str, tuple[int, ...]], dict[tuple[str, ...], list[tuple[str, ...]]]] = {}

    def rows(self, predicate: str, pattern: tuple[str | None, ...]) -> list[tuple[str, ...]]:
        """Return the arguments of the atoms that fit the pattern."""
        known = tuple(place for place, value in enumerate(pattern) if value is not None)
        if (predicate, known) not in self._sorted:
            table: dict[tuple[str, ...], list[tuple[str, ...]]] = {}
            for row in self._by_predicate.get(predicate, ()):
                table.setdefault(tuple(row[place] for place in known), []).append(row)
            self._sorted[predicate, known] = table
        return self._sorted[predicate, known].get(tuple(value for value in pattern if value is not None), [])
