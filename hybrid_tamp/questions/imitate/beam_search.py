"""Interpretations of an observation, and the beam search through time for the best one.

An instance ends because one of its tokens moves on, or because its block has no hold. Its tokens then go to slots of
other instances, along edges of the network, together with tokens that wait elsewhere. This happens when the exit
conditions of what ends and the entry conditions of what begins are seen to hold. Of interpretations with the same
running instances only the cheapest is kept. An interpretation is cheap if it needs few instances and their tokens come
to rest where the blocks bring them.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from hybrid_tamp.model.bindings import enumerate_bindings, names_of
from hybrid_tamp.model.task import Task
from hybrid_tamp.questions.imitate.exits_used import ExitUse
from hybrid_tamp.questions.imitate.hypotheses import Hypotheses, Hypothesis, Roles
from hybrid_tamp.questions.imitate.observation import Observation, Truth

BEAM = 48
"""How many interpretations are followed at once."""
_SLACK = 3
"""How many rows after a token has begun to leave its new instance may begin."""


@dataclass(frozen=True)
class Interpretation:
    """What explains the observation so far.

    Attributes:
        running: the instances that run now.
        past: those before them; the row of their `due` is the one at which they ended.
        cost: of all.
    """

    running: tuple[Hypothesis, ...]
    past: tuple[Hypothesis, ...]
    cost: float

    @property
    def due(self) -> int:
        """The row by which one of the running instances must end; beyond the last one if none must."""
        return min(hypothesis.due for hypothesis in self.running)

    @property
    def state(self) -> frozenset[Hypothesis]:
        """What its continuation depends on."""
        return frozenset(replace(hypothesis, cost=0.0) for hypothesis in self.running)


@dataclass(frozen=True)
class _Reassignment:
    """A partial reassignment: what ends, what begins, and which tokens still need a slot."""

    ending: tuple[Hypothesis, ...]
    starting: tuple[tuple[str, Roles, Roles], ...]
    leaving: tuple[str, ...]

    @property
    def window(self) -> tuple[int, int]:
        return max(hypothesis.reached for hypothesis in self.ending), min(
            hypothesis.departs for hypothesis in self.ending
        ) + _SLACK


def find_best(task: Task, observation: Observation) -> Interpretation:
    """Return the cheapest interpretation of the whole observation.

    Args:
        task: its tokens, domain and initial assignment; nothing else of it is read.
        observation: the states over time.
    """
    return _Search(task, observation).best()


class _Search:
    """The search through time for one observation."""

    def __init__(self, task: Task, observation: Observation) -> None:
        self.task = task
        self.seen = observation
        self.hypotheses = Hypotheses(task, observation)
        self.exit_use = ExitUse(self.hypotheses)

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
            name = self.task.assignment.get(token.name, self.task.domain.resting)
            slots = ((self.hypotheses.block(name).slots[0].name, token.name),)
            yield next(iter(self.hypotheses.find(name, slots, (), 0)), None) or self.hypotheses.unexplained(
                token.name, 0
            )

    def _successors(self, interpretation: Interpretation) -> list[Interpretation]:
        """Return the possible continuations: how the instance that is due first ends."""
        due = min(interpretation.running, key=lambda hypothesis: hypothesis.due)
        reassignments = self._reassignments(interpretation, _Reassignment((due,), (), due.tokens))
        found = [each for reassignment in reassignments for each in self._continuations(interpretation, reassignment)]
        return found or [self._unexplained(interpretation, due)]

    def _reassignments(self, interpretation: Interpretation, reassignment: _Reassignment) -> Iterator[_Reassignment]:
        """Yield every reassignment in which all leaving tokens find slots."""
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
                    if low <= high and self._enterable(name, slots + targets, low, high):
                        yield from self._reassignments(interpretation, after)

    def _enterable(self, name: str, roles: Roles, low: int, high: int) -> bool:
        return bool(self.hypotheses.may_start(name, roles)[low : high + 1].any())

    def _destinations(self, interpretation: Interpretation, token: str) -> tuple[tuple[str, str], ...]:
        hypothesis = _with(interpretation, token)
        if hypothesis.block is None:
            resting = self.hypotheses.block(self.task.domain.resting)
            return ((resting.name, resting.anchor),)
        return self.task.domain.network.destinations((hypothesis.block, hypothesis.slot_of(token)))

    def _slot_choices(
        self, interpretation: Interpretation, reassignment: _Reassignment, name: str, slot: str, token: str
    ) -> Iterator[Roles]:
        """Yield the tokens for all slots of a block of which one token takes one slot."""
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
        row = self._instant(reassignment)
        if row is None:
            return
        paid = replace(
            interpretation, cost=interpretation.cost + self.exit_use.cost(reassignment.ending, reassignment.starting)
        )
        choices = [self.hypotheses.find(name, slots, targets, row) for name, slots, targets in reassignment.starting]
        for started in product(*choices):
            yield _after(paid, reassignment.ending, list(started), row)

    def _instant(self, reassignment: _Reassignment) -> int | None:
        """Return the row of a reassignment: as late as movements allow, else as early as conditions allow."""
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
            # Nothing moves any more, and what ends does not hold: a block that only holds begins at once.
            return int(rows[0])
        before = rows[rows <= onset]
        return int(before[-1] if len(before) else rows[0])

    def _allowed(self, reassignment: _Reassignment, strict: bool = False) -> Truth:
        """Return the rows in which what ends may end and what begins may begin."""
        allowed = np.ones(len(self.seen.times), dtype=bool)
        for hypothesis in reassignment.ending:
            allowed = allowed & self.hypotheses.ready(hypothesis, strict)
        for name, slots, targets in reassignment.starting:
            allowed = allowed & self.hypotheses.may_start(name, slots + targets, strict)
        return allowed

    def _unexplained(self, interpretation: Interpretation, due: Hypothesis) -> Interpretation:
        """End an instance without an explanation: the token that moves first moves for no reason, the others rest."""
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
    """Return the cheapest interpretations, one for each set of running instances."""
    found: dict[frozenset[Hypothesis], Interpretation] = {}
    for each in sorted(beam, key=lambda interpretation: interpretation.cost):
        found.setdefault(each.state, each)
    return list(found.values())[:BEAM]


def _with(interpretation: Interpretation, token: str) -> Hypothesis:
    return next(hypothesis for hypothesis in interpretation.running if token in hypothesis.tokens)


def _placed(reassignment: _Reassignment) -> set[str]:
    return {token for _, slots, _ in reassignment.starting for _, token in slots}
