"""Rolling and tumbling (paper, Sec. III-A, Figs. 2 and 3): hands move heavy objects in a controlled manner.

For rolling read the modules in this order: `classes`, `geometry` (directions and places), `predicates`, `rolling` (D1).
For tumbling: `faces` (faces and postures of a box), `tumbling_geometry`, `standing`, `tumbling_predicates`, `tipping`
(D2 to D4, with `turning`, how two hands turn a box), `reaching_around` (D5, with `detours`, curves around a box).
REACHING to roll (D5) and RESTING (D6) come from `..common`. `probing_rolling` and `probing_tumbling` test membership.
"""

from hybrid_tamp.authoring import Domain, ReassignmentNetwork

from ..common.classes import Region, StaticEndEffector
from ..common.predicates import AT_REST
from ..common.reaching import reaching
from ..common.resting import RESTING
from .classes import Rollable, Tumblable
from .metrics import metrics
from .predicates import BEHIND, IN_WORKSPACE, INSIDE, LIES_ON_SIDE, ON_ROLLING_LINE, WITHIN_WORKSPACE
from .probing_rolling import TRY_ROLLING
from .probing_tumbling import TRY_TUMBLING
from .reaching_around import REACH_AWAY, REACH_BESIDE
from .rolling import REACH_BEHIND, ROLLING
from .tipping import TILTING, TIPPING
from .tumbling_predicates import TUMBLING_PREDICATES

_BLOCKS = (reaching(REACH_BEHIND, "behind"), REACH_BESIDE, REACH_AWAY, *TIPPING, TILTING, ROLLING, RESTING)
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
    # hands: the one over which the box leans holds it, the other one comes to its place through REACHING
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
"""Reassignments (paper, Fig. 2); an edge that names an action alone holds for each of its modes."""

DOMAIN = Domain(
    name="rolling_tumbling",
    classes=(StaticEndEffector, Rollable, Tumblable, Region),
    disjoint=((StaticEndEffector, Rollable), (StaticEndEffector, Tumblable)),
    predicates=(
        AT_REST,
        INSIDE,
        BEHIND,
        LIES_ON_SIDE,
        ON_ROLLING_LINE,
        WITHIN_WORKSPACE,
        IN_WORKSPACE,
        *TUMBLING_PREDICATES,
    ),
    blocks=_BLOCKS,
    network=ReassignmentNetwork(_EDGES, [block.name for block in _BLOCKS]),
    metrics=metrics,
    trials=(TRY_ROLLING, TRY_TUMBLING),
    description="hands roll and tumble heavy objects in a controlled manner",
)
