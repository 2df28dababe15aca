"""Single changes of a task, as immutable values.

`questions.changes.apply_change` returns the changed task. Two changes are equal if they result in the same task.
"""

from dataclasses import dataclass, field
from typing import ClassVar, Literal

from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.network import SlotName, slot_text
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.token import Token

ChangeKind = Literal["token", "class", "edge", "fact", "property", "safety"]


class _Described:
    """Base class of changes. Names and a phrase describe each change."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the tokens, classes, slots, atoms or properties that the change involves."""
        return self._description()[0]

    @property
    def what(self) -> str:
        """Phrase that describes the change."""
        return self._description()[1]

    def _description(self) -> tuple[tuple[str, ...], str]:
        raise NotImplementedError


@dataclass(frozen=True)
class CopyToken(_Described):
    """Addition of a copy of an existing token.

    Attributes:
        like: token that is copied.
        across_from: token between the original and the copy. None if the copy is beside the original.
    """

    kind: ClassVar[ChangeKind] = "token"
    like: Token
    across_from: Token | None = None

    def _description(self) -> tuple[tuple[str, ...], str]:
        own = [member.name for member in self.like.classes if member.model_fields]
        what = f"one more token like {self.like.name} ({', '.join(own or [each.name for each in self.like.classes])})"
        if self.across_from is None:
            return (self.like.name,), what
        return (self.like.name, self.across_from.name), f"{what} on the other side of {self.across_from.name}"


@dataclass(frozen=True)
class IdealToken(_Described):
    """Addition of a new token of a class that has no members. The new token satisfies every feasibility fact."""

    kind: ClassVar[ChangeKind] = "token"
    object_class: type[ObjectClass]

    def _description(self) -> tuple[tuple[str, ...], str]:
        name = self.object_class.name
        return (name,), f"a token of class {name} that satisfies every feasibility fact"


@dataclass(frozen=True)
class JoinClass(_Described):
    """Addition of an existing token to a class."""

    kind: ClassVar[ChangeKind] = "class"
    token: Token
    object_class: type[ObjectClass]

    def _description(self) -> tuple[tuple[str, ...], str]:
        names = (self.token.name, self.object_class.name)
        return names, "{} as a member of {}".format(*names)


@dataclass(frozen=True)
class AddEdge(_Described):
    """Addition of an edge to the reassignment network."""

    kind: ClassVar[ChangeKind] = "edge"
    source: SlotName
    target: SlotName

    def _description(self) -> tuple[tuple[str, ...], str]:
        names = (slot_text(self.source), slot_text(self.target))
        return names, "an edge {} -> {} of the network".format(*names)


@dataclass(frozen=True)
class GrantFact(_Described):
    """Assumption that a condition on a static predicate holds, although its margin is negative.

    Attributes:
        atom: condition that is assumed to hold. The condition can be negative.
        shortfall: amount by which the condition fails, as text with a unit.
    """

    kind: ClassVar[ChangeKind] = "fact"
    atom: Atom
    shortfall: str = field(compare=False)

    def _description(self) -> tuple[tuple[str, ...], str]:
        return (self.atom.text,), f"{self.atom.text} assumed to hold, although it fails by {self.shortfall}"


@dataclass(frozen=True)
class SetProperty(_Described):
    """Change of a token's fixed property to a new value.

    Attributes:
        name: name of the token.
        label: name of the property, e.g. ``force``, or of a component, e.g. ``workspace_upper.x``.
        value: new value of the property [unit].
        before: old value of the property [unit].
        unit: unit of the property.
        token: token with the new value.
        atom: feasibility fact that holds with the new value.
    """

    kind: ClassVar[ChangeKind] = "property"
    name: str
    label: str
    value: float
    before: float = field(compare=False)
    unit: str = field(compare=False)
    token: Token = field(compare=False)
    atom: Atom = field(compare=False)

    def _description(self) -> tuple[tuple[str, ...], str]:
        unit = "" if self.unit == "1" else f" {self.unit}"
        values = f"set to {self.value:.4g}{unit} instead of {self.before:.4g}{unit}"
        return (self.name, self.label, self.atom.text), f"{self.label.replace('.', ', ')} of {self.name} {values}"


@dataclass(frozen=True)
class SetFactor(_Described):
    """Change of a predicate's safety factor to a lower value.

    Attributes:
        predicate: name of the predicate.
        factor: new safety factor, at least 1.
        before: old safety factor.
        atom: feasibility fact that holds with the new factor.
    """

    kind: ClassVar[ChangeKind] = "safety"
    predicate: str
    factor: float
    before: float = field(compare=False)
    atom: Atom = field(compare=False)

    def _description(self) -> tuple[tuple[str, ...], str]:
        what = f"safety factor of {self.predicate} lowered from {self.before:.4g} to {self.factor:.4g}"
        return (self.predicate, self.atom.text), what


Change = CopyToken | IdealToken | JoinClass | AddEdge | GrantFact | SetProperty | SetFactor
"""A single change of a task."""
