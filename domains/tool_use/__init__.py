"""Tool use (paper, Sec. III-B, Figs. 4 to 6): a hand grasps a hammer to push and to strike with it.

The story, in order: `classes` (what grasps, what is grasped, pushed and struck), `geometry` (where a tool is held and
used), `holding` (hand and tool as one body), `swing` (the closed form of a strike), `predicates`, `feasibility`, then
one module a block: `grasping` (D7), `carrying` (D10), `pushing` (D9), `striking` (D8, with `arc`, the way of its swing)
and `releasing` (D11), and `network` (Fig. 4). REACHING (D5) and RESTING (D6) come from `..common`.
"""

from hybrid_tamp.authoring import Domain

from ..common.classes import Region, StaticEndEffector
from ..common.predicates import AT_REST
from ..common.reaching import reaching
from ..common.resting import RESTING
from .carrying import CARRYING
from .classes import DexterousHand, Graspable, Pushable, Pusher, Strikable, Striker
from .feasibility import FEASIBLE
from .grasping import GRASPING, REACH_HANDLE
from .metrics import metrics
from .network import network
from .predicates import CHANGING
from .pushing import PUSHING
from .releasing import RELEASING
from .striking import STRIKING

_BLOCKS = (reaching(REACH_HANDLE, "handle"), GRASPING, *CARRYING, PUSHING, STRIKING, RELEASING, RESTING)

DOMAIN = Domain(
    name="tool_use",
    classes=(StaticEndEffector, DexterousHand, Graspable, Striker, Pusher, Strikable, Pushable, Region),
    disjoint=((StaticEndEffector, Graspable, Strikable), (StaticEndEffector, Graspable, Pushable)),
    predicates=(AT_REST, *CHANGING, *FEASIBLE),
    blocks=_BLOCKS,
    network=network(_BLOCKS),
    metrics=metrics,
    description="a hand grasps tools, pushes and strikes with them",
)
