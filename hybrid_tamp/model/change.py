"""Single changes of a task, as values: what would be different.

`questions.changes.apply_change` makes the changed task. Two changes are equal if they make the same task.
"""

from dataclasses import dataclass, field
from typing import ClassVar, Literal

from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.network import SlotName, slot_text
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.token import Token

ChangeKind = Literal["token", "class", "edge", "fact", "property"]


@dataclass(frozen=True)
class CopyToken:
    """One more token like one that is there.

    Attributes:
        like: the token that is copied.
        across_from: the token on whose other side the copy is; None if it is beside the first one.
    """

    kind: ClassVar[ChangeKind] = "token"
    like: Token
    across_from: Token | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """The names of what it is about."""
        return (self.like.name,) if self.across_from is None else (self.like.name, self.across_from.name)

    @property
    def what(self) -> str:
        """The change in words."""
        own = [member.name for member in self.like.classes if member.model_fields]
        classes = ", ".join(own or [member.name for member in self.like.classes])
        side = "" if self.across_from is None else f" on the other side of {self.across_from.name}"
        return f"one more token like {self.like.name} ({classes}){side}"


@dataclass(frozen=True)
class IdealToken:
    """A token of a class that has no members yet; it meets every feasibility fact that is asked of it."""

    kind: ClassVar[ChangeKind] = "token"
    object_class: type[ObjectClass]

    @property
    def names(self) -> tuple[str, ...]:
        """The names of what it is about."""
        return (self.object_class.name,)

    @property
    def what(self) -> str:
        """The change in words."""
        return f"a token of class {self.object_class.name} that is able to do what is asked of it"


@dataclass(frozen=True)
class JoinClass:
    """A token becomes a member of one more class."""

    kind: ClassVar[ChangeKind] = "class"
    token: Token
    object_class: type[ObjectClass]

    @property
    def names(self) -> tuple[str, ...]:
        """The names of what it is about."""
        return (self.token.name, self.object_class.name)

    @property
    def what(self) -> str:
        """The change in words."""
        return f"{self.token.name} as a member of {self.object_class.name}"


@dataclass(frozen=True)
class AddEdge:
    """One more edge of the reassignment network."""

    kind: ClassVar[ChangeKind] = "edge"
    source: SlotName
    target: SlotName

    @property
    def names(self) -> tuple[str, ...]:
        """The names of what it is about."""
        return (slot_text(self.source), slot_text(self.target))

    @property
    def what(self) -> str:
        """The change in words."""
        return "an edge {} -> {} of the network".format(*self.names)


@dataclass(frozen=True)
class GrantFact:
    """A feasibility fact is as it has to be, whatever its margin is.

    Attributes:
        atom: the fact; its sign says how it has to be.
        shortfall: by how much it fails, as text with its unit.
    """

    kind: ClassVar[ChangeKind] = "fact"
    atom: Atom
    shortfall: str = field(compare=False)

    @property
    def names(self) -> tuple[str, ...]:
        """The names of what it is about."""
        return (self.atom.text,)

    @property
    def what(self) -> str:
        """The change in words."""
        return f"{self.atom.text} as a fact, which fails by {self.shortfall}"


@dataclass(frozen=True)
class SetProperty:
    """A fixed property of a token has another value.

    Attributes:
        name: name of the token.
        label: the property, e.g. ``force``, or a component of it, e.g. ``workspace_upper.x``.
        value: the new value [unit].
        before: the old value [unit].
        unit: its unit.
        token: the token with the new value.
        atom: the feasibility fact that holds then.
    """

    kind: ClassVar[ChangeKind] = "property"
    name: str
    label: str
    value: float
    before: float = field(compare=False)
    unit: str = field(compare=False)
    token: Token = field(compare=False)
    atom: Atom = field(compare=False)

    @property
    def names(self) -> tuple[str, ...]:
        """The names of what it is about."""
        return (self.name, self.label, self.atom.text)

    @property
    def what(self) -> str:
        """The change in words."""
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"{self.label.replace('.', ', ')} of {self.name} at {self.value:.4g}{unit} instead of {self.before:.4g}"


Change = CopyToken | IdealToken | JoinClass | AddEdge | GrantFact | SetProperty
"""One change of a task."""
