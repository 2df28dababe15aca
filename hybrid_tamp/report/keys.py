"""The keys of the JSON documents: one table of those that differ from the fields of the dataclasses they show."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from hybrid_tamp.model.affordances import AffordanceResult, Implication
from hybrid_tamp.model.explanation import Explanation, Link, Reason, Suggestion, TaskExplanation
from hybrid_tamp.model.membership import MembershipResult, Verdict
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


def domain(result: TaskExplanation | AffordanceResult) -> str:
    """Name of the domain."""  # Not by its path, because type hints of domains hold forward references.
    return result.task.domain.name


def solvable(suggestion: Suggestion) -> Literal[True]:
    """Whether there is a plan with the change; only such changes are suggested."""
    return True


QUESTION_KEYS: Mapping[type, Keys] = {
    TaskExplanation: (Key("task", "task.name"), Key("domain", domain), "status", "explanation", "tokens"),
    Explanation: (
        "kind",
        "message",
        "reasons",
        Key("suggestions", default=[]),
        Key("all_looked_at", "complete", default=False),
        Key("together", "together_text", default=[]),
    ),
    Reason: (
        Key("goal", "goal_text"),
        "block",
        "kind",
        "message",
        Key("atom", "atom_text", default=""),
        Key("margin", default=None),
        Key("unit", default=""),
        Key("lacks", "lacks_text", default=""),
    ),
    Suggestion: ("kind", "what", Key("solvable", solvable, default=True), "length", "names"),
    Link: ("instance", "atom", Key("needed_by", "needed_by_text")),
    AffordanceResult: (
        Key("task", "task.name"),
        Key("domain", domain),
        "view",
        Key("agents", "task.agents"),
        "affordances",
        "implied",
        "what_if",
    ),
    Implication: (
        "seen",
        "observer",
        Key("object", "affordance.object"),
        Key("block", "affordance.block"),
        Key("slot", "affordance.slot"),
        "holds",
        "witness",
    ),
    MembershipResult: ("task", "token", "seed", Key("resting_faces", "resting"), Key("classes", "verdicts")),
    Verdict: (
        Key("class", "object_class"),
        "verdict",
        "likelihood",
        "labelled",
        "residual",
        "properties",
        "contacts",
        "successes",
        "trials",
        "interval",
        "obstacle",
    ),
}
"""The keys of the answers to questions."""


KEYS: Mapping[type, Keys] = {
    **QUESTION_KEYS,
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

DOCUMENTS: Mapping[str, type] = {
    "result-1": RunResult,
    "explain-1": TaskExplanation,
    "affordances-1": AffordanceResult,
    "probe-1": MembershipResult,
}
"""File stem of a JSON Schema to the result that is shown."""
