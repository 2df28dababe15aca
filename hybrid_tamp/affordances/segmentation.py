"""Segmentation: which tokens were in which blocks, from when to when, read off what was seen (paper, Sec. II-E).

An observer sees states over time only. An explanation is a timeline of instances that obeys the law: tokens pass along
edges of the network, where the exit conditions of what ends and the entry conditions of what begins are seen to hold.
The search goes through time. An instance ends because one of its tokens moves on, or because its block has no hold;
its tokens then go to slots of other instances, together with tokens that wait elsewhere. Explanations that have come
to the same running instances are one, of which the cheaper past counts. Cheap is what needs few instances whose
tokens come to rest where the blocks bring them.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from hybrid_tamp.affordances.guesses import Guess, Guesser, Roles
from hybrid_tamp.affordances.observation import Observation, Truth
from hybrid_tamp.model.law import Violation, check_law
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.task import Task

BEAM = 48
"""So many explanations are followed at once."""
_SLACK = 3
"""So many rows after a token has begun to leave its new instance may begin."""


@dataclass(frozen=True)
class Unexplained:
    """A movement that no block of the domain explains.

    Attributes:
        token: what moved.
        start: from when [s].
        end: until when [s].
    """

    token: str
    start: float
    end: float

    def __str__(self) -> str:
        return f"{self.token} moves from {self.start:.2f} s to {self.end:.2f} s, which no block explains"


@dataclass(frozen=True)
class Segmentation:
    """What was seen, in words of the domain.

    Attributes:
        plan: the timeline of instances; tokens are in none while a movement is not explained.
        unexplained: the movements that no block explains, by time.
        violations: how the timeline, judged by what was seen, breaks the law; the goal included.
        cost: number of instances and how well they fit; the less, the better.
    """

    plan: TaskPlan
    unexplained: tuple[Unexplained, ...]
    violations: tuple[Violation, ...]
    cost: float


@dataclass(frozen=True)
class _Explanation:
    """What has been explained so far: what runs now, and what came before."""

    running: tuple[Guess, ...]
    past: tuple[Guess, ...]
    cost: float

    @property
    def due(self) -> int:
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


def segment(task: Task, observation: Observation) -> Segmentation:
    """Return the explanation of what was seen.

    Args:
        task: its tokens, domain and initial assignment; nothing else of it is read but the goal, for the violations.
        observation: the states over time.
    """
    best = _Search(task, observation).best()
    times = observation.times
    guesses = [(guess, _end(guess, best, observation)) for guess in (*best.past, *best.running)]
    plan = TaskPlan(tuple(_instances(task, observation, guesses)), float(times[-1]))
    unexplained = sorted(
        (Unexplained(g.tokens[0], float(times[g.start]), float(times[end])) for g, end in guesses if g.block is None),
        key=lambda each: (each.start, each.token),
    )
    violations = tuple(check_law(task, plan, observation.at))
    return Segmentation(plan, tuple(unexplained), violations, best.cost)


class _Search:
    """The search through time for one observation."""

    def __init__(self, task: Task, observation: Observation) -> None:
        self.task = task
        self.seen = observation
        self.guesser = Guesser(task, observation)

    def best(self) -> _Explanation:
        """Return the cheapest explanation of all that was seen."""
        beam = [_Explanation(tuple(self._beginning()), (), 0.0)]
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
            guess = self.guesser.guess(name, slots, (), 0)
            yield guess if guess is not None else self.guesser.unexplained(token.name, 0)

    def _continued(self, explanation: _Explanation) -> list[_Explanation]:
        """Return what may come next: how the instance that is due first ends."""
        due = min(explanation.running, key=lambda guess: guess.due)
        passages = self._passages(explanation, _Passage((due,), (), due.tokens))
        found = [each for passage in passages if (each := self._carried_out(explanation, passage)) is not None]
        return found or [self._unexplained(explanation, due)]

    def _passages(self, explanation: _Explanation, passage: _Passage) -> Iterator[_Passage]:
        """Yield every way in which all leaving tokens find slots."""
        if not passage.leaving:
            yield passage
            return
        token = passage.leaving[0]
        for name, slot in self._destinations(explanation, token):
            for slots in self._fillings(explanation, passage, name, slot, token):
                pulled = [g for g in explanation.running if set(g.tokens) & {t for _, t in slots}]
                ending = (*passage.ending, *(g for g in pulled if g not in passage.ending))
                taken = {t for _, t in slots}
                leaving = tuple(t for g in ending for t in g.tokens if t not in taken | _placed(passage))
                for targets in self.guesser.targets(self.guesser.block(name), slots):
                    after = _Passage(ending, (*passage.starting, (name, slots, targets)), leaving)
                    low, high = after.window
                    if low <= high and self._enterable(name, slots + targets, low, high):
                        yield from self._passages(explanation, after)

    def _enterable(self, name: str, roles: Roles, low: int, high: int) -> bool:
        return bool(self.guesser.may_start(name, roles)[low : high + 1].any())

    def _destinations(self, explanation: _Explanation, token: str) -> tuple[tuple[str, str], ...]:
        guess = _with(explanation, token)
        if guess.block is None:
            resting = self.guesser.block(self.task.domain.resting)
            return ((resting.name, resting.anchor),)
        return self.task.domain.network.destinations((guess.block, guess.slot_of(token)))

    def _fillings(
        self, explanation: _Explanation, passage: _Passage, name: str, slot: str, token: str
    ) -> Iterator[Roles]:
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
                and (name, each.name) in self._destinations(explanation, other.name)
            ]
            choices.append([(each.name, other) for other in able])
        for slots in product(*choices):
            if len({other for _, other in slots}) == len(slots):
                yield slots

    def _carried_out(self, explanation: _Explanation, passage: _Passage) -> _Explanation | None:
        row = self._instant(passage)
        if row is None:
            return None
        started = []
        for name, slots, targets in passage.starting:
            guess = self.guesser.guess(name, slots, targets, row)
            if guess is None:
                return None
            started.append(guess)
        return _after(explanation, passage.ending, started, row)

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

    def _unexplained(self, explanation: _Explanation, due: Guess) -> _Explanation:
        """Give up on an instance: those of its tokens that move do so for no reason, the others rest."""
        row = min(max(due.reached, due.due), self.seen.last)
        resting = self.task.domain.resting
        anchor = self.guesser.block(resting).anchor
        first, *others = sorted(due.tokens, key=lambda token: self.seen.departure(token, due.reached))
        started = [self.guesser.unexplained(first, row)]
        for token in others:
            rest = self.guesser.guess(resting, ((anchor, token),), (), row)
            started.append(rest or self.guesser.unexplained(token, row))
        return _after(explanation, (due,), started, row)


def _after(explanation: _Explanation, ending: tuple[Guess, ...], started: list[Guess], row: int) -> _Explanation:
    running = tuple(guess for guess in explanation.running if guess not in ending)
    ended = tuple(replace(guess, due=row) for guess in ending)
    cost = explanation.cost + sum(guess.cost for guess in started)
    return _Explanation((*running, *started), (*explanation.past, *ended), cost)


def _kept(beam: list[_Explanation]) -> list[_Explanation]:
    """Return the cheapest explanations, one for each way to go on."""
    found: dict[frozenset[Guess], _Explanation] = {}
    for each in sorted(beam, key=lambda explanation: explanation.cost):
        found.setdefault(each.state, each)
    return list(found.values())[:BEAM]


def _with(explanation: _Explanation, token: str) -> Guess:
    return next(guess for guess in explanation.running if token in guess.tokens)


def _placed(passage: _Passage) -> set[str]:
    return {token for _, slots, _ in passage.starting for _, token in slots}


def _end(guess: Guess, best: _Explanation, observation: Observation) -> int:
    return observation.last if guess in best.running else guess.due


def _instances(task: Task, observation: Observation, guesses: list[tuple[Guess, int]]) -> Iterator[BlockInstance]:
    """Yield the instances of blocks, named in the order in which they begin."""
    numbers: dict[str, int] = {}
    for guess, end in sorted(guesses, key=lambda pair: (pair[0].start, pair[1], pair[0].slots)):
        if guess.block is None:
            continue
        block = task.domain.block_by_name[guess.block]
        numbers[block.action] = numbers.get(block.action, 0) + 1
        yield BlockInstance(
            f"{block.action}-{numbers[block.action]}",
            guess.block,
            dict(guess.slots),
            float(observation.times[guess.start]),
            float(observation.times[end]),
            dict(guess.targets),
            reached=float(observation.times[guess.reached]) if block.hold else None,
        )
