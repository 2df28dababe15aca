"""Breadth-first search for a sequence of movements. Candidate sequences are simulated."""

from collections import Counter
from dataclasses import dataclass
from heapq import heappop, heappush

from hybrid_tamp.model.predicate import Literal
from hybrid_tamp.model.task import Task
from oracle.moves import FREE, Move, Moves, Situation, place
from oracle.world import SAMPLES, Ends, Ids, Started, World

MOST_MOVEMENTS = 6
MOST_SITUATIONS = 12_000
"""Number of situations after which a search is cut off."""
MOST_SIMULATIONS = 150
"""Number of simulated movements after which a search is cut off."""
MOST_CANDIDATES = 12
"""Number of sequences that fail in simulation after which a search is cut off."""


@dataclass(frozen=True)
class Verdict:
    """Verdict of the search.

    Attributes:
        status: ``found``, ``exhausted`` or ``cut off``.
        steps: blocks of the sequence that was found, one reassignment per item.
        movements: number of movements of the sequence.
        most_moved: largest number of movements of one object in the sequence. A tumble counts once.
        situations: number of situations of the last search.
        simulations: number of simulated movements.
        rejected: number of candidates that failed in simulation.
    """

    status: str
    steps: tuple[tuple[Started, ...], ...] = ()
    movements: int = 0
    most_moved: int = 0
    situations: int = 0
    simulations: int = 0
    rejected: int = 0


Path = list[tuple[Situation, Move]]


class Search:
    """Search for a sequence of movements that reaches the goal of a task."""

    def __init__(self, task: Task, simulate: bool = True) -> None:
        """Create the search.

        Args:
            task: the task.
            simulate: whether a sequence counts only if its simulation succeeds.
        """
        self.task, self._simulated = task, simulate
        self.world = World(task)
        self.moves = Moves(self.world)
        self.situations = self.rejected = 0
        self._goal = [
            Literal(task.domain.predicate_by_name[atom.predicate], atom.arguments, atom.positive) for atom in task.goal
        ]

    def run(self) -> Verdict:
        """Search with the initial hyperparameters first, and then with every sample."""
        for samples in (1, SAMPLES):
            status, path = self._until_simulated(samples)
            if status != "exhausted":
                return self._verdict(status, path)
        return self._verdict("exhausted", [])

    def _verdict(self, status: str, path: Path) -> Verdict:
        moved: Counter[str] = Counter()
        for _, move in path:
            for each in move.started:
                if each.block.action not in FREE and each.block.name not in ("TIPPING:lower", "TIPPING:adjacent"):
                    moved.update(name for slot, name in each.slots if self._carries(each, slot, name))
        return Verdict(
            status,
            tuple(move.started for _, move in path),
            sum(move.movements for _, move in path),
            max(moved.values(), default=0),
            self.situations,
            self.world.rolled,
            self.rejected,
        )

    def _carries(self, started: Started, slot: str, name: str) -> bool:
        """Return whether the block moves an object that is neither a hand nor a tool in a hand."""
        held = any(literal.predicate.name == "held" and literal.arguments[0] == slot for literal in started.block.entry)
        hand = bool(self.task.token_by_name[name].basic_actions)
        return "position" in started.block.writes.get(slot, ()) and not hand and not held

    def _until_simulated(self, samples: int) -> tuple[str, Path]:
        """Search until a candidate is simulated successfully. A movement that fails in simulation is removed."""
        while True:
            status, path = self._candidate(samples)
            if status != "found" or not self._simulated:
                return status, path
            if any(self._simulate(path, number) for number in range(SAMPLES)):
                return status, path
            self.rejected += 1
            if self.rejected >= MOST_CANDIDATES:
                return "cut off", []

    def _reached(self, situation: Situation) -> bool:
        return self.moves.settled(situation) and self.world.holds(self._goal, {}, situation.ids)

    def _candidate(self, samples: int) -> tuple[str, Path]:
        first = self.moves.first()
        came: dict[Situation, tuple[Situation, Move] | None] = {first: None}
        cost, seen = {self.moves.key(first): (0, 0)}, set[tuple[object, ...]]()
        queue, pushed = [(0, 0, 0, first)], 0
        while queue:
            spent, length, _, situation = heappop(queue)
            key = self.moves.key(situation)
            if key in seen:
                continue
            seen.add(key)
            self.situations = len(seen)
            if self._reached(situation):
                return "found", _path(came, situation)
            if len(seen) > MOST_SITUATIONS or self.world.rolled > MOST_SIMULATIONS:
                return "cut off", []
            for move in self.moves.find(situation, samples):
                total, after = (spent + move.movements, length + 1), self.moves.key(move.after)
                if total[0] <= MOST_MOVEMENTS and after not in seen and total < cost.get(after, (99, 0)):
                    cost[after] = total
                    came[move.after] = (situation, move)
                    pushed += 1
                    heappush(queue, (*total, pushed, move.after))
        return "exhausted", []

    def _simulate(self, path: Path, preferred: int) -> bool:
        """Simulate a candidate. Each movement uses the first successful sample, beginning with the preferred sample.

        If a movement fails for every sample, it is removed from the search.
        """
        situation = self.moves.first()
        for before, move in path:
            ended = before.running - move.after.running
            ids, ends = situation.ids, list[Ends]()
            for each in move.started:
                end = self._end(each, ids, preferred)
                if end is None:
                    if preferred == SAMPLES - 1:
                        self.world.forget(each, before.ids)
                    return False
                ends.append(end)
            if not self.moves.lawful(situation, frozenset(ended), move.started, ids):
                return False
            situation = place(situation, tuple(ends), move.after.running)
        return self._reached(situation)

    def _end(self, started: Started, ids: Ids, preferred: int) -> Ends | None:
        if not self.world.holds(started.block.entry, dict(started.roles), ids):
            return None
        first = self.world.simulate(started, ids, 1) if preferred == 0 else ()
        if any(end is not None for end in first):
            return first[0]
        outcomes = self.world.simulate(started, ids)
        return next((end for end in (*outcomes[preferred:], *outcomes[:preferred]) if end is not None), None)


def _path(came: dict[Situation, tuple[Situation, Move] | None], situation: Situation) -> Path:
    path: Path = []
    while (step := came[situation]) is not None:
        path.insert(0, step)
        situation = step[0]
    return path
