"""The documents of plans and of questions, as pydantic models; their JSON Schemas are published in `schemas/`."""

from collections.abc import Iterable, Mapping
from typing import Any, Literal

from pydantic import Field

from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.report.entries import Document
from hybrid_tamp.report.refinement import RefinementEntry


class InstanceEntry(Document):
    """One block instance within a step."""

    block: str
    mode: str | None
    instance: str
    slots: dict[str, str]
    targets: dict[str, str]
    hyperparameters: dict[str, float]


class StepEntry(Document):
    """A stretch of time in which no token is reassigned; shows where every token is."""

    index: int
    start: float = Field(description="[s]")
    end: float = Field(description="[s]")
    blocks: list[InstanceEntry]


class PlannerEntry(Document):
    """Which engine answered, how long it took, and how the plan was found."""

    name: str
    seconds: float
    way: str = Field("", description="how the plan was found")
    proven_shortest: bool = Field(False, description="whether no plan has a shorter makespan")
    stages: dict[str, float] = Field(default_factory=dict, description="what each stage took [s]")


class WholeEntry(Document):
    """The task that a network was reduced from."""

    blocks: int = Field(description="how many blocks the domain has")
    edges: int = Field(description="how many edges its network has")
    tokens: int = Field(description="how many tokens the task has")
    blocks_left_out: list[str]
    tokens_left_out: list[str] = Field(description="they rest all the time, but for places")


class BroughtEntry(Document):
    """An object that was brought into the network."""

    token: str
    classes: list[str]
    blocks: list[str] = Field(description="blocks that it made fillable")
    why: str


class NetworkEntry(Document):
    """The network that was planned on."""

    blocks: list[str]
    edges: list[list[str]] = Field(description="pairs of 'BLOCK.slot', source first")
    tokens: list[str] = Field(default_factory=list, description="tokens that were planned with")
    reduced_from: WholeEntry | None = Field(None, description="null where nothing was left out")
    expanded_with: list[BroughtEntry] = Field(
        default_factory=list, description="objects brought in because there was no plan without them, in their order"
    )


class ReasonEntry(Document):
    """One reason why there is no plan."""

    goal: str
    block: str
    kind: str
    message: str
    atom: str = ""
    margin: float | None = None
    unit: str = ""
    lacks: str = Field("", description="the class or the slot 'BLOCK.slot' for which there is too little")


class SuggestionEntry(Document):
    """A single change with which there is a plan: it was planned."""

    kind: Literal["token", "class", "edge", "fact", "property"]
    what: str
    solvable: Literal[True] = True
    length: int = Field(description="number of PDDL actions of the plan that was found")
    names: list[str] = Field(description="the token, class, slots, atom or property that it is about")


class ExplanationEntry(Document):
    """Why there is no plan."""

    kind: str = Field(description="unsolvable, not_found, planner_crashed, plan_refused, class_unknown, time or memory")
    message: str
    reasons: list[ReasonEntry]
    suggestions: list[SuggestionEntry] = Field(default_factory=list)
    all_looked_at: bool = Field(False, description="whether no single change beyond the suggestions was left untried")
    together: list[str] = Field(
        default_factory=list, description="changes with which there is a plan if all are made; where no single one does"
    )


class PlanDocument(Document):
    """What `plan --json` prints and `plan.json` holds."""

    schema_: Literal["hybrid-tamp/plan/1"] = Field("hybrid-tamp/plan/1", alias="schema")
    task: str
    domain: str
    status: Literal["solved", "unsolvable", "unknown", "limit"]
    planner: PlannerEntry
    seed: int
    objective: Literal["length", "makespan"] = "length"
    makespan: float | None = Field(description="[s]")
    cost: float | None = Field(description="number of PDDL actions")
    actions: list[str] = Field(description="the PDDL plan, a line each")
    steps: list[StepEntry]
    network: NetworkEntry
    explanation: ExplanationEntry | None
    refinement: RefinementEntry | None = Field(None, description="how hyperparameters were optimised; null if not")


def network_entry(whole: Task, task: Task, brought: Iterable[BroughtEntry] = ()) -> NetworkEntry:
    """Return the network that was planned on as data.

    Args:
        whole: the task.
        task: what it was reduced to.
        brought: the objects that were brought in.
    """
    kept = {block.name for block in task.domain.blocks}
    reduced_from = WholeEntry(
        blocks=len(whole.domain.blocks),
        edges=whole.domain.network.graph.number_of_edges(),
        tokens=len(whole.tokens),
        blocks_left_out=sorted(block.name for block in whole.domain.blocks if block.name not in kept),
        tokens_left_out=sorted(token.name for token in whole.tokens if token.name not in task.token_by_name),
    )
    return NetworkEntry(
        blocks=sorted(kept),
        edges=[[".".join(source), ".".join(target)] for source, target in task.domain.network.edges],
        tokens=sorted(task.token_by_name),
        reduced_from=reduced_from if reduced_from.blocks_left_out or reduced_from.tokens_left_out else None,
        expanded_with=list(brought),
    )


def plan_document(
    task: Task,
    *,
    status: Literal["solved", "unsolvable", "unknown", "limit"],
    planner: PlannerEntry,
    plan: TaskPlan | None,
    network: NetworkEntry,
    explanation: ExplanationEntry | None,
) -> PlanDocument:
    """Return the document of one planning attempt."""
    return PlanDocument(
        task=task.name,
        domain=task.domain.name,
        status=status,
        planner=planner,
        seed=task.seed,
        objective="makespan" if task.objective == "makespan" else "length",
        makespan=plan.makespan if plan else None,
        cost=float(len(plan.actions)) if plan else None,
        actions=[action.text for action in plan.actions] if plan else [],
        steps=steps_of(plan) if plan else [],
        network=network,
        explanation=explanation,
    )


def steps_of(plan: TaskPlan) -> list[StepEntry]:
    """Return the stretches between reassignments, with where every token is in each."""
    return [
        StepEntry(index=s.index, start=s.start, end=s.end, blocks=list(map(_instance, s.instances))) for s in plan.steps
    ]


def _instance(instance: BlockInstance) -> InstanceEntry:
    return InstanceEntry(
        block=instance.action,
        mode=instance.mode,
        instance=instance.name,
        slots=dict(instance.slots),
        targets=dict(instance.targets),
        hyperparameters=dict(instance.hyperparameters),
    )


def model_schemas(documents: Mapping[str, type[Document]]) -> dict[str, dict[str, Any]]:
    """Return the JSON Schemas of documents that are pydantic models, file stem to schema."""
    dialect = {"$schema": "https://json-schema.org/draft/2020-12/schema"}
    found: dict[str, type[Document]] = {"plan-1": PlanDocument, **documents}
    return {stem: dialect | document.model_json_schema(by_alias=True) for stem, document in found.items()}
