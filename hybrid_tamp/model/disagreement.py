"""Mistakes in a domain: differences between what a domain declares and what rollouts of its blocks show."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Disagreement:
    """A mistake in a domain: a declaration that a rollout refutes, a missing declaration, or a faulty function.

    Attributes:
        kind: kind of the mistake (see `hybrid_tamp.testing.KINDS`).
        block: name of the block with the mistake.
        binding: pairs of (role, token or symbol) of the rollout, sorted. Empty if all bindings are meant.
        declared: the declaration, e.g. a condition over roles.
        measured: what the check found instead, with figures and units.
        role: the slot, target or hyperparameter with the mistake.
        remedy: how to correct the mistake.
    """

    kind: str
    block: str
    binding: tuple[tuple[str, str], ...]
    declared: str
    measured: str
    role: str = ""
    remedy: str = ""

    def __str__(self) -> str:
        bound = ", ".join(f"{role}={name}" for role, name in self.binding)
        return f"{self.block}({bound}): {self.kind}: {self.declared}: {self.measured}; {self.remedy}"


@dataclass(frozen=True)
class DomainReport:
    """The mistakes that the check of a domain found with one or more tasks.

    Attributes:
        domain: name of the domain.
        tasks: names of the tasks with which the domain was checked.
        blocks: number of blocks of the domain.
        mistakes: the mistakes, each with the first task that shows the mistake.
    """

    domain: str
    tasks: tuple[str, ...]
    blocks: int
    mistakes: tuple[tuple[str, Disagreement], ...]
