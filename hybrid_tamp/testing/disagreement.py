"""The collection of the mistakes in a domain, and their texts."""

from collections.abc import Iterable

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.disagreement import Disagreement
from hybrid_tamp.model.predicate import Binding, Predicate, name_of
from hybrid_tamp.testing.kinds import KINDS


class Disagreements:
    """A collection of disagreements, with at most one disagreement for each kind, block and declaration."""

    def __init__(self) -> None:
        self._found: dict[tuple[str, str, str], Disagreement] = {}

    def add(
        self, kind: str, block: Block, binding: Binding, declared: str, measured: str, role: str = "", remedy: str = ""
    ) -> None:
        """Add a disagreement, unless another disagreement has the same kind, block and declaration.

        Args:
            kind: kind of the mistake, a key of `KINDS`.
            block: block with the mistake.
            binding: maps each role of the block to its value in the rollout. Empty if all bindings are meant.
            declared: the declaration.
            measured: what the check found instead.
            role: the slot, target or hyperparameter with the mistake. By default the anchor of the block.
            remedy: how to correct the mistake. By default the remedy of the kind.
        """
        names = tuple(sorted((role, name_of(value)) for role, value in binding.items()))
        made = Disagreement(
            kind, block.name, names, declared, measured, role or block.anchor, remedy or KINDS[kind].remedy
        )
        self._found.setdefault((kind, block.name, declared), made)

    def all(self) -> list[Disagreement]:
        """Return the disagreements in the order in which they were found."""
        return list(self._found.values())

    def has(self, kind: str, block: Block) -> bool:
        """Return whether a disagreement of this kind was found in a block."""
        return any(key[:2] == (kind, block.name) for key in self._found)


def first_role(block: Block, arguments: Iterable[str]) -> str:
    """Return the first argument of a condition that is a role of a block, or the anchor of the block."""
    return next((each for each in arguments if each in block.roles), block.anchor)


def with_unit(value: float, predicate: Predicate) -> str:
    """Return a margin of a predicate as text with its unit."""
    return f"{value:.4g}" if predicate.unit == "1" else f"{value:.4g} {predicate.unit}"


def atom_text(predicate: Predicate, values: Iterable[object]) -> str:
    """Return an atom as text, e.g. ``inside(drum, goal)``."""
    names = (value if isinstance(value, str) else getattr(value, "name", str(value)) for value in values)
    return f"{predicate.name}({', '.join(names)})"


def role_of(binding: Binding, values: Iterable[object]) -> str:
    """Return the first role of a binding whose value is one of some values, or an empty string."""
    every = list(values)
    return next((role for role, value in binding.items() if value in every), "")
