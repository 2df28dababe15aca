"""The deadline of a command. The clock can end a command, but never changes the results of a finished command."""

import math
import time
from dataclasses import dataclass

from hybrid_tamp.errors import LimitReached


@dataclass(frozen=True)
class Deadline:
    """The instant at which a command must end.

    A verb creates one deadline and passes the deadline to every function that can take long. These functions check the
    deadline repeatedly. Worker processes check the same deadline, because all processes share the clock.

    Attributes:
        limit: time limit of the command [s].
        end: reading of the monotonic clock at the deadline [s].
    """

    limit: float = math.inf
    end: float = math.inf

    @classmethod
    def after(cls, limit: float, began: float | None = None) -> "Deadline":
        """Return the deadline of a command.

        Args:
            limit: time limit of the command [s].
            began: reading of the monotonic clock when the command began [s]; by default now.
        """
        return cls(limit, (time.monotonic() if began is None else began) + limit)

    @property
    def left(self) -> float:
        """Time until the deadline, at least 0 [s]."""
        return max(0.0, self.end - time.monotonic())

    def check(self) -> None:
        """Check that time is left.

        Raises:
            LimitReached: the deadline has passed.
        """
        if not self.left:
            said = f"the command reached its time limit of {self.limit:g} s; a larger limit may be enough"
            raise LimitReached(said, limit="time")


NEVER = Deadline()
"""Deadline that never passes."""
