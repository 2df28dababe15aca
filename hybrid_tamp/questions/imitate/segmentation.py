"""Segmentation: which tokens were in which blocks, from when to when, read off what was seen (paper, Sec. II-E).

An observer sees states over time only. The timeline obeys the law as far as what was seen can be explained at all.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from hybrid_tamp.model.law import Violation, check_law
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.questions.imitate.beam_search import Account, best_account
from hybrid_tamp.questions.imitate.hypotheses import Guess
from hybrid_tamp.questions.imitate.observation import Observation


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


def segment(task: Task, observation: Observation) -> Segmentation:
    """Return the explanation of what was seen.

    Args:
        task: its tokens, domain and initial assignment; nothing else of it is read but the goal, for the violations.
        observation: the states over time.
    """
    best = best_account(task, observation)
    times = observation.times
    guesses = [(guess, _end(guess, best, observation)) for guess in (*best.past, *best.running)]
    plan = TaskPlan(tuple(_instances(task, observation, guesses)), float(times[-1]))
    unexplained = sorted(
        (Unexplained(g.tokens[0], float(times[g.start]), float(times[end])) for g, end in guesses if g.block is None),
        key=lambda each: (each.start, each.token),
    )
    violations = tuple(check_law(task, plan, observation.at))
    return Segmentation(plan, tuple(unexplained), violations, best.cost)


def _end(guess: Guess, best: Account, observation: Observation) -> int:
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
