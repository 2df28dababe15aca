"""Results of membership trials: one verdict for each candidate class of a token, with a confidence interval."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import sqrt
from typing import Any, Literal

from hybrid_tamp.geometry.features import RestingPose
from hybrid_tamp.model.tables import Rows, Tabular

_Z = 1.959963984540054
"""Quantile of the standard normal distribution for a 95 % confidence interval."""


@dataclass(frozen=True)
class Trial:
    """One trial of membership, from one initial state.

    Attributes:
        success: whether the trial reached the goal with every measure within its bounds.
        why: reason why the trial failed. Empty if the trial succeeded.
        measures: maps the name of each metric of the domain to its value.
        conclusive: whether the trial is evidence for or against the class. The failure of a block that does not require
            the class is no evidence, e.g. if the hand does not reach the token.
    """

    success: bool
    why: str
    measures: Mapping[str, float]
    conclusive: bool = True


@dataclass(frozen=True)
class Verdict:
    """The verdict on whether a token is a member of one class.

    Attributes:
        object_class: name of the class.
        likelihood: how typical the token's shape is of the class, as a score from 0 to 1.
        labelled: name of the known member whose properties were transferred to the token, or None.
        residual: mean distance between the warped surface of the known member and the token's surface [m], or None.
        properties: estimated properties of the token as a member of the class.
        contacts: maps the name of each expected contact point of a hand to its position in the token's body frame [m].
        trials: trials of membership, one for each initial state.
        obstacle: reason why no trial was possible, or why no trial was conclusive. Empty otherwise.
        impossible: whether it is proven that the trial task has no plan.
    """

    object_class: str
    likelihood: float
    labelled: str | None = None
    residual: float | None = None
    properties: Mapping[str, Any] = field(default_factory=dict)
    contacts: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    trials: tuple[Trial, ...] = ()
    obstacle: str = ""
    impossible: bool = False

    @property
    def successes(self) -> int:
        """Number of successful trials."""
        return sum(trial.success for trial in self.trials)

    @property
    def conclusive(self) -> int:
        """Number of trials that are evidence for or against the class."""
        return sum(trial.conclusive for trial in self.trials)

    @property
    def interval(self) -> tuple[float, float]:
        """Bounds of the 95 % confidence interval of the success rate of the conclusive trials."""
        return wilson_interval(self.successes, self.conclusive)

    @property
    def verdict(self) -> Literal["yes", "no", "unsure", "unknown", "not tried"]:
        """``yes`` if the interval is above 0.5, ``no`` if the interval is below 0.5, and ``unsure`` otherwise.

        The verdict is ``unknown`` if no trial is conclusive. Without trials, the verdict is ``no`` if the trial task is
        proven to have no plan, ``unknown`` if no plan was found, and ``not tried`` if there was no trial task.
        """
        if self.trials and not self.conclusive:
            return "unknown"
        if self.obstacle:
            return "no" if self.impossible else "unknown" if self.properties else "not tried"
        low, high = self.interval
        return "yes" if low > 0.5 else "no" if high < 0.5 else "unsure"


@dataclass(frozen=True)
class MembershipResult(Tabular):
    """The result of membership trials of one token.

    Attributes:
        task: name of the task.
        token: name of the token.
        seed: seed of the random initial states.
        resting: faces on which the token's shape can rest.
        verdicts: verdicts for the classes, the likeliest class first.
    """

    task: str
    token: str
    seed: int
    resting: tuple[RestingPose, ...]
    verdicts: tuple[Verdict, ...]

    @property
    def rows(self) -> Rows:
        """Rows of the table of verdicts."""
        verdicts = {each.object_class: each.verdict for each in self.verdicts}
        return [("task", self.task), ("token", self.token), ("faces to rest on", len(self.resting)), *verdicts.items()]


def wilson_interval(successes: int, trials: int) -> tuple[float, float]:
    """Return the 95 % confidence interval of a success rate (Wilson 1927).

    Args:
        successes: number of successful trials.
        trials: number of trials. The interval is (0, 1) if `trials` is 0.
    """
    if trials == 0:
        return 0.0, 1.0
    rate, spread = successes / trials, _Z**2 / trials
    middle = rate + spread / 2.0
    half = _Z * sqrt(rate * (1.0 - rate) / trials + spread / (4.0 * trials))
    low, high = (middle - half) / (1.0 + spread), (middle + half) / (1.0 + spread)
    return max(0.0, low) if successes else 0.0, min(1.0, high) if successes < trials else 1.0
