"""Explanations of why a task has no plan, which changes make the task solvable, and why a token is in a plan."""

from dataclasses import dataclass, replace
from typing import Literal

from hybrid_tamp.errors import LimitReached
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
    "unreachable",
    "together",
    "class_unknown",
    "forward models",
]


@dataclass(frozen=True)
class Reason:
    """A reason why goal atoms are unreachable.

    Attributes:
        goal: unreachable goal atoms.
        block: name of the block that could achieve the goal atoms. Name of the action if several modes fail. Can be
            empty.
        kind: kind of the reason.
        message: description of the reason.
        atom: condition that fails, or None.
        margin: margin of the condition that fails [unit], or None.
        unit: unit of the margin.
        lacks: class with too few tokens, or slot to which no edge leads, or None.
        probe: pair of (task, token) if the class of the token is unknown but trials can test the class, else None.
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
        """Text of the unreachable goal atoms."""
        return " and ".join(atom.text for atom in self.goal)

    @property
    def atom_text(self) -> str:
        """Text of the failed condition, or empty."""
        return "" if self.atom is None else self.atom.text

    @property
    def lacks_text(self) -> str:
        """Name of the class with too few tokens, or the slot 'BLOCK.slot' to which no edge leads, or empty."""
        if isinstance(self.lacks, tuple):
            return slot_text(self.lacks)
        return "" if self.lacks is None else self.lacks.name


def suggest(length: int, what: str) -> str:
    """Return the sentence that a changed task has a plan with a number of actions."""
    return f"There is a plan of {length} actions with {what}."


@dataclass(frozen=True)
class Suggestion:
    """A single change of the task for which the planner found a plan.

    Attributes:
        change: change of the task.
        length: number of actions in the plan of the changed task.
    """

    change: Change
    length: int

    @property
    def kind(self) -> ChangeKind:
        """Kind of the change."""
        return self.change.kind

    @property
    def text(self) -> str:
        """The change and the length of the plan as a sentence."""
        return suggest(self.length, self.change.what)


@dataclass(frozen=True)
class Explanation(Tabular):
    """The reasons why a task has no plan, and changes that make the task solvable.

    Attributes:
        kind: unsolvable, blocked, safety, not_found, planner_crashed, plan_refused, class_unknown, not_refined, time or
            memory.
        message: sentence that describes the kind.
        reasons: reasons why the task has no plan. Reasons that a suggestion removes come first.
        suggestions: single changes that make the task solvable.
        complete: whether all single changes were examined or the requested number of suggestions was found.
        together: changes that make the task solvable only in combination. Empty if a single change suffices.
        stopped: limit that ended the search for changes, or None.
    """

    kind: str
    message: str
    reasons: tuple[Reason, ...] = ()
    suggestions: tuple[Suggestion, ...] = ()
    complete: bool = False
    together: tuple[Change, ...] = ()
    stopped: LimitReached | None = None

    @property
    def rows(self) -> Rows:
        """Rows of the table that shows the explanation."""
        return [
            ("no plan", self.message),
            ("reasons", [f"{each.goal_text}: {each.message}" for each in self.reasons]),
            ("suggestions", [each.change.what for each in self.suggestions]),
            ("suggested together", self.together_text),
            ("all single changes examined", self.complete),
        ]

    def extended(self, other: "Explanation") -> "Explanation":
        """Return the explanation with the reasons and suggestions of another explanation of the same failure."""
        kept = {each.change.what for each in self.suggestions}
        return replace(
            self,
            reasons=tuple(dict.fromkeys((*self.reasons, *other.reasons))),
            suggestions=(*self.suggestions, *(each for each in other.suggestions if each.change.what not in kept)),
            together=self.together or other.together,
            stopped=self.stopped or other.stopped,
        )

    @property
    def together_text(self) -> tuple[str, ...]:
        """Descriptions of changes that make the task solvable only together. Empty if a single change suffices."""
        return tuple(change.what for change in self.together)

    @property
    def text(self) -> str:
        """Message, reasons and the best suggestion as text, with one line for each."""
        reasons = (f"{each.goal_text}: {each.message}" for each in self.reasons)
        lines = [*reasons, *(each.text for each in self.suggestions[:1])]
        return "\n".join([self.message, *(f"  {line}" for line in lines)])


@dataclass(frozen=True)
class Link:
    """A causal link of a plan, from an instance with an effect to an instance or goal that needs this effect.

    Attributes:
        instance: name of the instance that has the effect.
        atom: effect of the instance.
        needed_by: name of the instance that has the effect as an entry condition, or None if the effect is a goal atom.
    """

    instance: str
    atom: Atom
    needed_by: str | None

    @property
    def needed_by_text(self) -> str:
        """Name of the instance that needs the effect, or 'the goal'."""
        return self.needed_by or "the goal"


@dataclass(frozen=True)
class Cause:
    """The reason why a token is or is not in a plan.

    Attributes:
        token: name of the token.
        used: whether the token is in a slot or target of an instance that the goal needs.
        why: reason in a sentence.
        links: causal links from the token's instances. Links to the goal come first.
    """

    token: str
    used: bool
    why: str
    links: tuple[Link, ...]


@dataclass(frozen=True)
class TaskExplanation(Tabular):
    """The explanation of a task's plan, or of the reasons why the task has no plan.

    Attributes:
        task: task that was explained.
        status: outcome of planning the task.
        explanation: reasons why there is no plan. None if there is a plan.
        tokens: reasons why each token is or is not in the plan. Empty if there is no plan.
        excluded: bindings that were excluded because no hyperparameters satisfy their conditions.
    """

    task: Task
    status: Literal["solved", "unsolvable", "unknown", "limit"]
    explanation: Explanation | None
    tokens: tuple[Cause, ...] = ()
    excluded: tuple[str, ...] = ()

    @property
    def rows(self) -> Rows:
        """Rows of the table that shows the explanation."""
        explained = [] if self.explanation is None else self.explanation.rows
        return [("task", self.task.name), ("status", self.status), *explained, *((c.token, c.why) for c in self.tokens)]
