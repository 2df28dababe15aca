"""Beam search through time for the cheapest interpretation of an observation.

An interpretation explains the observed motion by block instances. An instance usually ends when its exit conditions
hold. If the block has `hold`, its exit conditions are maintained, and the instance ends when one of its tokens leaves.
The tokens then enter slots of new instances along edges of the network. At this time, the exit conditions of all ending
instances and the entry conditions of all starting instances must be observed to hold.

Of all interpretations with the same running instances, only the cheapest is kept. An interpretation is cheap if it has
few instances, and if tokens stop near their predicted positions. An instance with targets costs less if the next
instance needs its effects. This rule settles ambiguous targets, for example if a hand reaches behind an object and two
regions lie on one line.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from hybrid_tamp.model.bindings import enumerate_bindings, names_of
from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.making_way import makes_way
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.task import Task
from hybrid_tamp.questions.imitate.hypotheses import Hypotheses, Hypothesis, Roles
from hybrid_tamp.questions.imitate.observation import Observation, Truth

BEAM = 48
"""Beam width: the number of interpretations that are kept."""
_SLACK = 3
"""Largest delay between the departure of a token and the start of its next instance, in rows."""
_UNUSED = 0.2
"""Extra cost of an instance with targets if no next instance needs its effects. One block instance costs 1."""


@dataclass(frozen=True)
class Interpretation:
    """An explanation of an observation up to a row.

    Attributes:
        running: instances that are still running.
        past: instances that have ended. Their `due` is the row at which they ended.
        cost: total cost of all instances.
    """

    running: tuple[Hypothesis, ...]
    past: tuple[Hypothesis, ...]
    cost: float

    @property
    def due(self) -> int:
        """First row by which a running instance must end, or a row beyond the last row if no instance must end."""
        return min(hypothesis.due for hypothesis in self.running)

    @property
    def state(self) -> frozenset[Hypothesis]:
        """Running instances without their costs. The possible continuations depend only on this state."""
        return frozenset(replace(hypothesis, cost=0.0) for hypothesis in self.running)


@dataclass(frozen=True)
class _Reassignment:
    """A partial reassignment of tokens. The ``leaving`` tokens still need a slot in a starting instance."""

    ending: tuple[Hypothesis, ...]
    starting: tuple[tuple[str, Roles, Roles], ...]
    leaving: tuple[str, ...]

    @property
    def window(self) -> tuple[int, int]:
        return max(each.reached for each in self.ending), min(each.departs for each in self.ending) + _SLACK


def find_best(task: Task, observation: Observation, deadline: Deadline = NEVER) -> Interpretation:
    """Return the cheapest interpretation of the whole observation.

    Args:
        task: task with the tokens, the domain and the initial assignment. Its goal is ignored.
        observation: observed states over time.
        deadline: deadline of the command, after which `LimitReached` is raised.
    """
    return _Search(task, observation, deadline).best()


class _Search:
    """Beam search through time for one observation."""

    def __init__(self, task: Task, observation: Observation, deadline: Deadline) -> None:
        self.task, self.deadline = task, deadline
        self.seen = observation
        self.hypotheses = Hypotheses(task, observation)
        self._atoms: dict[tuple[str, Roles, bool], frozenset[Atom]] = {}

    def best(self) -> Interpretation:
        """Return the cheapest interpretation of the whole observation."""
        beam = [Interpretation(tuple(self._beginning()), (), 0.0)]
        while True:
            first = min(beam, key=lambda each: each.due)
            if first.due > self.seen.last:
                return min(beam, key=lambda each: each.cost)
            beam.remove(first)
            beam = _kept([*beam, *self._successors(first)])

    def _beginning(self) -> Iterator[Hypothesis]:
        for token in self.task.assigned:
            name = self.task.start_block(token.name).name
            slots = ((self.hypotheses.block(name).slots[0].name, token.name),)
            yield next(iter(self.hypotheses.find(name, slots, (), 0)), None) or self.hypotheses.unexplained(
                token.name, 0
            )

    def _successors(self, interpretation: Interpretation) -> list[Interpretation]:
        """End the instance that is due first, and return the interpretations that can follow."""
        due = min(interpretation.running, key=lambda hypothesis: hypothesis.due)
        reassignments = self._reassignments(interpretation, _Reassignment((due,), (), due.tokens))
        found = [each for reassignment in reassignments for each in self._continuations(interpretation, reassignment)]
        return found or [self._unexplained(interpretation, due)]

    def _reassignments(self, interpretation: Interpretation, reassignment: _Reassignment) -> Iterator[_Reassignment]:
        """Yield every complete reassignment that extends a partial reassignment."""
        self.deadline.check()
        if not reassignment.leaving:
            yield reassignment
            return
        token = reassignment.leaving[0]
        for name, slot in self._destinations(interpretation, token):
            for slots in self._slot_choices(interpretation, reassignment, name, slot, token):
                pulled = [g for g in interpretation.running if set(g.tokens) & {t for _, t in slots}]
                ending = (*reassignment.ending, *(g for g in pulled if g not in reassignment.ending))
                taken = {t for _, t in slots}
                leaving = tuple(t for g in ending for t in g.tokens if t not in taken | _placed(reassignment))
                for targets in self.hypotheses.targets(self.hypotheses.block(name), slots):
                    after = _Reassignment(ending, (*reassignment.starting, (name, slots, targets)), leaving)
                    low, high = after.window
                    if low <= high and self.hypotheses.may_start(name, slots + targets)[low : high + 1].any():
                        yield from self._reassignments(interpretation, after)

    def _destinations(self, interpretation: Interpretation, token: str) -> tuple[tuple[str, str], ...]:
        hypothesis = next(each for each in interpretation.running if token in each.tokens)
        if hypothesis.block is None:
            resting = self.hypotheses.block(self.task.domain.resting)
            return ((resting.name, resting.anchor),)
        found = self.task.domain.network.destinations((hypothesis.block, hypothesis.slot_of(token)))
        return tuple(each for each in found if not makes_way(self.hypotheses.block(each[0])))

    def _slot_choices(
        self, interpretation: Interpretation, reassignment: _Reassignment, name: str, slot: str, token: str
    ) -> Iterator[Roles]:
        """Yield every assignment of tokens to the slots of a block in which a given token fills a given slot."""
        placed = _placed(reassignment)
        choices = {}
        for each in self.hypotheses.block(name).slots:
            choices[each.name] = [
                other
                for other in self.task.assigned
                if (other.name == token) == (each.name == slot)
                and other.is_member(each.object_class)
                and other.name not in placed
                and (name, each.name) in self._destinations(interpretation, other.name)
            ]
        for bound in enumerate_bindings(choices):
            yield tuple(zip(bound, names_of(bound), strict=True))

    def _continuations(self, interpretation: Interpretation, reassignment: _Reassignment) -> Iterator[Interpretation]:
        if (row := self._instant(reassignment)) is None:
            return
        paid = replace(interpretation, cost=interpretation.cost + self._unused_cost(reassignment))
        choices = [self.hypotheses.find(name, slots, targets, row) for name, slots, targets in reassignment.starting]
        for started in product(*choices):
            yield _after(paid, reassignment.ending, list(started), row)

    def _unused_cost(self, reassignment: _Reassignment) -> float:
        """Return the extra cost of ending instances that have targets and whose effects no starting instance needs."""
        entries = (self._ground(name, slots + targets, True) for name, slots, targets in reassignment.starting)
        needed = frozenset[Atom]().union(*entries)
        aimed = [each for each in reassignment.ending if each.block and each.targets]
        return _UNUSED * sum(not needed & self._ground(each.block or "", each.slots + each.targets) for each in aimed)

    def _ground(self, name: str, roles: Roles, entries: bool = False) -> frozenset[Atom]:
        """Return the atoms of an instance's measured exit conditions, or of its entry conditions if `entries`."""
        key = (name, roles, entries)
        if key not in self._atoms:
            block, binding = self.hypotheses.block(name), self.task.bind(dict(roles))
            literals = block.measured_entries if entries else block.measured_exits
            self._atoms[key] = frozenset(literal.ground(binding) for literal in literals)
        return self._atoms[key]

    def _instant(self, reassignment: _Reassignment) -> int | None:
        """Return the last allowed row before the tokens move, else the first allowed row, else None."""
        low, high = reassignment.window
        rows = low + np.flatnonzero(self._allowed(reassignment, strict=True)[low : high + 1])
        if not len(rows):
            rows = low + np.flatnonzero(self._allowed(reassignment)[low : high + 1])
        if not len(rows):
            return None
        moving = [
            token
            for name, slots, _ in reassignment.starting
            for slot, token in slots
            if "position" in self.hypotheses.block(name).writes.get(slot, ())
        ]
        onset = min((self.seen.onset(token, low) for token in moving), default=low)
        still = all(self.seen.departure(token, low) > self.seen.last for token in moving)
        if still and any(each.block and not self.hypotheses.block(each.block).hold for each in reassignment.ending):
            # No token moves later, and an ending block has no hold, so the next block must begin at once.
            return int(rows[0])
        before = rows[rows <= onset]
        return int(before[-1] if len(before) else rows[0])

    def _allowed(self, reassignment: _Reassignment, strict: bool = False) -> Truth:
        """Return a mask of the rows in which the ending instances may end and the starting instances may begin."""
        allowed = np.ones(len(self.seen.times), dtype=bool)
        for hypothesis in reassignment.ending:
            allowed = allowed & self.hypotheses.ready(hypothesis, strict)
        for name, slots, targets in reassignment.starting:
            allowed = allowed & self.hypotheses.may_start(name, slots + targets, strict)
        return allowed

    def _unexplained(self, interpretation: Interpretation, due: Hypothesis) -> Interpretation:
        """End an instance whose tokens move without an explanation. Only the first token to move stays unexplained."""
        row = min(max(due.reached, due.due), self.seen.last)
        resting = self.task.domain.resting
        anchor = self.hypotheses.block(resting).anchor
        first, *others = sorted(due.tokens, key=lambda token: self.seen.departure(token, due.reached))
        started = [self.hypotheses.unexplained(first, row)]
        for token in others:
            rest = self.hypotheses.find(resting, ((anchor, token),), (), row)
            started.append(next(iter(rest), None) or self.hypotheses.unexplained(token, row))
        return _after(interpretation, (due,), started, row)


def _after(
    interpretation: Interpretation, ending: tuple[Hypothesis, ...], started: list[Hypothesis], row: int
) -> Interpretation:
    running = tuple(hypothesis for hypothesis in interpretation.running if hypothesis not in ending)
    ended = tuple(replace(hypothesis, due=row) for hypothesis in ending)
    cost = interpretation.cost + sum(hypothesis.cost for hypothesis in started)
    return Interpretation((*running, *started), (*interpretation.past, *ended), cost)


def _kept(beam: list[Interpretation]) -> list[Interpretation]:
    """Return the `BEAM` cheapest interpretations, at most one for each set of running instances."""
    found: dict[frozenset[Hypothesis], Interpretation] = {}
    for each in sorted(beam, key=lambda interpretation: interpretation.cost):
        found.setdefault(each.state, each)
    return list(found.values())[:BEAM]


def _placed(reassignment: _Reassignment) -> set[str]:
    return {token for _, slots, _ in reassignment.starting for _, token in slots}
