"""Rolling and tumbling (paper, Sec. III-A, Figs. 2 and 3): hands move heavy objects in a controlled manner.

Modules of rolling, in reading order: `classes`, `geometry`, `predicates`, `resistance`, `rolling` (D1).
Modules of tumbling, in reading order: `faces`, `turning_hands`, `tumbling_geometry`, `standing`, `sliding`, `edges`,
`tumbling_predicates`, `control_predicates`, `turning`, `tipping` (D2 to D4), `curves`, `detours`,
`reaching_around` (D5).
`hybrid_tamp.skills` provides RESTING (D6), WITHDRAWING and, for rolling, REACHING (D5). `probing_rolling` and
`probing_tumbling` test whether new objects can be rolled and tumbled.
"""

from hybrid_tamp.authoring import Domain, ReassignmentNetwork
from hybrid_tamp.skills import GIVING_WAY, RESTING, WITHDRAWING, TurningEndEffector, find_classes, find_predicates

from .metrics import CONTROLLED, metrics
from .probing_rolling import TRY_ROLLING
from .probing_tumbling import TRY_TUMBLING
from .reaching_around import REACH_AWAY, REACH_BESIDE
from .rolling import REACH_BEHIND, ROLLING
from .tipping import TILTING, TIPPING

_BLOCKS = (REACH_BEHIND, REACH_BESIDE, REACH_AWAY, *TIPPING, TILTING, ROLLING, WITHDRAWING, RESTING)
_EDGES = (
    ("RESTING.token", "REACHING.hand"),
    ("REACHING.hand", "RESTING.token"),
    *GIVING_WAY,
    # A hand rolls an object.
    ("REACHING:behind.hand", "ROLLING.hand"),
    ("RESTING.token", "ROLLING.object"),
    ("ROLLING.hand", "REACHING:behind.hand"),
    ("ROLLING.hand", "RESTING.token"),
    ("ROLLING.object", "RESTING.token"),
    # Hands tip a box over an edge, tilt the box back so that a hand can move, and lower the box onto another face.
    ("RESTING.token", "TIPPING:opposite.object"),
    ("TIPPING:opposite.object", "TILTING.object"),
    ("TIPPING:opposite.object", "TIPPING:lower.object"),
    ("TILTING.object", "TIPPING:adjacent.object"),
    ("TIPPING:adjacent.object", "TILTING.object"),
    ("TILTING.object", "TIPPING:lower.object"),
    ("TIPPING:lower.object", "RESTING.token"),
    # If a box leans on one hand, this hand alone holds the box. Every other hand comes from REACHING.
    ("REACHING:beside.hand", "TIPPING:opposite.first"),
    ("REACHING:beside.hand", "TIPPING:opposite.second"),
    ("REACHING:beside.hand", "TIPPING:adjacent.first"),
    ("REACHING:beside.hand", "TIPPING:lower.first"),
    ("REACHING:beside.hand", "TIPPING:lower.second"),
    ("TIPPING:opposite.second", "TILTING.hand"),
    ("TIPPING:adjacent.first", "TILTING.hand"),
    ("TILTING.hand", "TIPPING:adjacent.second"),
    ("TILTING.hand", "TIPPING:lower.first"),
    # A hand leaves a box only through REACHING, because a resting hand would block the descent of the box.
    # A hand on which the box does not lean can move directly to its next face.
    ("TIPPING:opposite.first", "REACHING:beside.hand"),
    ("TIPPING:adjacent.second", "REACHING:beside.hand"),
    ("TIPPING.first", "REACHING:away.hand"),
    ("TIPPING.second", "REACHING:away.hand"),
    ("TILTING.hand", "REACHING:away.hand"),
)
"""Reassignments (paper, Fig. 2). If an edge names an action without a mode, it applies to all modes of the action."""

DOMAIN = Domain(
    name="rolling_tumbling",
    classes=(*find_classes(_BLOCKS), TurningEndEffector),
    predicates=find_predicates(_BLOCKS),
    blocks=_BLOCKS,
    network=ReassignmentNetwork(_EDGES, [block.name for block in _BLOCKS]),
    metrics=metrics,
    bounds=CONTROLLED,
    trials=(TRY_ROLLING, TRY_TUMBLING),
    description="hands roll and tumble heavy objects without letting them fall",
)
