"""Affordances of the objects of a task, and how the affordances change if one token is added or removed."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from hybrid_tamp.model.tables import Rows, Tabular
from hybrid_tamp.model.task import Task

View = Literal["environment", "agent", "observer", "team"]
"""Perspective from which affordances are listed (paper, Sec. II-E)."""


@dataclass(frozen=True)
class Affordance:
    """A block that an object affords to agents.

    Attributes:
        agents: names of the agents that can run the block. Empty in the environment's perspective.
        object: name of the object.
        block: name of the block.
        slot: name of the slot that the object can fill.
        witness: example of a feasible binding, which maps each role to a token or symbol. Empty if only classes are
            considered.
    """

    agents: tuple[str, ...]
    object: str
    block: str
    slot: str
    witness: Mapping[str, str]

    @property
    def key(self) -> tuple[tuple[str, ...], str, str, str]:
        """Tuple of all attributes except the witness."""
        return (self.agents, self.object, self.block, self.slot)


@dataclass(frozen=True)
class Implication:
    """An affordance for an observer, inferred from the affordance for an agent with the same capability classes.

    Attributes:
        affordance: affordance for the observed agent, from which the observer's affordance is inferred.
        observer: name of the observer.
        witness: example of a feasible binding with the observer's tokens. Empty if a feasibility fact fails for them.
    """

    affordance: Affordance
    observer: str
    witness: Mapping[str, str]

    @property
    def seen(self) -> str:
        """Name of the observed agent."""
        return self.affordance.agents[0]

    @property
    def holds(self) -> bool:
        """Whether the observer's own tokens satisfy the feasibility facts."""
        return bool(self.witness)


@dataclass(frozen=True)
class WhatIf:
    """The affordances that the task gains and loses when one token is added or removed.

    Attributes:
        question: change of the task: ``+CLASS`` adds a token of the class and ``-TOKEN`` removes the token.
        gained: affordances that exist only after the change.
        lost: affordances that exist only before the change.
    """

    question: str
    gained: tuple[Affordance, ...]
    lost: tuple[Affordance, ...]


@dataclass(frozen=True)
class AffordanceResult(Tabular):
    """The affordances of a task from one perspective, and the answers to what-if questions.

    Attributes:
        task: task whose affordances are listed.
        view: perspective from which the affordances are listed.
        affordances: affordances of the objects of the task.
        implied: affordances for observers, inferred from observed agents. Empty in all other perspectives.
        what_if: answers to the what-if questions, in the order of the questions.
    """

    task: Task
    view: View
    affordances: tuple[Affordance, ...]
    implied: tuple[Implication, ...] = ()
    what_if: tuple[WhatIf, ...] = ()

    @property
    def rows(self) -> Rows:
        """Rows of the table of affordances."""
        affordances = [f"{each.object}: {each.block}.{each.slot}" for each in self.affordances]
        return [("task", self.task.name), ("view", self.view), ("affordances", affordances)]
