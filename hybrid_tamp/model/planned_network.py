"""The reassignment network that was used for planning, and how the network was reduced and extended."""

from collections.abc import Iterable
from dataclasses import dataclass

from hybrid_tamp.model.network import SlotName
from hybrid_tamp.model.task import Task


@dataclass(frozen=True)
class WholeNetwork:
    """Size of the whole task, before blocks and tokens were omitted for planning.

    Attributes:
        blocks: number of blocks of the whole domain.
        edges: number of edges of the whole network.
        tokens: number of tokens of the whole task.
        blocks_left_out: names of the omitted blocks, sorted.
        tokens_left_out: names of the omitted tokens, sorted. Omitted tokens rest during the whole plan.
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
        token: name of the object.
        classes: names of the object's classes.
        blocks: names of the blocks with a slot that only this object can fill, sorted.
        why: reason why planning without this object failed.
    """

    token: str
    classes: tuple[str, ...]
    blocks: tuple[str, ...]
    why: str


@dataclass(frozen=True)
class PlannedNetwork:
    """The network that was used for planning.

    Attributes:
        blocks: names of the blocks in the network, sorted.
        edges: edges of the network, as pairs of (source, target).
        tokens: names of the tokens, sorted.
        reduced_from: size of the whole task, or None if no block or token was omitted.
        expanded_with: objects that were added because planning without the objects failed, in the order of addition.
    """

    blocks: tuple[str, ...]
    edges: tuple[tuple[SlotName, SlotName], ...]
    tokens: tuple[str, ...]
    reduced_from: WholeNetwork | None
    expanded_with: tuple[AddedToken, ...]

    @classmethod
    def of(cls, whole: Task, part: Task, added: Iterable[AddedToken] = ()) -> "PlannedNetwork":
        """Return the planned network of `part`, which was reduced from `whole` and extended with added objects."""
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
