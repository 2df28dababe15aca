"""Affordances: which object affords which block to whom, and the effect of one more or one fewer token."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from hybrid_tamp.model.tables import Rows, Tabular
from hybrid_tamp.model.task import Task

View = Literal["environment", "agent", "observer", "team"]
"""Whose perspective is taken (paper, Sec. II-E)."""


@dataclass(frozen=True)
class Affordance:
    """An object affords a block.

    Attributes:
        agents: the agents that can act; empty in the environment's perspective.
        object: name of the object.
        block: name of the block.
        slot: the slot that the object can fill.
        witness: role to token or symbol, one feasible binding; empty if classes alone decide.
    """

    agents: tuple[str, ...]
    object: str
    block: str
    slot: str
    witness: Mapping[str, str]

    @property
    def key(self) -> tuple[tuple[str, ...], str, str, str]:
        """All attributes but the witness."""
        return (self.agents, self.object, self.block, self.slot)


@dataclass(frozen=True)
class Implication:
    """An affordance that an observed agent implies for another agent with the same capability classes.

    Attributes:
        affordance: the affordance of the observed agent.
        observer: the agent with the same capability classes.
        witness: role to token or symbol, a feasible binding of the observer; empty if a feasibility fact fails.
    """

    affordance: Affordance
    observer: str
    witness: Mapping[str, str]

    @property
    def seen(self) -> str:
        """The observed agent."""
        return self.affordance.agents[0]

    @property
    def holds(self) -> bool:
        """Whether the observer's own tokens meet the feasibility facts."""
        return bool(self.witness)


@dataclass(frozen=True)
class WhatIf:
    """The affordances gained and lost by one more or one fewer token.

    Attributes:
        question: ``+CLASS`` or ``-TOKEN``.
        gained: affordances only with the change.
        lost: affordances only without the change.
    """

    question: str
    gained: tuple[Affordance, ...]
    lost: tuple[Affordance, ...]


@dataclass(frozen=True)
class AffordanceResult(Tabular):
    """The affordances of a task in a perspective, and the answers to what-if questions.

    Attributes:
        task: the task.
        view: the perspective.
        affordances: the affordances.
        implied: affordances implied for observers, in the observer's perspective.
        what_if: one answer to each question.
    """

    task: Task
    view: View
    affordances: tuple[Affordance, ...]
    implied: tuple[Implication, ...] = ()
    what_if: tuple[WhatIf, ...] = ()

    @property
    def rows(self) -> Rows:
        """The affordances as a table."""
        affordances = [f"{each.object}: {each.block}.{each.slot}" for each in self.affordances]
        return [("task", self.task.name), ("view", self.view), ("affordances", affordances)]
