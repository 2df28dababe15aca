"""The exception tree; foreign errors are translated to it at one boundary each.

::

    HybridTampError                 exit status
    ├── InputError                  30   the input is wrong; carries every fault found
    │   └── DomainError             30   what a domain declares contradicts itself or computes nothing
    ├── NoPlan                      10   proven unsolvable, or 11, none found
    ├── LimitReached                20   a time or memory limit
    ├── ExecutionFailed             40   the plan was run and the goal was not reached
    └── LawBroken                    1   a plan or recording that we made breaks the law of assignment

Any other exception that escapes is a bug of hybrid_tamp, exit status 1.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches


@dataclass(frozen=True)
class Issue:
    """One fault of an input, as data from which the message is built.

    Attributes:
        where: place of the fault: ``file:line:column`` or ``block.slot``.
        wanted: what was expected there.
        came: what was found instead; empty if nothing was found.
        available: the values that would have been accepted, if they are few.
        remedy: what the user can do; empty if ``wanted`` says enough.
    """

    where: str
    wanted: str
    came: str = ""
    available: tuple[str, ...] = ()
    remedy: str = ""

    def __str__(self) -> str:
        phrases = [f"{self.where}: {self.wanted}" if self.where else self.wanted]
        if self.came:
            phrases.append(f"got {self.came}")
        guess = did_you_mean(self.came.strip("'\""), self.available)
        if guess:
            phrases.append(f"did you mean {guess!r}?")
        elif self.available:
            shown = ", ".join(self.available[:12]) + (", ..." if len(self.available) > 12 else "")
            phrases.append(f"available: {shown}")
        if self.remedy:
            phrases.append(self.remedy)
        return "; ".join(phrases)


def did_you_mean(word: str, available: Sequence[str]) -> str | None:
    """Return the available word closest to a mistyped one, or None if none is close."""
    folded = {name.casefold(): name for name in available}
    close = get_close_matches(word.casefold(), folded, n=1, cutoff=0.7)
    return folded[close[0]] if close else None


class HybridTampError(Exception):
    """Root of every error that the library raises on purpose."""

    exit_status = 1


class InputError(HybridTampError):
    """The input is wrong; `issues` has every fault that was found."""

    exit_status = 30

    def __init__(self, issues: Iterable[Issue]) -> None:
        self.issues = tuple(issues)
        super().__init__("\n".join(map(str, self.issues)))


class DomainError(InputError):
    """A domain's declarations contradict each other, or what they compute is not finite."""


class NoPlan(HybridTampError):
    """There is no plan, or none was found.

    Attributes:
        proven: True if no plan can exist, False if the planner merely found none.
        kind: ``unsolvable``, ``not_found``, ``planner_crashed``, ``plan_refused`` or ``class_unknown``.
        probes: task and token of each probe that finds out whether there can be a plan.
    """

    def __init__(self, message: str, *, proven: bool, kind: str, probes: Sequence[tuple[str, str]] = ()) -> None:
        super().__init__(message)
        self.proven = proven
        self.kind = kind
        self.probes = tuple(probes)

    @property
    def exit_status(self) -> int:  # type: ignore[override]
        """10 if proven, else 11."""
        return 10 if self.proven else 11


class LimitReached(HybridTampError):
    """A time or memory limit ended the work; `limit` names it (``time`` or ``memory``)."""

    exit_status = 20

    def __init__(self, message: str, *, limit: str) -> None:
        super().__init__(message)
        self.limit = limit


class ExecutionFailed(HybridTampError):
    """The plan was run and the goal was not reached."""

    exit_status = 40


class LawBroken(HybridTampError):
    """A plan or a recording breaks the law of assignment; the message lists the violations."""
