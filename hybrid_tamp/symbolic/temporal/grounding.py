"""Reachability of block runs under the delete relaxation, with the earliest time of each run.

A fact holds as soon as any run achieves it (heuristic h-max of Haslum and Geffner, 2001). The duration of a run is
estimated in the state after the runs that first achieve its entry conditions. This state depends on the source block
of the anchor. The scheduler has better estimates because the plan is known.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.expectation import Beginning, Expectations, declared_end
from hybrid_tamp.model.facts import facts, static_facts
from hybrid_tamp.model.network import SlotName
from hybrid_tamp.model.predicate import Atom, name_of
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.decode import OrderedInstance
from hybrid_tamp.symbolic.estimates import Estimate, Estimates, Poses
from hybrid_tamp.symbolic.pddl.joins import FactIndex, join

_Roles = tuple[str, tuple[tuple[str, str], ...]]
"""Name of a block, and pairs of (role, token or symbol)."""


@dataclass(frozen=True)
class Run:
    """One run of a block.

    Attributes:
        block: Name of the block.
        roles: Pairs of (role, token or symbol).
        source: Pair of (block, slot) that the anchor leaves.
        seconds: Expected duration [s].
    """

    block: str
    roles: tuple[tuple[str, str], ...]
    source: SlotName
    seconds: float


def reachable(task: Task) -> tuple[Run, ...]:
    """Return the runs that are reachable if no fact is ever deleted, in the domain's block order."""
    return _Reaching(task).runs()


@dataclass(frozen=True)
class _Cause:
    """The earliest time of a fact [s], and the poses of the tokens after the run that achieves the fact."""

    time: float
    poses: Poses


class _Reaching:
    def __init__(self, task: Task) -> None:
        self.task = task
        self.expectations = Expectations()
        self.rolled: dict[_Roles, Estimate] = {}
        start = _Cause(0.0, {})
        # The order is fixed because the first of several simultaneous causes is used.
        self.atoms: dict[Atom, _Cause] = dict.fromkeys(sorted(static_facts(task) | facts(task)), start)
        self.places: dict[tuple[str, SlotName], _Cause] = {}
        self.known: dict[tuple[str, tuple[tuple[str, str], ...], SlotName], tuple[float, float, Estimate]] = {}
        for token in task.assigned:
            block = task.start_block(token.name)
            self.places[token.name, (block.name, block.anchor)] = start

    def runs(self) -> tuple[Run, ...]:
        """Return the reachable runs, in the domain's block order."""
        changed = True
        while changed:
            changed = False
            for block in self.task.domain.blocks:
                sources = self.task.domain.network.sources((block.name, block.anchor))
                tries = [(roles, source) for roles in self._bindings(block) for source in sources]
                self._roll_out(block, tries)
                for roles, source in tries:
                    changed |= self._run(block, roles, source)
        order = {block.name: number for number, block in enumerate(self.task.domain.blocks)}
        found = sorted(self.known, key=lambda key: (order[key[0]], *key[1:]))
        return tuple(Run(*key, self.known[key][2].seconds) for key in found)

    def _run(self, block: Block, roles: dict[str, str], source: SlotName) -> bool:
        """Add the effects of a run. Return whether any fact holds sooner than before."""
        causes = self._new_causes(block, roles, source)
        if causes is None:
            return False
        start, key = _latest(causes), (block.name, tuple(roles.items()), source)
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

    def _roll_out(self, block: Block, tries: Sequence[tuple[dict[str, str], SlotName]]) -> None:
        """Roll out the first possible run of each binding as one batch, unless the block declares its duration."""
        firsts: dict[_Roles, Beginning] = {}
        for roles, source in tries if block.duration.expected is None else ():
            key = (block.name, tuple(roles.items()))
            if key not in self.rolled | firsts and (causes := self._causes(block, roles, source)) is not None:
                binding, state = self.task.bind(roles), self._state(causes)
                # The state after several runs may contradict the conditions, and then no rollout says anything.
                if all(float(literal.margin(state, binding)) >= 0 for literal in block.measured_entries):
                    firsts[key] = Beginning(block, binding, state, block.initial_values(binding, state))
        self.expectations.of(list(firsts.values()))
        self.rolled |= {key: self._make(block, dict(key[1]), begin.state) for key, begin in firsts.items()}

    def _new_causes(self, block: Block, roles: Mapping[str, str], source: SlotName) -> list[_Cause] | None:
        """Return the causes of a run, or None if the run is not possible yet, or is known with causes as early."""
        causes = self._causes(block, roles, source)
        known = self.known.get((block.name, tuple(roles.items()), source))
        return None if causes is None or (known is not None and known[0] <= _latest(causes)) else causes

    def _causes(self, block: Block, roles: Mapping[str, str], source: SlotName) -> list[_Cause] | None:
        """Return the earliest cause of each condition of a run, or None if a condition is not reached yet."""
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
        """Return the estimate of a run in the state after its causes. Later causes override earlier causes.

        If the block declares no duration, all runs with the same roles have the estimate of the first rollout.
        """
        if block.duration.expected is not None:
            return self._make(block, roles, self._state(causes))
        known = self.rolled.get((block.name, tuple(roles.items())))
        return known or self._estimate_like_others(block, roles, self._state(causes))

    def _estimate_like_others(self, block: Block, roles: Mapping[str, str], state: State) -> Estimate:
        """Return the longest duration of the block's other rollouts, with the final poses that the block declares."""
        durations = (estimate.seconds for (name, _), estimate in self.rolled.items() if name == block.name)
        end = declared_end(block, self.task.bind(roles), state)
        poses = {}
        if end is not None:
            moved = [self.task.token_by_name[roles[slot.name]] for slot in block.slots]
            poses = {(token.name, each.name): end[token, each.name].copy() for token in moved for each in token.varying}
        return Estimate(max(durations, default=block.duration.minimum), {}, poses)

    def _make(self, block: Block, roles: Mapping[str, str], state: State) -> Estimate:
        slots = {slot.name: roles[slot.name] for slot in block.slots}
        targets = {target.name: roles[target.name] for target in block.targets}
        estimates = Estimates(self.task.replaced(state=state), expectations=self.expectations)
        return estimates.of([OrderedInstance("", block.name, slots, targets, 0)])[0]

    def _state(self, causes: Sequence[_Cause]) -> State:
        in_order = sorted(causes, key=lambda cause: cause.time)
        poses = {key: value for cause in in_order for key, value in cause.poses.items()}
        return self.task.state.replace(poses) if poses else self.task.state

    def _bindings(self, block: Block) -> Iterator[dict[str, str]]:
        """Yield every binding with which all entry conditions of the block are reachable."""
        ranges = {f"?{r}": dict.fromkeys(map(name_of, self.task.values_of(sort))) for r, sort in block.roles.items()}
        conditions = [
            (literal.predicate.name, *(f"?{a}" if a in block.roles else a for a in literal.arguments))
            for literal in block.entry
            if literal.positive
        ]
        denied = [~literal for literal in block.static_entry if not literal.positive]
        index = FactIndex((atom.predicate, *atom.arguments) for atom in self.atoms)
        for binding in join(conditions, {}, index, ranges):
            roles = {role: binding[f"?{role}"] for role in block.roles}
            if not any(literal.ground(roles) in self.atoms for literal in denied) and self._distinct(roles):
                yield roles

    def _distinct(self, roles: Mapping[str, str]) -> bool:
        tokens = [name for name in roles.values() if name in self.task.token_by_name]
        return len(set(tokens)) == len(tokens)


def _latest(causes: Sequence[_Cause]) -> float:
    return max((cause.time for cause in causes), default=0.0)
