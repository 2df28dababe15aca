"""Rolling and tumbling (paper, Sec. III-A, Figs. 2 and 3): hands move heavy objects in a controlled manner.

The story, in order: `classes` (what rolls), `geometry` (where a roll goes), `predicates`, `rolling` (D1), and here
the network. REACHING (D5) and RESTING (D6) come from `..common`. Tumbling is in the making: see `whole`.
"""

from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.network import ReassignmentNetwork

from ..common.classes import Region, StaticEndEffector
from ..common.predicates import AT_REST
from ..common.reaching import reaching
from ..common.resting import RESTING
from .classes import Rollable
from .metrics import metrics
from .predicates import BEHIND, IN_WORKSPACE, INSIDE, LIES_ON_SIDE, ON_ROLLING_LINE, WITHIN_WORKSPACE
from .rolling import REACH_BEHIND, ROLLING

DOMAIN = Domain(
    name="rolling_tumbling",
    classes=(StaticEndEffector, Rollable, Region),
    disjoint=((StaticEndEffector, Rollable),),
    predicates=(AT_REST, INSIDE, BEHIND, LIES_ON_SIDE, ON_ROLLING_LINE, WITHIN_WORKSPACE, IN_WORKSPACE),
    blocks=(reaching(REACH_BEHIND), ROLLING, RESTING),
    network=ReassignmentNetwork(
        [
            ("RESTING.token", "REACHING.hand"),
            ("REACHING.hand", "RESTING.token"),
            ("REACHING.hand", "ROLLING.hand"),
            ("RESTING.token", "ROLLING.object"),
            ("ROLLING.hand", "REACHING.hand"),
            ("ROLLING.hand", "RESTING.token"),
            ("ROLLING.object", "RESTING.token"),
        ]
    ),
    metrics=metrics,
    description="hands roll and tumble heavy objects in a controlled manner",
)
