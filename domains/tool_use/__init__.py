"""Tool use (paper, Sec. III-B, Figs. 4 to 6): a hand grasps a hammer, and pushes and strikes objects with it.

Modules, in reading order: `classes`, `geometry`, `swing`, `predicates`, `feasibility`, `carrying` (D10), `pushing`
(D9), `arc`, `striking` (D8). `hybrid_tamp.skills` provides REACHING (D5), RESTING (D6), GRASPING (D7), RELEASING (D11).
"""

from hybrid_tamp.authoring import Domain, ReassignmentNetwork
from hybrid_tamp.skills import RESTING, Graspable, find_classes, find_predicates, make_grasping

from .carrying import CARRYING
from .classes import Pushable, Strikable
from .metrics import metrics
from .predicates import GRIP, STANDS
from .pushing import PUSHING
from .striking import STRIKING

REACHING, GRASPING, RELEASING = make_grasping(GRIP, STANDS("tool"))
_BLOCKS = (REACHING, GRASPING, *CARRYING, PUSHING, STRIKING, RELEASING, RESTING)
_EDGES = (
    ("RESTING.token", "REACHING.hand"),
    ("REACHING.hand", "RESTING.token"),
    # A hand grasps a tool and releases it.
    ("REACHING:handle.hand", "GRASPING.hand"),
    ("RESTING.token", "GRASPING.tool"),
    ("CARRYING:down.hand", "RELEASING.hand"),
    ("CARRYING:down.tool", "RELEASING.tool"),
    ("RELEASING.hand", "RESTING.token"),
    ("RELEASING.tool", "RESTING.token"),
    # The hand carries the tool to the place of its next use.
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
    # The tool pushes and strikes objects.
    ("RESTING.token", "PUSHING.object"),
    ("PUSHING.object", "RESTING.token"),
    ("RESTING.token", "STRIKING.object"),
    ("STRIKING.object", "RESTING.token"),
)
"""Reassignments (paper, Fig. 4). If an edge names an action without a mode, it applies to all modes of the action."""

DOMAIN = Domain(
    name="tool_use",
    classes=find_classes(_BLOCKS),
    disjoint=((Graspable, Strikable), (Graspable, Pushable)),
    predicates=find_predicates(_BLOCKS),
    blocks=_BLOCKS,
    network=ReassignmentNetwork(_EDGES, [block.name for block in _BLOCKS]),
    metrics=metrics,
    description="a hand grasps tools, and pushes and strikes objects with the tools",
)
