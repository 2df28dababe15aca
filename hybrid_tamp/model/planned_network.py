"""The network that a task was planned on, the task that it was reduced from, and the objects that were added."""

from collections.abc import Iterable
from dataclasses import dataclass

from hybrid_tamp.model.network import SlotName
from hybrid_tamp.model.task import Task


@dataclass(frozen=True)
class WholeNetwork:
    """The task from which a network was reduced.

    Attributes:
        blocks: number of blocks of the domain.
        edges: number of edges of its network.
        tokens: number of tokens of the task.
        blocks_left_out: names of the omitted blocks, sorted.
        tokens_left_out: names of the omitted tokens, sorted; all but places rest during the whole plan.
    """

    blocks: int
    edges: int
    tokens: int
    blocks_left_out: tuple[str, ...]
    tokens_left_out: tuple[str, ...]


@dataclass(frozen=True)
class AddedToken:
    """An object that was added to the network as a tool.

    Attributes:
        token: its name.
        classes: the names of its classes.
        blocks: names of the blocks whose slots can be filled only with it, sorted.
        why: why planning without it failed.
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
        tokens: names of its tokens, sorted.
        reduced_from: the task that it was reduced from, or None if nothing was omitted.
        expanded_with: objects that were added because there was no plan without them, in order.
    """

    blocks: tuple[str, ...]
    edges: tuple[tuple[SlotName, SlotName], ...]
    tokens: tuple[str, ...]
    reduced_from: WholeNetwork | None
    expanded_with: tuple[AddedToken, ...]

    @classmethod
    def of(cls, whole: Task, part: Task, added: Iterable[AddedToken] = ()) -> "PlannedNetwork":
        """Return the network of a reduced task.

        Args:
            whole: the task.
            part: the reduced task.
            added: the objects that were added.
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
