"""Trials that test whether a new token is a member of a class (paper, Sec. II-B).

The classes are ranked by features of the token's shape. For each class, the surface of a labelled (known) member is
warped onto the new token, and the properties of this member are transferred. The domain's trial tasks assume that the
new token is a member with these properties. A trial task is planned and then run from several initial states. The
measurements decide the verdict. A trial is no evidence if a block without the token fails, e.g. because a hand does not
reach the token.
"""

import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from hybrid_tamp.errors import InputError, Issue, NoPlan
from hybrid_tamp.execution.execute import execute
from hybrid_tamp.geometry.features import resting_poses
from hybrid_tamp.geometry.warp import Warp, warp
from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.authored import authored
from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.membership import MembershipResult, Trial, Verdict
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.model.trial import TrialRecipe
from hybrid_tamp.physics.protocol import Backend
from hybrid_tamp.questions.probe.evidence import find_faults, is_evidence

STARTS = 4
"""Minimum number of trials for a class. If four trials agree, the confidence interval of their rate excludes 1/2."""
MOST_STARTS = 16
"""Maximum number of trials for a class. This many trials distinguish a success rate of 9/10 from 1/2."""
BLOCK_SECONDS = 8.0
"""Upper bound on the time limit of each block in a trial, in seconds."""
MOST_SECONDS = 60.0
"""Maximum simulated time of a trial, in seconds."""

FindPlan = Callable[[Task], TaskPlan]
"""Function that returns a plan for a task. The function raises NoPlan or LimitReached if it finds no plan."""
Tell = Callable[[float, str], None]
"""Progress callback. Its arguments are the fraction of the work that is done (0 to 1) and a description."""

_logger = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class Prober:
    """Procedure that tests the class membership of tokens by trials.

    Attributes:
        find_plan: function that plans a trial task.
        backend: physics backend that runs the plans.
        starts: minimum number of trials for a class.
        most_starts: maximum number of trials for a class. Trials continue beyond the minimum only while the verdict is
            unsure. Because the verdict is tested after every trial, a token with a true success rate of 1/2 gets the
            verdict yes or no more often than the confidence level implies.
        most_seconds: maximum simulated time of a trial, in seconds.
        deadline: deadline of the command.
        tell: progress callback.
    """

    find_plan: FindPlan
    backend: Backend
    starts: int = STARTS
    most_starts: int = MOST_STARTS
    most_seconds: float = MOST_SECONDS
    deadline: Deadline = NEVER
    tell: Tell = lambda share, what: None

    def probe(self, task: Task, name: str, classes: Sequence[str] = (), seed: int = 0) -> MembershipResult:
        """Test for each class whether a token is a member.

        Args:
            task: the task of the token. Its other tokens provide hands and labelled members.
            name: name of the token.
            classes: names of the classes to test. By default, all classes that are unknown for the token.
            seed: random seed of the initial states.

        Raises:
            InputError: if the token or a class is unknown, if the token has no shape, or if no class is to be tested.
            LimitReached: if the deadline passes.
        """
        token = _token(task, name)
        ranked = sorted(_classes(task, token, classes), key=lambda each: (-_likelihood(each, token), each.name))
        verdicts = []
        for number, object_class in enumerate(ranked):
            self.tell(number / len(ranked), f"probing {token.name} as {object_class.name}")
            verdicts.append(self._verdict(task, token, object_class, seed))
        return MembershipResult(task.name, name, seed, resting_poses(token.solid), tuple(verdicts))

    def _verdict(self, task: Task, token: Token, object_class: type[ObjectClass], seed: int) -> Verdict:
        recipe = next((each for each in task.domain.trials if each.object_class is object_class), None)
        untried = Verdict(object_class.name, _likelihood(object_class, token))
        if recipe is None:
            return replace(untried, obstacle=f"the domain {task.domain.name} defines no trial for this class")
        found = _nearest(task, token, recipe)
        if found is None:
            return replace(untried, obstacle="the task has no labelled member of this class whose shape can be warped")
        labelled, warped = found
        with authored(f"the trial of {object_class.name}", {"token": token, "labelled": labelled}):
            estimate = recipe.estimate(task, token, labelled, warped.carry)
        known = Verdict(
            object_class.name,
            untried.likelihood,
            labelled.name,
            warped.residual,
            estimate.properties,
            estimate.contacts,
        )
        member = as_member(token, {object_class: estimate.properties})
        task = task.replaced(domain=with_time_bounds(task.domain))
        try:
            plan = self.find_plan(_trial_task(recipe, task, member, None))
        except NoPlan as error:
            return replace(known, obstacle=str(error), impossible=error.proven)
        return self.run_trials(known, recipe, task, member, plan, seed)

    def run_trials(
        self, known: Verdict, recipe: TrialRecipe[Task], task: Task, member: Token, plan: TaskPlan, seed: int
    ) -> Verdict:
        """Run trials until the verdict is clear, or until `most_starts` trials have run. Return the verdict.

        If none of the first trials is evidence, the verdict is unknown, and no further trials are run.

        Raises:
            LimitReached: if the deadline passes.
        """
        children = np.random.SeedSequence(seed).spawn(max(self.starts, self.most_starts))
        for number, rng in enumerate(map(np.random.default_rng, children)):
            if number >= self.starts and known.verdict != "unsure":
                break
            trial = self.run_trial(recipe, _trial_task(recipe, task, member, rng), member, plan)
            known = replace(known, trials=(*known.trials, trial))
        if known.verdict == "unknown":
            known = replace(known, obstacle="no trial is evidence for or against the class")
        return known

    def run_trial(self, recipe: TrialRecipe[Task], task: Task, member: Token, plan: TaskPlan) -> Trial:
        """Run one trial task of a recipe.

        Raises:
            LimitReached: if the deadline passes.
        """
        try:
            recording = execute(task, plan, self.backend, self._watch, deadline=self.deadline)
        except _NeverSettles:
            return Trial(False, f"the trial did not end within {self.most_seconds:g} s of simulated time", {})
        measured = task.domain.measure(task, recording)
        faults = list(find_faults(recipe, recording, measured))
        _logger.info("%s: %s", task.name, "; ".join(faults) or "succeeded")
        figures = {".".join(key): value for key, value in measured.items()}
        if is_evidence(task, recording, member, recipe.object_class):
            return Trial(not faults, "; ".join(faults), figures)
        why = f"no evidence on {recipe.object_class.name}, because another block failed: {faults[0]}"
        return Trial(False, why, figures, conclusive=False)

    def _watch(self, simulated: float, expected: float) -> None:
        if simulated > self.most_seconds:
            raise _NeverSettles


class _NeverSettles(Exception):
    """Raised if a trial exceeds its maximum simulated time."""


def as_member(token: Token, learnt: Mapping[type[ObjectClass], Mapping[str, Any]]) -> Token:
    """Return the token as a member of more classes. ``learnt`` maps each new class to the token's properties in it."""
    classes = (*token.classes, *learnt)
    unknown = tuple(each for each in token.unknown if each not in classes)
    properties = {key: value for more in (token.properties, *learnt.values()) for key, value in more.items()}
    return Token.make(token.name, classes, properties, token.shape, unknown)


def _token(task: Task, name: str) -> Token:
    token = task.token_by_name.get(name)
    if token is None:
        raise InputError([Issue("token", "expected the name of a token", repr(name), tuple(task.token_by_name))])
    if token.shape is None:
        raise InputError([Issue("token", f"expected a token with a shape, but {name} has none")])
    return token


def _classes(task: Task, token: Token, names: Sequence[str]) -> tuple[type[ObjectClass], ...]:
    known = task.domain.class_by_name
    for name in names:
        if name not in known:
            raise InputError([Issue("classes", "expected a class of the domain", repr(name), tuple(known))])
        if known[name] in token.classes:
            raise InputError([Issue("classes", f"{token.name} is already known to be a member of {name}")])
    if not names and not token.unknown:
        remedy = "add unknown: [CLASS, ...] to the token in the task file, or pass classes=[...]"
        raise InputError([Issue("token", "expected a token with unknown classes", token.name, remedy=remedy)])
    return tuple(known[name] for name in names) or token.unknown


def _likelihood(object_class: type[ObjectClass], token: Token) -> float:
    with authored(f"{object_class.name}.features", {"token": token}):
        return object_class.features(token.solid)


def _trial_task(recipe: TrialRecipe[Task], task: Task, member: Token, rng: np.random.Generator | None) -> Task:
    with authored(f"the trial of {recipe.object_class.name}", {"member": member}):
        return recipe.task(task, member, rng)


def _nearest(task: Task, token: Token, recipe: TrialRecipe[Task]) -> tuple[Token, Warp] | None:
    """Return the pair (labelled member, warp) with the best fit of the warped surface to the token."""
    found = []
    for labelled in task.tokens:
        if labelled.is_member(recipe.object_class) and labelled.shape is not None and labelled.name != token.name:
            with authored(f"the trial of {recipe.object_class.name}", {"token": token, "labelled": labelled}):
                turn = recipe.align(task, token, labelled)
            found.append((labelled, warp(labelled.shape, token.solid, turn)))
    return min(found, key=lambda each: each[1].residual, default=None)


def with_time_bounds(domain: Domain) -> Domain:
    """Return the domain with shorter time limits for its blocks, so that failing trials end early."""
    durations = [replace(block.duration, maximum=min(block.duration.maximum, BLOCK_SECONDS)) for block in domain.blocks]
    blocks = zip(domain.blocks, durations, strict=True)
    return domain.with_blocks([replace(block, duration=duration) for block, duration in blocks])
