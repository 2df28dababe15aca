"""Affordances: which object affords which block, to whom, and what one token more or less would change."""

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
        agents: to whom; empty in the environment's perspective.
        object: name of the object.
        block: name of the block.
        slot: the slot that the object can be in.
        witness: role to token or symbol, of one choice under which it does; empty if classes alone decide.
    """

    agents: tuple[str, ...]
    object: str
    block: str
    slot: str
    witness: Mapping[str, str]

    @property
    def key(self) -> tuple[tuple[str, ...], str, str, str]:
        """What it says, whatever the witness is."""
        return (self.agents, self.object, self.block, self.slot)


@dataclass(frozen=True)
class Implication:
    """What an agent seen acting implies for one with the same capability classes.

    Attributes:
        affordance: what the agent that was seen is afforded.
        observer: the agent with the same capability classes.
        witness: how the observer can do the same; empty if a feasibility fact fails.
    """

    affordance: Affordance
    observer: str
    witness: Mapping[str, str]

    @property
    def seen(self) -> str:
        """The agent that was seen."""
        return self.affordance.agents[0]

    @property
    def holds(self) -> bool:
        """Whether the observer's own tokens meet the feasibility facts."""
        return bool(self.witness)


@dataclass(frozen=True)
class WhatIf:
    """What is gained and lost by one token more or less.

    Attributes:
        question: ``+CLASS`` or ``-TOKEN``.
        gained: affordances with the change only.
        lost: affordances without the change only.
    """

    question: str
    gained: tuple[Affordance, ...]
    lost: tuple[Affordance, ...]


@dataclass(frozen=True)
class AffordanceResult(Tabular):
    """Which object of a task affords which block in a perspective, and what each question changes.

    Attributes:
        task: the task.
        view: the perspective.
        affordances: what is afforded.
        implied: what follows for like agents, in the observer's perspective.
        what_if: an answer for each question.
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
