"""Events of a run and their log file, which contains one JSON document per line."""

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
        time: simulated time of the event [s].
        event: kind of the event.
        instance: block instance that begins, ends or fails; None if the event concerns the whole run.
        ending: names of the instances that end in a reassignment.
        starting: names of the instances that start in a reassignment.
        hyperparameters: maps each hyperparameter of the instance to its value.
        margins: margins of the entry ("begin"), exit ("end"), unmet ("failure") or goal conditions ("goal").
        reason: reason for the failure of the run; empty for other events.
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
        """Return the event as JSON data. Every event has the same keys."""
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
    """Return the value, or None if the value is not finite, because JSON has no infinity."""
    return value if value is not None and math.isfinite(value) else None


class EventLog:
    """An observer that appends events to a file. Each line is flushed, so the log survives a crash of the run."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._file: TextIO | None = None

    def __call__(self, event: Event) -> None:
        """Append one event to the file."""
        assert self._file is not None, "an EventLog must be used in a with statement"
        self._file.write(json.dumps(event.to_document(), allow_nan=False) + "\n")
        self._file.flush()

    def __enter__(self) -> "EventLog":
        self._file = self._path.open("a", encoding="utf-8", newline="\n")
        return self

    def __exit__(self, *error: object) -> None:
        if self._file is not None:
            self._file.close()
