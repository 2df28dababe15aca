"""The JSON documents of questions about a task: why is there a plan or none, and what affords what."""

from typing import Any, Literal

from pydantic import Field

from hybrid_tamp.report.entries import Document
from hybrid_tamp.report.plan_entries import ExplanationEntry, model_schemas


class LinkEntry(Document):
    """One link of the causal chain of a plan."""

    instance: str
    atom: str = Field(description="what the instance brings about")
    needed_by: str = Field(description="the instance that asks for it at its beginning, or 'the goal'")


class TokenEntry(Document):
    """Why a token is in the plan, or why it is not."""

    token: str
    used: bool
    why: str
    links: list[LinkEntry]


class ExplainDocument(Document):
    """What `explain --json` prints."""

    schema_: Literal["hybrid-tamp/explain/1"] = Field("hybrid-tamp/explain/1", alias="schema")
    task: str
    domain: str
    status: Literal["solved", "unsolvable", "unknown", "limit"]
    explanation: ExplanationEntry | None = Field(description="why there is no plan; null where there is one")
    tokens: list[TokenEntry] = Field(description="why each token is in the plan; empty where there is none")


class AffordanceEntry(Document):
    """An object affords a block."""

    agents: list[str] = Field(description="to whom; empty in the environment's perspective")
    object: str
    block: str
    slot: str
    witness: dict[str, str] = Field(description="role to token or symbol, of one choice under which it does")


class ImplicationEntry(Document):
    """What an agent seen acting implies for one with the same capability classes."""

    seen: str
    observer: str
    object: str
    block: str
    slot: str
    holds: bool = Field(description="whether the observer's own tokens meet the feasibility facts")
    witness: dict[str, str]


class WhatIfEntry(Document):
    """What is gained and lost by one token more or less."""

    question: str
    gained: list[AffordanceEntry]
    lost: list[AffordanceEntry]


class AffordancesDocument(Document):
    """What `affordances --json` prints."""

    schema_: Literal["hybrid-tamp/affordances/1"] = Field("hybrid-tamp/affordances/1", alias="schema")
    task: str
    domain: str
    view: Literal["environment", "agent", "observer", "team"]
    agents: dict[str, list[str]] = Field(description="agent to its capability tokens")
    affordances: list[AffordanceEntry]
    implied: list[ImplicationEntry] = Field(description="in the observer's perspective")
    what_if: list[WhatIfEntry]


def affordance_schemas() -> dict[str, dict[str, Any]]:
    """Return the JSON Schemas of these documents, file stem to schema."""
    return model_schemas({"explain-1": ExplainDocument, "affordances-1": AffordancesDocument})
