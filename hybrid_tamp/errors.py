"""The exceptions of the library. Errors of third-party libraries are caught and raised again as these exceptions.

::

    HybridTampError                 exit status
    ├── InputError                  30   the input is wrong; `issues` lists every fault
    │   └── DomainError             30   a domain is contradictory, or a function of the domain fails
    │       ├── ShapeError          30   a function of the domain returns an array of the wrong shape
    │       └── ForeignCommand      30   a policy commands a token that is in no slot of its block
    ├── NoPlan                  10, 11   the task is proven unsolvable (10), or no plan was found (11)
    ├── LimitReached                20   a time or memory limit was reached
    ├── ExecutionFailed             40   the plan was executed but the goal was not reached
    └── LawBroken                    1   a plan or recording breaks the law of assignment (see `model.law`)

Any other exception is a bug in hybrid_tamp. The exit status is then 1.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches


@dataclass(frozen=True)
class Issue:
    """A fault of an input, split into the parts of its error message.

    Attributes:
        where: place of the fault, e.g. ``file:line:column`` or ``block.slot``.
        wanted: the requirement that is not met.
        came: the given value as text; empty if no value was given.
        available: the accepted values; empty if they cannot be listed.
        remedy: advice on how to repair the fault; empty if ``wanted`` makes the repair clear.
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
    """Return the available word that is most similar to a mistyped word, or None if no word is similar enough."""
    folded = {name.casefold(): name for name in available}
    close = get_close_matches(word.casefold(), folded, n=1, cutoff=0.7)
    return folded[close[0]] if close else None


class HybridTampError(Exception):
    """Base class of the errors that the library raises on purpose."""

    exit_status = 1


class InputError(HybridTampError):
    """Error for a wrong input; `issues` lists every fault."""

    exit_status = 30

    def __init__(self, issues: Iterable[Issue]) -> None:
        self.issues = tuple(issues)
        super().__init__("\n".join(map(str, self.issues)))

    def __reduce__(self) -> tuple[type, tuple[tuple[Issue, ...]]]:
        # By default, pickle would pass the text of the error to the constructor instead of the issues.
        return type(self), (self.issues,)


class DomainError(InputError):
    """Error for a domain with contradictory declarations, or with a function that fails or returns a wrong result."""


class ShapeError(DomainError):
    """Error for a function of a domain that returns an array of the wrong shape."""


class ForeignCommand(DomainError):
    """Error for a policy that commands a token that is in no slot of its block, or an action that the token lacks."""


class NoPlan(HybridTampError):
    """Error for a task for which no plan exists or no plan was found.

    Attributes:
        proven: whether the task is proven to have no plan.
        kind: kind of the failure, e.g. ``unsolvable`` (see `model.outcome.MESSAGES`).
        probes: pairs of (task, token). The task may become solvable if trials confirm an unknown class of the token.
    """

    def __init__(self, message: str, *, proven: bool, kind: str, probes: Sequence[tuple[str, str]] = ()) -> None:
        super().__init__(message)
        self.proven = proven
        self.kind = kind
        self.probes = tuple(probes)

    def extended(self, *lines: str) -> "NoPlan":
        """Return the error with further lines at the end of its message."""
        return NoPlan("\n".join([str(self), *lines]), proven=self.proven, kind=self.kind, probes=self.probes)

    @property
    def exit_status(self) -> int:  # type: ignore[override]
        """Exit status: 10 if the task is proven unsolvable, else 11."""
        return 10 if self.proven else 11


class LimitReached(HybridTampError):
    """Error raised when a time or memory limit is reached; `limit` is ``time`` or ``memory``."""

    exit_status = 20

    def __init__(self, message: str, *, limit: str = "time") -> None:
        # Pickle passes only the message to the constructor and restores `limit` afterwards, so `limit` has a default.
        super().__init__(message)
        self.limit = limit


class ExecutionFailed(HybridTampError):
    """Error raised when an executed plan does not reach the goal, or when no trial confirms a class of a token."""

    exit_status = 40


class LawBroken(HybridTampError):
    """Error for a plan or recording that breaks the law of assignment. The message lists the violations."""
