"""Hypotheses of an observer. A hypothesis explains the observed motion of some tokens by one block instance.

An instance lasts at least until its exit conditions are observed to hold. After that, its tokens stay still until they
leave. State variables that its block does not write stay constant during the whole instance. Target poses that its
block reads stay constant until the exit conditions hold.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.feasibility.bindings import order_conditions
from hybrid_tamp.model.affordance import BODY_STATE
from hybrid_tamp.model.bindings import enumerate_bindings, order_roles
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.expectation import declared_end
from hybrid_tamp.model.facts import StaticFacts
from hybrid_tamp.model.plan import TIME_TOLERANCE
from hybrid_tamp.model.predicate import Atom, Literal, SymbolSort, Value, name_of
from hybrid_tamp.model.task import Task
from hybrid_tamp.questions.imitate.movement_check import count_unexpected_pauses
from hybrid_tamp.questions.imitate.observation import SURE, Observation, Truth

_POSE = ("position", "orientation")
Roles = tuple[tuple[str, str], ...]
"""Pairs of (role, name of the token or symbol) of an instance."""

UNEXPLAINED_COST = 20.0
"""Cost of a movement that no block explains. One block instance costs 1."""
MISFIT_SCALE = 0.05
"""Distance from the predicted position that costs as much as one block instance, in metres."""
PAUSE_COST = 4.0
"""Cost of a pause that does not occur in the rollout of the block's policy. One block instance costs 1."""
_MISFIT_BOUND = (0.08, 0.25)
"""Pair of (offset in metres, factor). A predicted position may be off by offset plus factor times moved distance."""
_OPEN = 0.2
"""Longest time for which noise may switch exit conditions on and off, in seconds."""
_PAUSE = 0.2
"""Time that a token must stay still to end an unexplained movement, in seconds."""


@dataclass(frozen=True)
class Hypothesis:
    """A hypothetical block instance, or a movement that no block explains.

    Attributes:
        block: name of the block, or None if no block explains the movement.
        slots: pairs of (slot, token).
        targets: pairs of (target, token or symbol).
        start: row at which the tokens enter the instance.
        reached: first row at which the exit conditions hold.
        departs: first row at which a token has moved away, or a row beyond the last row if no token moves away.
        due: row by which the instance must end: `departs` if the block has `hold`, else `reached`.
        cost: cost of the hypothesis. An interpretation sums the costs of its hypotheses.
    """

    block: str | None
    slots: Roles
    targets: Roles
    start: int
    reached: int
    departs: int
    due: int
    cost: float

    @property
    def tokens(self) -> tuple[str, ...]:
        """Names of the tokens in the slots."""
        return tuple(token for _, token in self.slots)

    def slot_of(self, token: str) -> str:
        """Return the slot of a token."""
        return next(slot for slot, name in self.slots if name == token)


class Hypotheses:
    """Generator of the hypotheses about one observation, and of the rows in which hypotheses may begin and end."""

    def __init__(self, task: Task, observation: Observation) -> None:
        self.task = task
        self.observation = observation
        self.static = StaticFacts(task)
        self._targets: dict[tuple[str, Roles], tuple[Roles, ...]] = {}
        self._found: dict[tuple[str, Roles, Roles, int], tuple[Hypothesis, ...]] = {}

    def block(self, name: str) -> Block:
        """Return the block with the given name."""
        return self.task.domain.block_by_name[name]

    def truth(self, literals: tuple[Literal, ...], roles: Roles, strict: bool = False, sure: float = SURE) -> Truth:
        """Return a mask of the rows in which all conditions hold (see `Observation.truth` for the arguments)."""
        binding = self.task.bind(dict(roles))
        found = np.ones(len(self.observation.times), dtype=bool)
        for literal in literals:
            found &= self.observation.truth(literal, binding, strict, sure)
            if not found.any():
                break
        return found

    def ready(self, hypothesis: Hypothesis, strict: bool = False) -> Truth:
        """Return a mask of the rows in which the exit conditions of a hypothesis hold, starting at row `reached`."""
        exits = () if hypothesis.block is None else self.block(hypothesis.block).measured_exits
        return self.truth(exits, hypothesis.slots + hypothesis.targets, strict) & self._from(hypothesis.reached)

    def may_start(self, name: str, roles: Roles, strict: bool = False) -> Truth:
        """Return a mask of the rows in which the measured entry conditions of a block hold."""
        return self.truth(self.block(name).measured_entries, roles, strict)

    def find(self, name: str, slots: Roles, targets: Roles, start: int) -> tuple[Hypothesis, ...]:
        """Return the hypotheses that begin in a row and agree with the observation. Noise may allow several ends."""
        key = (name, slots, targets, start)
        if key not in self._found:
            rows = self._reached(self.block(name), slots + targets, start)
            candidates = [self._make(name, slots, targets, start, row) for row in rows]
            self._found[key] = tuple(each for each in candidates if each is not None)
        return self._found[key]

    def _reached(self, block: Block, roles: Roles, start: int) -> list[int]:
        """Return the first row at which the exit conditions hold, and further possible rows if there is noise."""
        seen = self.observation
        earliest = seen.times[start] + block.duration.minimum
        if earliest > seen.times[-1] + TIME_TOLERANCE and block.exit:
            return []
        since = self._from(seen.row(earliest))
        loose, exact = (np.flatnonzero(self.truth(block.measured_exits, roles, sure=s) & since) for s in (SURE, 0.0))
        if not len(loose) or (len(exact) and exact[0] == loose[0]):
            return [int(row) for row in loose[:1]]
        near = loose[seen.times[loose] <= seen.times[loose[0]] + _OPEN]
        again = near[np.flatnonzero(np.diff(near, prepend=near[0] - 2) > 1)[-1]]
        still = self._standstill(block, roles, loose[seen.times[loose] <= seen.times[loose[0]] + 2 * _OPEN])
        return sorted({int(loose[0]), int(again), int(near[-1]), *map(int, exact[:1]), *still})

    def _standstill(self, block: Block, roles: Roles, rows: NDArray[np.intp]) -> list[int]:
        """Return the first of the given rows after which no token that the block moves leaves its place for `_OPEN`.

        Noise hides small velocities, so a token may seem to be at rest while it still slows down.
        """
        seen = self.observation
        moved = [token for role, token in roles if set(block.writes.get(role, ())) & set(_POSE)]
        for row in map(int, rows):
            leaves = min((seen.departure(token, row) for token in moved), default=seen.last)
            if seen.times[min(leaves, seen.last)] - seen.times[row] >= _OPEN:
                return [row]
        return []

    def _make(self, name: str, slots: Roles, targets: Roles, start: int, reached: int) -> Hypothesis | None:
        block, seen = self.block(name), self.observation
        departs = min(self._departure(block, slot, token, start, reached) for slot, token in slots)
        if departs <= reached or self._disturbed(block, targets, start, reached):
            return None
        misfit = self._misfit(block, slots, targets, start, reached)
        if misfit is None:
            return None
        pauses = count_unexpected_pauses(block, self.task.bind(dict(slots + targets)), seen, start, reached)
        if pauses is None:
            return None
        cost = 1.0 + misfit / MISFIT_SCALE + pauses * PAUSE_COST
        return Hypothesis(name, slots, targets, start, reached, departs, departs if block.hold else reached, cost)

    def unexplained(self, token: str, start: int) -> Hypothesis:
        """Return a hypothesis without a block, which ends when the token stays still."""
        seen, row = self.observation, start + 1
        while row < seen.last:
            left = seen.departure(token, row)
            if left > seen.last or seen.times[left] - seen.times[row] >= _PAUSE:
                break
            row = left
        row = min(row, seen.last)
        due = row if start < seen.last else seen.last + 1
        return Hypothesis(None, (("token", token),), (), start, row, seen.departure(token, row), due, UNEXPLAINED_COST)

    def targets(self, block: Block, slots: Roles) -> tuple[Roles, ...]:
        """Return the bindings of the targets that the feasibility facts allow, in the order of the task's tokens.

        In each binding, tokens precede symbols.
        """
        key = (block.name, slots)
        if key not in self._targets:
            choices = self.task.choices(block, self.task.bind(dict(slots)))
            conditions = order_conditions(block)
            found = enumerate_bindings(order_roles(choices, conditions), conditions, self._holds)
            targets = sorted(block.targets, key=lambda target: isinstance(target.sort, SymbolSort))
            order = {t.name: {name_of(v): place for place, v in enumerate(choices[t.name])} for t in targets}
            roles = [tuple((target.name, name_of(bound[target.name])) for target in targets) for bound in found]
            self._targets[key] = tuple(sorted(roles, key=lambda each: [order[role][value] for role, value in each]))
        return self._targets[key]

    def _holds(self, literal: Literal, bound: Mapping[str, Value]) -> bool:
        atom = literal.ground(bound)
        return (Atom(atom.predicate, atom.arguments) in self.static) == literal.positive

    def _departure(self, block: Block, slot: str, token: str, start: int, reached: int) -> int:
        """Return the first row at which the pose or another state variable of a token has changed unexpectedly."""
        # Until `reached`, state variables that the block writes may change.
        written = set(block.writes.get(slot, ()))
        rows = [self.observation.departure(token, reached if written & set(_POSE) else start)]
        for (name, varying), changes in self._changes.items():
            rows += [row for row in changes if name == token and row > (reached if varying in written else start)]
        return min(rows)

    @cached_property
    def _changes(self) -> dict[tuple[str, str], tuple[int, ...]]:
        """Maps each (token, state variable) to the rows at which a one-place predicate that reads the variable changes.

        Poses and velocities are left out.
        """
        found: dict[tuple[str, str], tuple[int, ...]] = {}
        bodies = {varying.name for varying in BODY_STATE}
        for predicate, token in product(self.task.domain.predicates, self.task.assigned):
            parameters = predicate.parameters
            if not predicate.measured or len(parameters) > 1:
                continue
            sort, read = parameters[0].sort, set(predicate.reads.get(parameters[0].name, ())) - bodies
            if read and not isinstance(sort, SymbolSort) and token.is_member(sort):
                holds = self.observation.truth(predicate("token"), {"token": token})
                rows = tuple((np.flatnonzero(np.diff(holds.astype(int))) + 1).tolist())
                found |= {(token.name, name): (*found.get((token.name, name), ()), *rows) for name in read}
        return found

    def _disturbed(self, block: Block, targets: Roles, start: int, reached: int) -> bool:
        """Return whether a target whose pose the block reads moves before the exit conditions hold."""
        named = dict(targets)
        return any(
            self.observation.departure(named[target.name], start) < reached
            for target in block.targets
            if set(target.reads) & set(_POSE) and named[target.name] in self._assigned
        )

    def _misfit(self, block: Block, slots: Roles, targets: Roles, start: int, reached: int) -> float | None:
        """Return the sum of the tokens' distances from their predicted positions [m], or None if one is too large."""
        seen, tokens = self.observation, [token for _, token in slots]
        before = seen.likely(start)
        after = declared_end(block, self.task.bind(dict(slots + targets)), before) or before
        places = np.array([seen.place(token, reached) for token in tokens])
        off = np.stack([np.linalg.norm(after[t, "position"] - p, axis=-1) for t, p in zip(tokens, places, strict=True)])
        way = np.linalg.norm(places - [seen.place(token, start) for token in tokens], axis=-1)
        if block.outcome is not None:
            off = off[:, (off <= (_MISFIT_BOUND[0] + _MISFIT_BOUND[1] * way)[:, None]).all(axis=0)]
        return float(off.sum(axis=0).min()) if off.size else None

    def _from(self, row: int) -> Truth:
        return np.arange(len(self.observation.times)) >= row

    @cached_property
    def _assigned(self) -> frozenset[str]:
        return frozenset(token.name for token in self.task.assigned)
