"""The keys of the JSON documents: one table of those that differ from the fields of the dataclasses they show."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from hybrid_tamp.model.affordances import AffordanceResult, Implication
from hybrid_tamp.model.explanation import Explanation, Link, Reason, Suggestion, TaskExplanation
from hybrid_tamp.model.imitation import ImitationResult
from hybrid_tamp.model.membership import MembershipResult, Verdict
from hybrid_tamp.model.outcome import Exclusion, PlannerFigures, PlanOutcome
from hybrid_tamp.model.plan import BlockInstance, PlannedAction, Step
from hybrid_tamp.model.planned_network import PlannedNetwork
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.recording import AtomMargin
from hybrid_tamp.model.refined import Milestone, Performance, Retuning, Tuned, Value
from hybrid_tamp.model.run_result import ExecutedInstance, RunResult
from hybrid_tamp.report import sources


@dataclass(frozen=True)
class Key:
    """One key of a document.

    Attributes:
        name: the key.
        source: the attribute that it shows, by its path, or a function of the whole value; by default the attribute of
            the same name.
        default: what is meant where a document leaves the key out; a type makes an empty one. Without a
            default the key is required.
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


REFINEMENT_KEYS: Keys = (
    Key("optimiser", "refinement.optimiser"),
    Key("evaluations", "refinement.evaluations"),
    Key("seconds", "refinement.seconds"),
    Key("stopped", "refinement.stopped"),
    Key("best", "refinement.best"),
    Key("defaults", "refinement.defaults"),
    Key("apart", "refinement.apart"),
    Key("hyperparameters", "refinement.hyperparameters"),
    Key("performance", "refinement.performance"),
    Key("history", "refinement.history"),
    Key("rounds", "excluded"),
    Key("physics", "refinement.physics", default=None),
)


QUESTION_KEYS: Mapping[type, Keys] = {
    TaskExplanation: (Key("task", "task.name"), Key("domain", "task.domain.name"), "status", "explanation", "tokens"),
    Explanation: (
        "kind",
        "message",
        "reasons",
        Key("suggestions", default=list),
        Key("all_looked_at", "complete", default=False),
        Key("together", "together_text", default=list),
    ),
    Reason: (
        Key("goal", "goal_text"),
        "block",
        Key("kind", sources.kind),
        "message",
        Key("atom", "atom_text", default=""),
        Key("margin", default=None),
        Key("unit", default=""),
        Key("lacks", "lacks_text", default=""),
    ),
    Suggestion: ("kind", "what", Key("solvable", sources.solvable, default=True), "length", "names"),
    Link: ("instance", "atom", Key("needed_by", "needed_by_text")),
    AffordanceResult: (
        Key("task", "task.name"),
        Key("domain", "task.domain.name"),
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


RESULT_KEYS: Keys = (
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
    Key("law", sources.breaches),
)

IMITATION_KEYS: Keys = (
    "shown",
    Key("instances", keys=(Key("instance", "name"), "block", "start", "end", "slots", "targets")),
    Key("unexplained", "segmentation.unexplained"),
    "roles",
    "primitives",
    Key("result", "run", keys=(Key("schema", sources.result_schema), *RESULT_KEYS)),
)

KEYS: Mapping[type, Keys] = {
    **QUESTION_KEYS,
    PlanOutcome: (
        Key("task", "task.name"),
        Key("domain", "task.domain.name"),
        "status",
        "planner",
        Key("seed", "task.seed"),
        Key("objective", sources.objective, default="length"),
        "makespan",
        "cost",
        Key("actions", sources.actions),
        "steps",
        "network",
        "explanation",
        Key("refinement", sources.refined, default=None, keys=REFINEMENT_KEYS),
    ),
    PlannerFigures: (
        "name",
        "seconds",
        Key("way", default=""),
        Key("proven_shortest", default=False),
        Key("stages", default=dict),
    ),
    Step: ("index", "start", "end", Key("blocks", "instances")),
    PlannedNetwork: (
        "blocks",
        Key("edges", sources.edges),
        Key("tokens", default=list),
        Key("reduced_from", default=None),
        Key("expanded_with", default=list),
    ),
    Exclusion: (
        Key("block", "instance.block"),
        Key("roles", "instance.roles"),
        Key("where", "shortfall.where"),
        Key("atom", "shortfall.atom"),
        Key("margin", "shortfall.margin"),
        Key("unit", "shortfall.unit"),
    ),
    Value: (Key("violation", nullable=True), Key("value", nullable=True)),
    Milestone: ("evaluations", Key("violation", nullable=True), Key("value", nullable=True)),
    Tuned: (
        *("instance", "name", "unit", "lower", "upper", "default", "value", "status"),
        Key("moves", sources.moves),
        "apart",
    ),
    Retuning: (
        Key("before", sources.before),
        Key("best", sources.best),
        "evaluations",
        "seconds",
        "stopped",
        "history",
    ),
    RunResult: RESULT_KEYS,
    ImitationResult: IMITATION_KEYS,
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

TEXTS: Mapping[type, Callable[[Any], str]] = {Atom: lambda atom: atom.text, PlannedAction: lambda action: action.text}
"""Values that are shown as text."""

DOCUMENTS: Mapping[str, type] = {
    "plan-1": PlanOutcome,
    "result-1": RunResult,
    "explain-1": TaskExplanation,
    "affordances-1": AffordanceResult,
    "probe-1": MembershipResult,
    "imitate-1": ImitationResult,
}
"""File stem of a JSON Schema to the result that is shown."""
