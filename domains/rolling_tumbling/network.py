"""The reassignment network of rolling and tumbling (paper, Fig. 2)."""

from collections.abc import Iterable

from hybrid_tamp.authoring import Block, ReassignmentNetwork

_EDGES = (
    ("RESTING.token", "REACHING.hand"),
    ("REACHING.hand", "RESTING.token"),
    # rolling
    ("REACHING:behind.hand", "ROLLING.hand"),
    ("RESTING.token", "ROLLING.object"),
    ("ROLLING.hand", "REACHING:behind.hand"),
    ("ROLLING.hand", "RESTING.token"),
    ("ROLLING.object", "RESTING.token"),
    # a box: from rest over an edge, back and forth while hands change, down on another face
    ("RESTING.token", "TIPPING:opposite.object"),
    ("TIPPING:opposite.object", "TILTING.object"),
    ("TIPPING:opposite.object", "TIPPING:lower.object"),
    ("TILTING.object", "TIPPING:adjacent.object"),
    ("TIPPING:adjacent.object", "TILTING.object"),
    ("TILTING.object", "TIPPING:lower.object"),
    ("TIPPING:lower.object", "RESTING.token"),
    # hands: the one over which the box leans goes on holding it, the other one comes to its place through REACHING
    ("REACHING:beside.hand", "TIPPING:opposite.first"),
    ("REACHING:beside.hand", "TIPPING:opposite.second"),
    ("REACHING:beside.hand", "TIPPING:adjacent.first"),
    ("REACHING:beside.hand", "TIPPING:lower.first"),
    ("REACHING:beside.hand", "TIPPING:lower.second"),
    ("TIPPING:opposite.second", "TILTING.hand"),
    ("TIPPING:adjacent.first", "TILTING.hand"),
    ("TILTING.hand", "TIPPING:adjacent.second"),
    ("TILTING.hand", "TIPPING:lower.first"),
    # A hand leaves a box through REACHING only: resting where it is, it would be in the way as the box comes down.
    # The hand on which the box does not lean goes straight to its next face.
    ("TIPPING:opposite.first", "REACHING:beside.hand"),
    ("TIPPING:adjacent.second", "REACHING:beside.hand"),
    ("TIPPING.first", "REACHING:away.hand"),
    ("TIPPING.second", "REACHING:away.hand"),
    ("TILTING.hand", "REACHING:away.hand"),
)


def network(blocks: Iterable[Block]) -> ReassignmentNetwork:
    """Return the network over the blocks; an edge that names an action alone holds for each of its modes."""
    return ReassignmentNetwork(_EDGES, [block.name for block in blocks])
