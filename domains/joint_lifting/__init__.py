"""Joint lifting (paper, Sec. II-E): hands, of one robot or of several, lift together what is too heavy for fewer.

The story, in order: `places` (where hands bear a box), `classes` (what is lifted), `load` (what hands bear by
friction), `predicates`, `bearing` (how hands bear a box between them), `lifting` (LIFTING, HOLDING and LOWERING, by two
hands or by four), and `network`. REACHING (D5) and RESTING (D6) come from `..common`.
"""

from typing import cast

from hybrid_tamp.authoring import Binding, Domain, FloatArray, State, Target, Token

from ..common.classes import StaticEndEffector
from ..common.predicates import AT_REST
from ..common.reaching import ReachGoal, reaching
from ..common.resting import RESTING
from .classes import Liftable
from .lifting import BEARING
from .metrics import metrics
from .network import network
from .places import PLACE, place_at
from .predicates import AT_PLACE, FITS, ON_SIDE, PREDICATES, STANDS, UPRIGHT, WITHIN_REACH


def _beside(binding: Binding, state: State) -> FloatArray:
    hand, thing = cast(Token, binding["hand"]), cast(Token, binding["object"])
    return place_at(state, hand, thing, cast(str, binding["place"]))


_BESIDE = ReachGoal(
    targets=(Target("object", Liftable), Target("place", PLACE)),
    position=_beside,
    entry=(
        STANDS("object"),
        UPRIGHT("hand"),
        ON_SIDE("hand", "object", "place"),
        WITHIN_REACH("hand", "object", "place"),
        FITS("hand", "object", "place"),
    ),
    arrived=(AT_PLACE("hand", "object", "place"),),
)
_BLOCKS = (reaching(_BESIDE, "place"), *BEARING, RESTING)

DOMAIN = Domain(
    name="joint_lifting",
    classes=(StaticEndEffector, Liftable),
    disjoint=((StaticEndEffector, Liftable),),
    predicates=(AT_REST, *PREDICATES),
    blocks=_BLOCKS,
    network=network(_BLOCKS),
    metrics=metrics,
    description="hands lift together what is too heavy for fewer of them",
)
