"""Tool use (paper, Sec. III-B, Figs. 4 to 6): a hand grasps a hammer to push and to strike with it.

Read the modules in this order: `classes` (hands, tools and things), `geometry` (where a tool is held and used),
`holding` (hand and tool as one body), `swing` (the closed form of a strike), `predicates`, `feasibility`, `grasping`
(GRASPING D7, RELEASING D11), `carrying` (D10), `pushing` (D9) and `striking` (D8, with `arc`, the path of its swing).
REACHING (D5) and RESTING (D6) come from `..common`.
"""

from hybrid_tamp.authoring import Domain, ReassignmentNetwork

from ..common.classes import Region, StaticEndEffector
from ..common.predicates import AT_REST
from ..common.reaching import reaching
from ..common.resting import RESTING
from .carrying import CARRYING
from .classes import DexterousHand, Graspable, Pushable, Pusher, Strikable, Striker
from .feasibility import FEASIBLE
from .grasping import GRASPING, REACH_HANDLE, RELEASING
from .metrics import metrics
from .predicates import CHANGING
from .pushing import PUSHING
from .striking import STRIKING

_BLOCKS = (reaching(REACH_HANDLE, "handle"), GRASPING, *CARRYING, PUSHING, STRIKING, RELEASING, RESTING)
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
"""Reassignments (paper, Fig. 4); an edge that names an action alone holds for each of its modes."""

DOMAIN = Domain(
    name="tool_use",
    classes=(StaticEndEffector, DexterousHand, Graspable, Striker, Pusher, Strikable, Pushable, Region),
    disjoint=((StaticEndEffector, Graspable, Strikable), (StaticEndEffector, Graspable, Pushable)),
    predicates=(AT_REST, *CHANGING, *FEASIBLE),
    blocks=_BLOCKS,
    network=ReassignmentNetwork(_EDGES, [block.name for block in _BLOCKS]),
    metrics=metrics,
    description="a hand grasps tools, pushes and strikes with them",
)
