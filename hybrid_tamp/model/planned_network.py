"""The network that a task was planned on: what it was reduced from, and the objects that were brought in."""

from collections.abc import Iterable
from dataclasses import dataclass

from hybrid_tamp.model.network import SlotName
from hybrid_tamp.model.task import Task


@dataclass(frozen=True)
class WholeNetwork:
    """The task from which a network was reduced.

    Attributes:
        blocks: how many blocks the domain has.
        edges: how many edges its network has.
        tokens: how many tokens the task has.
        blocks_left_out: names of the blocks that were left out, sorted.
        tokens_left_out: names of the tokens that were left out, sorted; all but places rest all the time.
    """

    blocks: int
    edges: int
    tokens: int
    blocks_left_out: tuple[str, ...]
    tokens_left_out: tuple[str, ...]


@dataclass(frozen=True)
class AddedToken:
    """An object that was brought into the network as a tool.

    Attributes:
        token: its name.
        classes: the names of its classes.
        blocks: names of the blocks that it made fillable, sorted.
        why: what was wrong without it.
    """

    token: str
    classes: tuple[str, ...]
    blocks: tuple[str, ...]
    why: str


@dataclass(frozen=True)
class PlannedNetwork:
    """The network that was planned on.

    Attributes:
        blocks: names of its blocks, sorted.
        edges: its edges, source first.
        tokens: names of the tokens that were planned with, sorted.
        reduced_from: what it was reduced from, or None if nothing was left out.
        expanded_with: objects brought in because there was no plan without them, in their order.
    """

    blocks: tuple[str, ...]
    edges: tuple[tuple[SlotName, SlotName], ...]
    tokens: tuple[str, ...]
    reduced_from: WholeNetwork | None
    expanded_with: tuple[AddedToken, ...]

    @classmethod
    def of(cls, whole: Task, part: Task, added: Iterable[AddedToken] = ()) -> "PlannedNetwork":
        """Return the network of a part of a task.

        Args:
            whole: the task.
            part: what it was reduced to.
            added: the objects that were brought in.
        """
        kept = part.domain.block_by_name
        whole_network = WholeNetwork(
            blocks=len(whole.domain.blocks),
            edges=whole.domain.network.graph.number_of_edges(),
            tokens=len(whole.tokens),
            blocks_left_out=tuple(sorted(whole.domain.block_by_name.keys() - kept.keys())),
            tokens_left_out=tuple(sorted(whole.token_by_name.keys() - part.token_by_name.keys())),
        )
        reduced = whole_network.blocks_left_out or whole_network.tokens_left_out
        edges = tuple(part.domain.network.edges)
        tokens = tuple(sorted(part.token_by_name))
        return cls(tuple(sorted(kept)), edges, tokens, whole_network if reduced else None, tuple(added))
