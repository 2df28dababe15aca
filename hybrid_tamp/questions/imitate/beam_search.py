"""Accounts of what was seen, and the search through time for the best.

An instance ends because one of its tokens moves on, or because its block has no hold; its tokens then go to slots of
other instances, along edges of the network, together with tokens that wait elsewhere. That happens where the exit
conditions of what ends and the entry conditions of what begins are seen to hold. Accounts that have come to the same
running instances are one, of which the cheaper past counts. Cheap is what needs few instances whose tokens come to
rest where the blocks bring them.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from hybrid_tamp.model.task import Task
from hybrid_tamp.questions.imitate.exits_used import Purposes
from hybrid_tamp.questions.imitate.hypotheses import Guess, Guesser, Roles
from hybrid_tamp.questions.imitate.observation import Observation, Truth

BEAM = 48
"""So many accounts are followed at once."""
_SLACK = 3
"""So many rows after a token has begun to leave its new instance may begin."""


@dataclass(frozen=True)
class Account:
    """What has been explained so far.

    Attributes:
        running: the instances that run now.
        past: those before them; the row of their `due` is the one at which they ended.
        cost: of all.
    """

    running: tuple[Guess, ...]
    past: tuple[Guess, ...]
    cost: float

    @property
    def due(self) -> int:
        """The row by which one of the running instances has to end; beyond the last one if none has to."""
        return min(guess.due for guess in self.running)

    @property
    def state(self) -> frozenset[Guess]:
        """What its future depends on."""
        return frozenset(replace(guess, cost=0.0) for guess in self.running)


@dataclass(frozen=True)
class _Passage:
    """A reassignment in the making: what ends, what begins, and who still needs a slot."""

    ending: tuple[Guess, ...]
    starting: tuple[tuple[str, Roles, Roles], ...]
    leaving: tuple[str, ...]

    @property
    def window(self) -> tuple[int, int]:
        return max(guess.reached for guess in self.ending), min(guess.departs for guess in self.ending) + _SLACK


def best_account(task: Task, observation: Observation) -> Account:
    """Return the cheapest account of all that was seen.

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
        self.guesser = Guesser(task, observation)
        self.purposes = Purposes(self.guesser)

    def best(self) -> Account:
        """Return the cheapest account of all that was seen."""
        beam = [Account(tuple(self._beginning()), (), 0.0)]
        while True:
            first = min(beam, key=lambda each: each.due)
            if first.due > self.seen.last:
                return min(beam, key=lambda each: each.cost)
            beam.remove(first)
            beam = _kept([*beam, *self._continued(first)])

    def _beginning(self) -> Iterator[Guess]:
        for token in self.task.assigned:
            name = self.task.assignment.get(token.name, self.task.domain.resting)
            slots = ((self.guesser.block(name).slots[0].name, token.name),)
            yield next(iter(self.guesser.guesses(name, slots, (), 0)), None) or self.guesser.unexplained(token.name, 0)

    def _continued(self, account: Account) -> list[Account]:
        """Return what may come next: how the instance that is due first ends."""
        due = min(account.running, key=lambda guess: guess.due)
        passages = self._passages(account, _Passage((due,), (), due.tokens))
        found = [each for passage in passages for each in self._carried_out(account, passage)]
        return found or [self._unexplained(account, due)]

    def _passages(self, account: Account, passage: _Passage) -> Iterator[_Passage]:
        """Yield every way in which all leaving tokens find slots."""
        if not passage.leaving:
            yield passage
            return
        token = passage.leaving[0]
        for name, slot in self._destinations(account, token):
            for slots in self._fillings(account, passage, name, slot, token):
                pulled = [g for g in account.running if set(g.tokens) & {t for _, t in slots}]
                ending = (*passage.ending, *(g for g in pulled if g not in passage.ending))
                taken = {t for _, t in slots}
                leaving = tuple(t for g in ending for t in g.tokens if t not in taken | _placed(passage))
                for targets in self.guesser.targets(self.guesser.block(name), slots):
                    after = _Passage(ending, (*passage.starting, (name, slots, targets)), leaving)
                    low, high = after.window
                    if low <= high and self._enterable(name, slots + targets, low, high):
                        yield from self._passages(account, after)

    def _enterable(self, name: str, roles: Roles, low: int, high: int) -> bool:
        return bool(self.guesser.may_start(name, roles)[low : high + 1].any())

    def _destinations(self, account: Account, token: str) -> tuple[tuple[str, str], ...]:
        guess = _with(account, token)
        if guess.block is None:
            resting = self.guesser.block(self.task.domain.resting)
            return ((resting.name, resting.anchor),)
        return self.task.domain.network.destinations((guess.block, guess.slot_of(token)))

    def _fillings(self, account: Account, passage: _Passage, name: str, slot: str, token: str) -> Iterator[Roles]:
        """Yield the tokens for all slots of a block of which one token takes one slot."""
        placed = _placed(passage)
        choices = []
        for each in self.guesser.block(name).slots:
            able = [
                other.name
                for other in self.task.assigned
                if (other.name == token) == (each.name == slot)
                and other.is_member(each.object_class)
                and other.name not in placed
                and (name, each.name) in self._destinations(account, other.name)
            ]
            choices.append([(each.name, other) for other in able])
        for slots in product(*choices):
            if len({other for _, other in slots}) == len(slots):
                yield slots

    def _carried_out(self, account: Account, passage: _Passage) -> Iterator[Account]:
        row = self._instant(passage)
        if row is None:
            return
        paid = replace(account, cost=account.cost + self.purposes.cost(passage.ending, passage.starting))
        choices = [self.guesser.guesses(name, slots, targets, row) for name, slots, targets in passage.starting]
        for started in product(*choices):
            yield _after(paid, passage.ending, list(started), row)

    def _instant(self, passage: _Passage) -> int | None:
        """Return the row of a reassignment: as late as movements allow, else as early as conditions do."""
        low, high = passage.window
        rows = low + np.flatnonzero(self._fine(passage, strict=True)[low : high + 1])
        if not len(rows):
            rows = low + np.flatnonzero(self._fine(passage)[low : high + 1])
        if not len(rows):
            return None
        moving = [
            token
            for name, slots, _ in passage.starting
            for slot, token in slots
            if "position" in self.guesser.block(name).writes.get(slot, ())
        ]
        onset = min((self.seen.onset(token, low) for token in moving), default=low)
        still = all(self.seen.departure(token, low) > self.seen.last for token in moving)
        if still and any(each.block and not self.guesser.block(each.block).hold for each in passage.ending):
            # Nothing moves any more, and what ends does not hold: a block that only holds begins at once.
            return int(rows[0])
        before = rows[rows <= onset]
        return int(before[-1] if len(before) else rows[0])

    def _fine(self, passage: _Passage, strict: bool = False) -> Truth:
        """Return where what ends may end and what begins may begin."""
        fine = np.ones(len(self.seen.times), dtype=bool)
        for guess in passage.ending:
            fine = fine & self.guesser.ready(guess, strict)
        for name, slots, targets in passage.starting:
            fine = fine & self.guesser.may_start(name, slots + targets, strict)
        return fine

    def _unexplained(self, account: Account, due: Guess) -> Account:
        """Give up on an instance: those of its tokens that move do so for no reason, the others rest."""
        row = min(max(due.reached, due.due), self.seen.last)
        resting = self.task.domain.resting
        anchor = self.guesser.block(resting).anchor
        first, *others = sorted(due.tokens, key=lambda token: self.seen.departure(token, due.reached))
        started = [self.guesser.unexplained(first, row)]
        for token in others:
            rest = self.guesser.guesses(resting, ((anchor, token),), (), row)
            started.append(next(iter(rest), None) or self.guesser.unexplained(token, row))
        return _after(account, (due,), started, row)


def _after(account: Account, ending: tuple[Guess, ...], started: list[Guess], row: int) -> Account:
    running = tuple(guess for guess in account.running if guess not in ending)
    ended = tuple(replace(guess, due=row) for guess in ending)
    cost = account.cost + sum(guess.cost for guess in started)
    return Account((*running, *started), (*account.past, *ended), cost)


def _kept(beam: list[Account]) -> list[Account]:
    """Return the cheapest accounts, one for each way to go on."""
    found: dict[frozenset[Guess], Account] = {}
    for each in sorted(beam, key=lambda account: account.cost):
        found.setdefault(each.state, each)
    return list(found.values())[:BEAM]


def _with(account: Account, token: str) -> Guess:
    return next(guess for guess in account.running if token in guess.tokens)


def _placed(passage: _Passage) -> set[str]:
    return {token for _, slots, _ in passage.starting for _, token in slots}
