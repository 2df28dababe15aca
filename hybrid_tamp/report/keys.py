"""The keys of the JSON documents. The tables list each dataclass whose keys differ from its fields."""

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
        source: source of the value, which is the path of an attribute or a function of the whole object. The default is
            the attribute of the same name.
        default: value if a document lacks the key. A type stands for an empty object of the type. A key without a
            default is required.
        nullable: whether the value may be null, which stands for a number that is not finite.
        keys: keys of the value, if the value's keys differ from the keys in `KEYS`.
    """

    name: str
    source: str | Callable[[Any], Any] = ""
    default: Any = ...
    nullable: bool = False
    keys: "Keys | None" = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "source", self.source or self.name)


Keys = tuple[str | Key, ...]
"""The ordered keys of an object. A string names both the key and the attribute."""


def _of(attribute: str, *names: str) -> Keys:
    """Return a key for each name. The value of the key ``name`` is ``attribute.name``."""
    return tuple(Key(name, f"{attribute}.{name}") for name in names)


_TASK: Keys = (Key("task", "task.name"), Key("domain", "task.domain.name"))
_PLANNED_PAIR: Keys = ("instance", "moving", "other", "distance", Key("margin", default=0.0), "time", "points")
_MEASURED_PAIR: Keys = ("instance", "moving", "other", "distance", Key("margin", default=0.0), "measured")
_GOAL: Keys = ("atom", Key("margin", "measured"), "holds")

_REFINEMENT: Keys = (
    *_of("refinement", "optimiser", "evaluations", "seconds", "stopped", "best", "defaults", "apart"),
    *_of("refinement", "hyperparameters", "performance", "history"),
    Key("objective", "task.midlevel.objective", default="performance"),
    Key("rounds", "excluded"),
    Key("physics", "refinement.physics", default=None),
)

QUESTION_KEYS: Mapping[type, Keys] = {
    TaskExplanation: (*_TASK, "status", "explanation", "tokens", "excluded"),
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
        Key("message", sources.message),
        Key("atom", "atom_text", default=""),
        Key("margin", default=None),
        Key("unit", default=""),
        Key("lacks", "lacks_text", default=""),
    ),
    Suggestion: (
        "kind",
        Key("what", "change.what"),
        Key("solvable", sources.solvable, default=True),
        "length",
        Key("names", "change.names"),
    ),
    Link: ("instance", "atom", Key("needed_by", "needed_by_text")),
    AffordanceResult: (*_TASK, "view", *_of("task", "agents"), "affordances", "implied", "what_if"),
    Implication: ("seen", "observer", *_of("affordance", "object", "block", "slot"), "holds", "witness"),
    MembershipResult: ("task", "token", "seed", Key("resting_faces", "resting"), Key("classes", "verdicts")),
    Verdict: (
        Key("class", "object_class"),
        *("verdict", "likelihood", "labelled", "residual", "properties", "contacts"),
        *("successes", "trials", "interval", "obstacle"),
    ),
}
"""Maps each dataclass of an answer to the dataclass's keys."""

_RESULT: Keys = (
    Key("task", "task.name"),
    "success",
    Key("goal", "recording.goal", keys=_GOAL),
    "blocks",
    "replans",
    "metrics",
    Key("out_of_bounds", sources.out_of_bounds, default=list),
    Key("sim_seconds", "recording.duration"),
    "wall_seconds",
    *_of("task", "seed"),
    *_of("recording", "backend"),
    "versions",
    *_of("recording", "failure"),
    "performance",
    Key("law", sources.breaches),
    Key("comparison", default=list),
    Key("clearance", "closest_pairs", default=list, keys=_MEASURED_PAIR),
    Key("collisions", sources.collisions, default=list),
)

_IMITATION: Keys = (
    "shown",
    Key("instances", keys=(Key("instance", "name"), "block", "start", "end", "slots", "targets")),
    *_of("segmentation", "unexplained"),
    "roles",
    "primitives",
    Key("result", "run", keys=(Key("schema", sources.result_schema), *_RESULT)),
)

KEYS: Mapping[type, Keys] = {
    **QUESTION_KEYS,
    PlanOutcome: (
        *_TASK,
        "status",
        "planner",
        *_of("task", "seed"),
        Key("objective", sources.objective, default="length"),
        "makespan",
        "cost",
        Key("actions", sources.actions),
        "steps",
        Key("order", default=list),
        Key("clearance", "closest_pairs", default=list, keys=_PLANNED_PAIR),
        "network",
        "explanation",
        Key("refinement", sources.refined, default=None, keys=_REFINEMENT),
    ),
    PlannerFigures: (
        "name",
        "seconds",
        Key("way", default=""),
        Key("proven_shortest", sources.proven_shortest, default=False),
        Key("fewest", default=None),
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
    Exclusion: (*_of("instance", "block", "roles"), *_of("shortfall", "where", "atom", "margin", "unit")),
    Value: (Key("violation", nullable=True), Key("value", nullable=True)),
    Milestone: ("evaluations", Key("violation", nullable=True), Key("value", nullable=True)),
    Tuned: (
        *("instance", "name", "unit", "lower", "upper", "default", "value", "status"),
        Key("moves", sources.moves),
        "apart",
    ),
    Retuning: (
        *(Key("before", sources.before), Key("best", sources.best)),
        *("evaluations", "seconds", "stopped", "history"),
    ),
    RunResult: _RESULT,
    ImitationResult: _IMITATION,
    AtomMargin: ("atom", "predicted", "measured", "holds"),
    ExecutedInstance: (Key("instance", "instance.name"), *_of("instance", "start", "end"), Key("exit", "exits")),
    Performance: (
        *("instance", "measure", "unit", "weight"),
        Key("predicted", "figure", nullable=True),
        Key("measured", default=None),
    ),
    BlockInstance: (
        Key("block", "action"),
        "mode",
        Key("instance", "name"),
        "slots",
        "targets",
        "hyperparameters",
        Key("path", default=list),
    ),
}
"""Maps each dataclass to the dataclass's keys. In all other dataclasses, every field is a key."""

TEXTS: Mapping[type, Callable[[Any], str]] = {Atom: lambda atom: atom.text, PlannedAction: lambda action: action.text}
"""Maps each class whose instances are shown as text to the function that returns the text."""

DOCUMENTS: Mapping[str, type] = {
    "plan-1": PlanOutcome,
    "result-1": RunResult,
    "explain-1": TaskExplanation,
    "affordances-1": AffordanceResult,
    "probe-1": MembershipResult,
    "imitate-1": ImitationResult,
}
"""Maps the file stem of each JSON Schema to the class of the described result."""
