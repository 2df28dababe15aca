"""Single changes of a task, as values.

`questions.changes.apply_change` makes the changed task. Two changes are equal if they make the same task.
"""

from dataclasses import dataclass, field
from typing import ClassVar, Literal

from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.network import SlotName, slot_text
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.token import Token

ChangeKind = Literal["token", "class", "edge", "fact", "property"]


class _Described:
    """A change that is described by the names of its objects and by a phrase."""

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the token, class, slots, atom or property that changes."""
        return self._description()[0]

    @property
    def what(self) -> str:
        """The change in words."""
        return self._description()[1]

    def _description(self) -> tuple[tuple[str, ...], str]:
        raise NotImplementedError


@dataclass(frozen=True)
class CopyToken(_Described):
    """One more token like an existing one.

    Attributes:
        like: the token that is copied.
        across_from: the token on whose other side the copy is; None if the copy is beside the original.
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
    """A token of a class that has no members yet; it satisfies every feasibility fact."""

    kind: ClassVar[ChangeKind] = "token"
    object_class: type[ObjectClass]

    def _description(self) -> tuple[tuple[str, ...], str]:
        name = self.object_class.name
        return (name,), f"a token of class {name} that satisfies every feasibility fact"


@dataclass(frozen=True)
class JoinClass(_Described):
    """A token becomes a member of one more class."""

    kind: ClassVar[ChangeKind] = "class"
    token: Token
    object_class: type[ObjectClass]

    def _description(self) -> tuple[tuple[str, ...], str]:
        names = (self.token.name, self.object_class.name)
        return names, "{} as a member of {}".format(*names)


@dataclass(frozen=True)
class AddEdge(_Described):
    """One more edge of the reassignment network."""

    kind: ClassVar[ChangeKind] = "edge"
    source: SlotName
    target: SlotName

    def _description(self) -> tuple[tuple[str, ...], str]:
        names = (slot_text(self.source), slot_text(self.target))
        return names, "an edge {} -> {} of the network".format(*names)


@dataclass(frozen=True)
class GrantFact(_Described):
    """A feasibility fact holds or fails as needed, whatever its margin is.

    Attributes:
        atom: the fact; its sign says whether it has to hold.
        shortfall: the amount by which it fails, as text with its unit.
    """

    kind: ClassVar[ChangeKind] = "fact"
    atom: Atom
    shortfall: str = field(compare=False)

    def _description(self) -> tuple[tuple[str, ...], str]:
        return (self.atom.text,), f"{self.atom.text} as a fact, which fails by {self.shortfall}"


@dataclass(frozen=True)
class SetProperty(_Described):
    """A fixed property of a token has another value.

    Attributes:
        name: name of the token.
        label: the property, e.g. ``force``, or a component of it, e.g. ``workspace_upper.x``.
        value: the new value [unit].
        before: the old value [unit].
        unit: its unit.
        token: the token with the new value.
        atom: the feasibility fact that holds with the new value.
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
        values = f"at {self.value:.4g}{unit} instead of {self.before:.4g}"
        return (self.name, self.label, self.atom.text), f"{self.label.replace('.', ', ')} of {self.name} {values}"


Change = CopyToken | IdealToken | JoinClass | AddEdge | GrantFact | SetProperty
"""One change of a task."""
