"""The events of a run, one JSON document on each line."""

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, TextIO

from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.recording import AtomMargin


@dataclass(frozen=True)
class Event:
    """One event of a run.

    Attributes:
        time: simulated time [s].
        event: kind of the event.
        instance: the instance concerned; None if the event concerns the whole run.
        ending: instances that end in a reassignment.
        starting: instances that start in a reassignment.
        hyperparameters: hyperparameters of the instance.
        margins: entry conditions at the beginning, exit conditions at the end, unmet conditions at a failure.
        reason: why a run failed; empty otherwise.
    """

    time: float
    event: Literal["begin", "end", "reassignment", "failure", "goal"]
    instance: BlockInstance | None = None
    ending: tuple[str, ...] = ()
    starting: tuple[str, ...] = ()
    hyperparameters: Mapping[str, float] = field(default_factory=dict)
    margins: tuple[AtomMargin, ...] = ()
    reason: str = ""

    def to_document(self) -> dict[str, Any]:
        """Return the event as JSON data; every event has the same keys."""
        instance = self.instance
        return {
            "time": self.time,
            "event": self.event,
            "instance": instance and instance.name,
            "block": instance and instance.block,
            "slots": dict(instance.slots) if instance else {},
            "targets": dict(instance.targets) if instance else {},
            "hyperparameters": {name: _finite(value) for name, value in self.hyperparameters.items()},
            "margins": [
                {"atom": margin.atom.text, "measured": _finite(margin.measured), "holds": margin.holds}
                for margin in self.margins
            ],
            "ending": list(self.ending),
            "starting": list(self.starting),
            "reason": self.reason,
        }


Observer = Callable[[Event], None]


def _finite(value: float | None) -> float | None:
    """Return the value, or None if it is not finite: JSON has no infinity."""
    return value if value is not None and math.isfinite(value) else None


class EventLog:
    """Appends events to a file and flushes each line, so that a run that dies leaves a log."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._file: TextIO | None = None

    def __call__(self, event: Event) -> None:
        """Write one event; an `Observer`."""
        assert self._file is not None, "an EventLog is used in a with statement"
        self._file.write(json.dumps(event.to_document(), allow_nan=False) + "\n")
        self._file.flush()

    def __enter__(self) -> "EventLog":
        self._file = self._path.open("a", encoding="utf-8", newline="\n")
        return self

    def __exit__(self, *error: object) -> None:
        if self._file is not None:
            self._file.close()
