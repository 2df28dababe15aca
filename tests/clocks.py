"""Clocks for tests: a clock that runs too fast and jumps, and a deadline that counts how often it is checked."""

import itertools
import time
from dataclasses import dataclass, field

import pytest

from hybrid_tamp.model.deadline import Deadline


def hurried(monkeypatch: pytest.MonkeyPatch, rate: float = 1000.0, jump: float = 0.0, every: int = 7) -> None:
    """Replace the monotonic clock.

    Args:
        monkeypatch: restores the clock after the test.
        rate: number of seconds that pass on the clock per second.
        jump: jump of the clock at every `every`-th reading [s].
        every: number of readings between two jumps.
    """
    true, readings = time.monotonic, itertools.count()
    began = true()
    monkeypatch.setattr(time, "monotonic", lambda: began + rate * (true() - began) + jump * (next(readings) // every))


@dataclass(frozen=True)
class Counted(Deadline):
    """A deadline that passes at a given check.

    Attributes:
        most: number of checks after which the deadline has passed.
        checks: one entry for each check so far.
    """

    most: float = float("inf")
    checks: list[None] = field(default_factory=list)

    def check(self) -> None:
        """Count a check.

        Raises:
            LimitReached: the deadline has passed.
        """
        self.checks.append(None)
        (Deadline.after(self.limit, -self.limit) if len(self.checks) > self.most else Deadline()).check()
