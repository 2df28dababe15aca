"""The keys of the JSON documents: one table of those that differ from the fields of the dataclasses they show."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.recording import AtomMargin
from hybrid_tamp.model.refined import Performance
from hybrid_tamp.model.run_result import ExecutedInstance, RunResult


@dataclass(frozen=True)
class Key:
    """One key of a document.

    Attributes:
        name: the key.
        source: the attribute that it shows, by its path, or a function of the whole value; by default the attribute of
            the same name.
        default: what is meant where a document leaves the key out; without one the key is required.
        nullable: whether it is null where the number is not finite.
        keys: the keys of what it shows, if they differ from those in `KEYS`.
    """

    name: str
    source: str | Callable[[Any], Any] = ""
    default: Any = ...
    nullable: bool = False
    keys: "Keys | None" = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "source", self.source or self.name)


Keys = tuple[str | Key, ...]
"""The keys of an object in their order; one that is named like its attribute is its name only."""

GOAL_KEYS: Keys = ("atom", Key("margin", "measured"), "holds")


def breaches(result: RunResult) -> tuple[str, ...]:
    """Breaches of the law of assignment by the recording; empty if there are none."""
    return tuple(map(str, result.law))


KEYS: Mapping[type, Keys] = {
    RunResult: (
        Key("task", "task.name"),
        "success",
        Key("goal", "recording.goal", keys=GOAL_KEYS),
        "blocks",
        "replans",
        "metrics",
        Key("sim_seconds", "recording.duration"),
        "wall_seconds",
        Key("seed", "task.seed"),
        Key("backend", "recording.backend"),
        "versions",
        Key("failure", "recording.failure"),
        "performance",
        Key("law", breaches),
    ),
    AtomMargin: ("atom", "predicted", "measured", "holds"),
    ExecutedInstance: (
        Key("instance", "instance.name"),
        Key("start", "instance.start"),
        Key("end", "instance.end"),
        Key("exit", "exits"),
    ),
    Performance: (
        "instance",
        "measure",
        "unit",
        "weight",
        Key("predicted", "figure", nullable=True),
        Key("measured", default=None),
    ),
    BlockInstance: (Key("block", "action"), "mode", Key("instance", "name"), "slots", "targets", "hyperparameters"),
}
"""Dataclass to its keys; of other dataclasses every field is a key."""

TEXTS: Mapping[type, Callable[[Any], str]] = {Atom: lambda atom: atom.text}
"""Values that are shown as text."""

DOCUMENTS: Mapping[str, type] = {"result-1": RunResult}
"""File stem of a JSON Schema to the result that is shown."""
