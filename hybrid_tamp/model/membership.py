"""The result of membership trials: a verdict on each class of a token, with its confidence interval."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import sqrt
from typing import Any, Literal

from hybrid_tamp.geometry.features import RestingPose
from hybrid_tamp.model.tables import Rows, Tabular

_Z = 1.959963984540054
"""Quantile of the normal distribution for an interval of 95 %."""


@dataclass(frozen=True)
class Trial:
    """One trial from one start.

    Attributes:
        success: whether the goal was reached and every measure was within its bounds.
        why: why it failed; empty if it succeeded.
        measures: the domain's metrics.
    """

    success: bool
    why: str
    measures: Mapping[str, float]


@dataclass(frozen=True)
class Verdict:
    """The verdict on one class.

    Attributes:
        object_class: name of the class.
        likelihood: how typical the shape is of the class, 0 to 1.
        labelled: the member whose properties were transferred, or None.
        residual: mean distance between its warped surface and the new one [m].
        properties: the token's properties as a member.
        contacts: expected contact points of hands, in its body frame [m].
        trials: one trial for each start.
        obstacle: why no trial was possible, or empty.
    """

    object_class: str
    likelihood: float
    labelled: str | None = None
    residual: float | None = None
    properties: Mapping[str, Any] = field(default_factory=dict)
    contacts: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    trials: tuple[Trial, ...] = ()
    obstacle: str = ""

    @property
    def successes(self) -> int:
        """Number of successful trials."""
        return sum(trial.success for trial in self.trials)

    @property
    def interval(self) -> tuple[float, float]:
        """95 % confidence interval of the success rate."""
        return wilson_interval(self.successes, len(self.trials))

    @property
    def verdict(self) -> Literal["yes", "no", "unsure", "not tried"]:
        """``yes`` or ``no`` if the interval excludes one half, ``unsure`` if it does not, or ``not tried``.

        If there is no plan for a trial, it is ``no``.
        """
        if self.obstacle:
            return "no" if self.properties else "not tried"
        low, high = self.interval
        return "yes" if low > 0.5 else "no" if high < 0.5 else "unsure"


@dataclass(frozen=True)
class MembershipResult(Tabular):
    """The result of probing a token.

    Attributes:
        task: name of the task.
        token: name of the token.
        seed: seed of the starts.
        resting: the faces on which its shape can rest.
        verdicts: one verdict for each class, the likeliest class first.
    """

    task: str
    token: str
    seed: int
    resting: tuple[RestingPose, ...]
    verdicts: tuple[Verdict, ...]

    @property
    def rows(self) -> Rows:
        """The verdicts as a table."""
        verdicts = {each.object_class: each.verdict for each in self.verdicts}
        return [("task", self.task), ("token", self.token), ("faces to rest on", len(self.resting)), *verdicts.items()]


def wilson_interval(successes: int, trials: int) -> tuple[float, float]:
    """Return the 95 % confidence interval of a success rate (Wilson 1927).

    Args:
        successes: number of successful trials.
        trials: number of trials; without trials the interval is 0 to 1.
    """
    if trials == 0:
        return 0.0, 1.0
    rate, spread = successes / trials, _Z**2 / trials
    middle = rate + spread / 2.0
    half = _Z * sqrt(rate * (1.0 - rate) / trials + spread / (4.0 * trials))
    low, high = (middle - half) / (1.0 + spread), (middle + half) / (1.0 + spread)
    return max(0.0, low) if successes else 0.0, min(1.0, high) if successes < trials else 1.0
