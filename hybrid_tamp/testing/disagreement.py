"""Differences between what a domain declares and what rollouts of its blocks show."""

from collections.abc import Iterable
from dataclasses import dataclass

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.predicate import Binding, Predicate, name_of


@dataclass(frozen=True)
class Disagreement:
    """A declaration of a domain that a rollout refutes, or that is missing.

    Attributes:
        kind: kind of the declaration: ``entry``, ``exit``, ``keeps``, ``fixed``, ``bound``, ``ends``,
            ``invariant`` or ``batch`` (see `check_domain`).
        block: name of the block that was rolled out.
        binding: pairs of (role, token or symbol) of the rollout, sorted. Empty if all bindings are meant.
        declared: the declaration, e.g. a condition over roles.
        measured: what the rollout shows instead.
    """

    kind: str
    block: str
    binding: tuple[tuple[str, str], ...]
    declared: str
    measured: str

    def __str__(self) -> str:
        bound = ", ".join(f"{role}={name}" for role, name in self.binding)
        return f"{self.block}({bound}): {self.kind}: {self.declared}: {self.measured}"


class Disagreements:
    """A collection of disagreements, with at most one disagreement for each kind, block and declaration."""

    def __init__(self) -> None:
        self._found: dict[tuple[str, str, str], Disagreement] = {}

    def add(self, kind: str, block: Block, binding: Binding, declared: str, measured: str) -> None:
        """Add a disagreement, unless another disagreement has the same kind, block and declaration."""
        names = tuple(sorted((role, name_of(value)) for role, value in binding.items()))
        self._found.setdefault((kind, block.name, declared), Disagreement(kind, block.name, names, declared, measured))

    def all(self) -> list[Disagreement]:
        """Return the disagreements in the order in which they were found."""
        return list(self._found.values())


def with_unit(value: float, predicate: Predicate) -> str:
    """Return a margin of a predicate as text with its unit."""
    return f"{value:.4g}" if predicate.unit == "1" else f"{value:.4g} {predicate.unit}"


def atom_text(predicate: Predicate, values: Iterable[object]) -> str:
    """Return an atom as text, e.g. ``inside(drum, goal)``."""
    names = (value if isinstance(value, str) else getattr(value, "name", str(value)) for value in values)
    return f"{predicate.name}({', '.join(names)})"
