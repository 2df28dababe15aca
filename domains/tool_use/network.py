"""The reassignment network of tool use (paper, Fig. 4)."""

from collections.abc import Iterable

from hybrid_tamp.authoring import Block, ReassignmentNetwork

_EDGES = (
    ("RESTING.token", "REACHING.hand"),
    ("REACHING.hand", "RESTING.token"),
    # a hand takes a tool and lets it go
    ("REACHING:handle.hand", "GRASPING.hand"),
    ("RESTING.token", "GRASPING.tool"),
    ("CARRYING:down.hand", "RELEASING.hand"),
    ("CARRYING:down.tool", "RELEASING.tool"),
    ("RELEASING.hand", "RESTING.token"),
    ("RELEASING.tool", "RESTING.token"),
    # with the tool from use to use
    ("GRASPING.hand", "CARRYING.hand"),
    ("GRASPING.tool", "CARRYING.tool"),
    ("PUSHING.hand", "CARRYING.hand"),
    ("PUSHING.tool", "CARRYING.tool"),
    ("STRIKING.hand", "CARRYING.hand"),
    ("STRIKING.tool", "CARRYING.tool"),
    ("CARRYING:push.hand", "PUSHING.hand"),
    ("CARRYING:push.tool", "PUSHING.tool"),
    ("CARRYING:strike.hand", "STRIKING.hand"),
    ("CARRYING:strike.tool", "STRIKING.tool"),
    # what is pushed and struck
    ("RESTING.token", "PUSHING.object"),
    ("PUSHING.object", "RESTING.token"),
    ("RESTING.token", "STRIKING.object"),
    ("STRIKING.object", "RESTING.token"),
)


def network(blocks: Iterable[Block]) -> ReassignmentNetwork:
    """Return the network over the blocks; an edge that names an action alone holds for each of its modes."""
    return ReassignmentNetwork(_EDGES, [block.name for block in blocks])
