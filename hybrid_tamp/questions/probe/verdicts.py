"""What trials say of a token: of one start, of one class, of all."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from hybrid_tamp.geometry.features import RestingPose
from hybrid_tamp.questions.probe.confidence import wilson_interval


@dataclass(frozen=True)
class Trial:
    """One start.

    Attributes:
        success: whether the goal was reached and every measure was within its bounds.
        why: what was wrong, empty if nothing.
        measures: the domain's metrics.
    """

    success: bool
    why: str
    measures: Mapping[str, float]


@dataclass(frozen=True)
class Verdict:
    """What is known of one class.

    Attributes:
        object_class: its name.
        likelihood: how characteristic the shape is of the class, 0 to 1.
        labelled: the member from which the properties were carried over, or None.
        residual: mean distance between its warped surface and the new one [m].
        properties: the token's properties as a member.
        contacts: where hands are expected to touch it, in its body frame [m].
        trials: one a start.
        obstacle: why it could not be tried, or empty.
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
        """How many trials succeeded."""
        return sum(trial.success for trial in self.trials)

    @property
    def interval(self) -> tuple[float, float]:
        """Confidence interval of the success rate, 95 %."""
        return wilson_interval(self.successes, len(self.trials))

    @property
    def verdict(self) -> str:
        """``yes`` or ``no`` where the interval lies beyond one half, ``unsure`` where it does not, or ``not tried``.

        Without a plan for it, it is no.
        """
        if self.obstacle:
            return "no" if self.properties else "not tried"
        low, high = self.interval
        return "yes" if low > 0.5 else "no" if high < 0.5 else "unsure"


@dataclass(frozen=True)
class ProbeReport:
    """What came of a probe.

    Attributes:
        task: name of the task.
        token: name of the token.
        resting: the faces on which its shape comes to rest.
        verdicts: one a class, the likeliest first.
        seed: from which the starts were drawn.
    """

    task: str
    token: str
    resting: tuple[RestingPose, ...]
    verdicts: tuple[Verdict, ...]
    seed: int
