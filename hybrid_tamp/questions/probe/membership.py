"""Whether a new token is a member of a class: predicted from a labelled member, then tried (paper, Sec. II-B).

Features of its shape rank the classes. For each class the surface of a labelled member is warped onto the new token,
and the properties of the labelled member are carried over. Trial tasks of the domain assume that the token is a member
with these properties. They are planned and run from several starts, and the measurements decide the verdict.
"""

import logging
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from hybrid_tamp.errors import InputError, Issue, LimitReached, NoPlan
from hybrid_tamp.execution.execute import execute
from hybrid_tamp.geometry.features import resting_poses
from hybrid_tamp.geometry.warp import Warp, warp
from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.membership import MembershipResult, Trial, Verdict
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.model.trial import TrialRecipe
from hybrid_tamp.physics.protocol import Backend

STARTS = 4
"""Least number of starts for a class: if all or none of the trials succeed, the interval excludes 1/2."""
MOST_STARTS = 16
"""Largest number of starts for a class: enough to tell a success rate of 9/10 from 1/2."""
BLOCK_SECONDS = 8.0
"""Time limit of a block in a trial, whatever its limit in a task is [s]."""
MOST_SECONDS = 60.0
"""Simulated time within which a trial must end [s]."""

FindPlan = Callable[[Task], TaskPlan]
"""Task to plan; raises NoPlan or LimitReached."""
Tell = Callable[[float, str], None]
"""Called with the share of the work that is done, 0 to 1, and its description."""

_logger = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class Prober:
    """Probes tokens.

    Attributes:
        find_plan: plans a trial task.
        backend: runs the plans.
        starts: least number of starts for a class.
        most_starts: largest number of starts, used while the verdict is unsure. It is tested after each trial, so a
            token that succeeds in half of the trials gets a verdict more often than the interval says.
        most_seconds: largest simulated time of a trial [s].
        deadline: end of the work, on the monotonic clock [s].
        tell: called with the progress.
    """

    find_plan: FindPlan
    backend: Backend
    starts: int = STARTS
    most_starts: int = MOST_STARTS
    most_seconds: float = MOST_SECONDS
    deadline: float = float("inf")
    tell: Tell = lambda share, what: None

    def probe(self, task: Task, name: str, classes: Sequence[str] = (), seed: int = 0) -> MembershipResult:
        """Find out of which of its unknown classes a token is a member.

        Args:
            task: the task; its other tokens provide hands and labelled members.
            name: the token.
            classes: names of the classes to try; by default its unknown classes.
            seed: the seed of the starts.

        Raises:
            InputError: there is no such token or class, or nothing to find out.
            LimitReached: the deadline passed.
        """
        token = _token(task, name)
        wanted = _classes(task, token, classes)
        ranked = sorted(wanted, key=lambda each: (-each.features(token.solid), each.name))
        verdicts = []
        for number, object_class in enumerate(ranked):
            self.tell(number / len(ranked), f"probing {token.name} as {object_class.name}")
            verdicts.append(self._verdict(task, token, object_class, seed))
        return MembershipResult(task.name, name, seed, resting_poses(token.solid), tuple(verdicts))

    def _verdict(self, task: Task, token: Token, object_class: type[ObjectClass], seed: int) -> Verdict:
        recipe = next((each for each in task.domain.trials if each.object_class is object_class), None)
        likelihood = object_class.features(token.solid)
        untried = Verdict(object_class.name, likelihood)
        if recipe is None:
            return replace(untried, obstacle=f"the domain {task.domain.name} does not say how it is tried")
        found = _nearest(task, token, recipe)
        if found is None:
            return replace(untried, obstacle="no token of the task is a member with a shape that could be carried over")
        labelled, warped = found
        estimate = recipe.estimate(task, token, labelled, warped.carry)
        known = Verdict(
            object_class.name, likelihood, labelled.name, warped.residual, estimate.properties, estimate.contacts
        )
        member = as_member(token, {object_class: estimate.properties})
        task = task.replaced(domain=with_time_bounds(task.domain))
        try:
            plan = self.find_plan(recipe.task(task, member, None))
        except NoPlan as error:
            return replace(known, obstacle=str(error))
        return self.run_trials(known, recipe, task, member, plan, seed)

    def run_trials(
        self, known: Verdict, recipe: TrialRecipe[Task], task: Task, member: Token, plan: TaskPlan, seed: int
    ) -> Verdict:
        """Return the verdict with trials of a member added until they are enough.

        Raises:
            LimitReached: the deadline passed.
        """
        children = np.random.SeedSequence(seed).spawn(max(self.starts, self.most_starts))
        for number, rng in enumerate(map(np.random.default_rng, children)):
            if number >= self.starts and known.verdict != "unsure":
                break
            known = replace(known, trials=(*known.trials, self.run_trial(recipe, recipe.task(task, member, rng), plan)))
        return known

    def run_trial(self, recipe: TrialRecipe[Task], task: Task, plan: TaskPlan) -> Trial:
        """Run one of a recipe's tasks.

        Raises:
            LimitReached: the deadline passed.
        """
        try:
            recording = execute(task, plan, self.backend, self._watch)
        except _NeverSettles:
            return Trial(False, f"it did not settle within {self.most_seconds:g} s of simulated time", {})
        measured = dict(task.domain.metrics(task, recording)) if task.domain.metrics else {}
        faults = list(_faults(recipe, recording, measured))
        _logger.info("%s: %s", task.name, "; ".join(faults) or "succeeded")
        return Trial(not faults, "; ".join(faults), {".".join(key): value for key, value in measured.items()})

    def _watch(self, simulated: float, expected: float) -> None:
        if simulated > self.most_seconds:
            raise _NeverSettles
        if time.monotonic() > self.deadline:
            raise LimitReached("the probe was not done in time; a larger time_limit gives it more", limit="time")


class _NeverSettles(Exception):
    """A trial exceeded its simulated time."""


def as_member(token: Token, learnt: Mapping[type[ObjectClass], Mapping[str, Any]]) -> Token:
    """Return the token as a member of more classes, with their properties; other classes may stay unknown."""
    classes = (*token.classes, *learnt)
    unknown = tuple(each for each in token.unknown if each not in classes)
    properties = {**token.properties}
    for more in learnt.values():
        properties |= more
    return Token.make(token.name, classes, properties, token.shape, unknown)


def _token(task: Task, name: str) -> Token:
    token = task.token_by_name.get(name)
    if token is None:
        raise InputError([Issue("token", "the name of a token", repr(name), tuple(task.token_by_name))])
    if token.shape is None:
        raise InputError([Issue("token", f"a token with a shape, which {name} has not")])
    return token


def _classes(task: Task, token: Token, names: Sequence[str]) -> tuple[type[ObjectClass], ...]:
    known = task.domain.class_by_name
    for name in names:
        if name not in known:
            raise InputError([Issue("classes", "a class of the domain", repr(name), tuple(known))])
        if known[name] in token.classes:
            raise InputError([Issue("classes", f"a class of which {token.name} is not known to be a member", name)])
    if not names and not token.unknown:
        remedy = "write unknown: [CLASS, ...] in the task file, or name classes=[...]"
        raise InputError([Issue("token", "a token that is unknown in some class", token.name, remedy=remedy)])
    return tuple(known[name] for name in names) or token.unknown


def _nearest(task: Task, token: Token, recipe: TrialRecipe[Task]) -> tuple[Token, Warp] | None:
    """Return the labelled member whose warped surface fits best, and the warp."""
    found = []
    for labelled in task.tokens:
        if labelled.is_member(recipe.object_class) and labelled.shape is not None and labelled.name != token.name:
            found.append((labelled, warp(labelled.shape, token.solid, recipe.align(task, token, labelled))))
    return min(found, key=lambda each: each[1].residual, default=None)


def with_time_bounds(domain: Domain) -> Domain:
    """Return the domain with shorter time limits of blocks: otherwise failing trials take most of the time."""
    durations = [replace(block.duration, maximum=min(block.duration.maximum, BLOCK_SECONDS)) for block in domain.blocks]
    blocks = zip(domain.blocks, durations, strict=True)
    return domain.with_blocks([replace(block, duration=duration) for block, duration in blocks])


def _faults(
    recipe: TrialRecipe[Task], recording: Recording, measured: Mapping[tuple[str, str], float]
) -> Iterator[str]:
    """Yield the faults of a trial."""
    if recording.failure is not None:
        yield f"{recording.failure.instance}: {recording.failure.reason}"
    for key, (low, high) in recipe.bounds.items():
        values = [value for (_, name), value in measured.items() if name == key]
        if not values:
            yield f"{key} was not measured"
        yield from (
            f"{key} {value:.4g} is not within {low:g} to {high:g}" for value in values if not low <= value <= high
        )
    if recording.failure is None:
        yield from (f"{margin.atom.text} does not hold" for margin in recording.goal if not margin.holds)
