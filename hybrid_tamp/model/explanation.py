"""Explanations: why a task has no plan, which changes give it one, and why each token is in a plan."""

from dataclasses import dataclass
from typing import Literal

from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.change import Change, ChangeKind
from hybrid_tamp.model.network import SlotName, slot_text
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.tables import Rows, Tabular
from hybrid_tamp.model.task import Task

ReasonKind = Literal[
    "no_block",
    "no_token",
    "too_few_tokens",
    "no_edge",
    "not_feasible",
    "together",
    "class_unknown",
    "forward models",
]


@dataclass(frozen=True)
class Reason:
    """One reason why goal atoms are unreachable.

    Attributes:
        goal: the goal atoms.
        block: the block that would achieve them, or empty; the name of the action if several modes fail.
        kind: the kind of the reason.
        message: the reason in words.
        atom: the failing condition, or None.
        margin: its margin, or None.
        unit: unit of the margin.
        lacks: the class with too few tokens, or the slot to which no edge leads; or None.
        probe: the task file or task, and the token, of a probe that would settle the reason; or None.
    """

    goal: tuple[Atom, ...]
    block: str
    kind: ReasonKind
    message: str
    atom: Atom | None = None
    margin: float | None = None
    unit: str = ""
    lacks: type[ObjectClass] | SlotName | None = None
    probe: tuple[str, str] | None = None

    @property
    def goal_text(self) -> str:
        """The goal atoms as text."""
        return " and ".join(atom.text for atom in self.goal)

    @property
    def atom_text(self) -> str:
        """The failing condition as text, empty if there is none."""
        return "" if self.atom is None else self.atom.text

    @property
    def lacks_text(self) -> str:
        """The class with too few tokens, or the slot 'BLOCK.slot' to which no edge leads; or empty."""
        if isinstance(self.lacks, tuple):
            return slot_text(self.lacks)
        return "" if self.lacks is None else self.lacks.name


@dataclass(frozen=True)
class Suggestion:
    """A single change that gives the task a plan; the changed task was planned.

    Attributes:
        change: the change.
        length: the number of actions of the plan that was found.
    """

    change: Change
    length: int

    @property
    def kind(self) -> ChangeKind:
        """The kind of the change."""
        return self.change.kind


@dataclass(frozen=True)
class Explanation(Tabular):
    """Why a task has no plan, and which changes give it one.

    Attributes:
        kind: unsolvable, not_found, planner_crashed, plan_refused, class_unknown, not_refined, time or memory.
        message: the same in a sentence.
        reasons: the reasons; those that a suggestion removes come first.
        suggestions: single changes that give the task a plan.
        complete: whether every single change was examined, or the requested number of changes was found.
        together: changes that give the task a plan only together; empty if a single one suffices.
    """

    kind: str
    message: str
    reasons: tuple[Reason, ...] = ()
    suggestions: tuple[Suggestion, ...] = ()
    complete: bool = False
    together: tuple[Change, ...] = ()

    @property
    def rows(self) -> Rows:
        """The explanation as a table."""
        return [
            ("no plan", self.message),
            ("reasons", [f"{each.goal_text}: {each.message}" for each in self.reasons]),
            ("suggestions", [each.change.what for each in self.suggestions]),
            ("suggested together", self.together_text),
            ("all single changes examined", self.complete),
        ]

    @property
    def together_text(self) -> tuple[str, ...]:
        """Changes that give the task a plan only together, in words; empty if a single one suffices."""
        return tuple(change.what for change in self.together)

    @property
    def text(self) -> str:
        """The message and the reasons, one line each."""
        return "\n".join([self.message, *(f"  {each.goal_text}: {each.message}" for each in self.reasons)])


@dataclass(frozen=True)
class Link:
    """One causal link of a plan: an effect and its consumer.

    Attributes:
        instance: the instance that has the effect.
        atom: the effect.
        needed_by: the instance that has the atom as an entry condition, or None if it is a goal atom.
    """

    instance: str
    atom: Atom
    needed_by: str | None

    @property
    def needed_by_text(self) -> str:
        """The instance that needs it, or 'the goal'."""
        return self.needed_by or "the goal"


@dataclass(frozen=True)
class Cause:
    """Why a token is in a plan, or why it is not.

    Attributes:
        token: name of the token.
        used: whether it is in a slot or a target of an instance that the goal needs.
        why: the reason in a sentence.
        links: the links of its instances, those of the goal first.
    """

    token: str
    used: bool
    why: str
    links: tuple[Link, ...]


@dataclass(frozen=True)
class TaskExplanation(Tabular):
    """Why a task has its plan, or why it has none.

    Attributes:
        task: the task.
        status: the status of planning it.
        explanation: why there is no plan; None if there is one.
        tokens: why each token is in the plan; empty if there is none.
    """

    task: Task
    status: Literal["solved", "unsolvable", "unknown", "limit"]
    explanation: Explanation | None
    tokens: tuple[Cause, ...] = ()

    @property
    def rows(self) -> Rows:
        """The explanation as a table."""
        explained = [] if self.explanation is None else self.explanation.rows
        return [("task", self.task.name), ("status", self.status), *explained, *((c.token, c.why) for c in self.tokens)]
