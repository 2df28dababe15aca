"""Rolling and tumbling (paper, Sec. III-A, Figs. 2 and 3): hands move heavy objects in a controlled manner.

The story of rolling, in order: `classes` (what rolls, what tumbles), `geometry` (where a roll goes), `predicates`,
`rolling` (D1). The story of tumbling: `faces` (faces and postures of a box), `tumbling_geometry`,
`tumbling_predicates`, `tipping` (D2 and D4, with `turning`, how two hands turn a box), `tilting` (D3), `standing_by`
(D5, with `detours`, curves round a box). Both share `network` (Fig. 2). REACHING to roll (D5) and RESTING (D6) come
from `..common`. How membership is tried is in `probing_rolling` and `probing_tumbling`.
"""

from hybrid_tamp.authoring import Domain

from ..common.classes import Region, StaticEndEffector
from ..common.predicates import AT_REST
from ..common.reaching import reaching
from ..common.resting import RESTING
from .classes import Rollable, Tumblable
from .metrics import metrics
from .network import network
from .predicates import BEHIND, IN_WORKSPACE, INSIDE, LIES_ON_SIDE, ON_ROLLING_LINE, WITHIN_WORKSPACE
from .probing_rolling import TRY_ROLLING
from .probing_tumbling import TRY_TUMBLING
from .rolling import REACH_BEHIND, ROLLING
from .standing_by import REACH_AWAY, REACH_BESIDE
from .tilting import TILTING
from .tipping import TIPPING
from .tumbling_predicates import TUMBLING_PREDICATES

_BLOCKS = (reaching(REACH_BEHIND, "behind"), REACH_BESIDE, REACH_AWAY, *TIPPING, TILTING, ROLLING, RESTING)

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
    network=network(_BLOCKS),
    metrics=metrics,
    trials=(TRY_ROLLING, TRY_TUMBLING),
    description="hands roll and tumble heavy objects in a controlled manner",
)
