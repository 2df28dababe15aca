"""Joint lifting (paper, Sec. II-E): several hands together lift an object that is too heavy for fewer hands.

Modules, in reading order: `places`, `classes`, `load`, `predicates`, `bearing`, `together`, `lifting` (LIFTING, HOLDING
and LOWERING), `carrying` (CARRYING). `hybrid_tamp.skills` provides REACHING (D5), RESTING (D6)
and WITHDRAWING.
"""

from collections.abc import Iterator

from hybrid_tamp.authoring import Binding, Domain, FloatArray, ReassignmentNetwork, State, Target
from hybrid_tamp.skills import (
    GIVING_WAY,
    RESTING,
    WITHDRAWING,
    ReachGoal,
    TurningEndEffector,
    conditions,
    find_classes,
    find_predicates,
    get_symbol,
    get_token,
    get_tokens,
    make_reaching,
)

from .carrying import carrying
from .classes import Liftable
from .lifting import holding, lifting, lowering
from .metrics import CONTROLLED, metrics
from .places import PLACE, VERTICAL, place_at, places_of
from .predicates import AT_PLACE, FITS, STANDS, UPRIGHT, WITHIN_REACH
from .together import MODES


def _beside(binding: Binding, state: State) -> FloatArray:
    hand, thing = get_tokens(binding, "hand", "object")
    return place_at(state, hand, thing, get_symbol(binding, "place"))


def _upright(binding: Binding, state: State) -> FloatArray:
    return VERTICAL.orientation(state, get_token(binding, "hand"))


def _edges() -> Iterator[tuple[str, str]]:
    """Yield the edges of the network. If an edge names an action without a mode, it applies to all modes of the action.

    A lifted box and its hands move to the next block together, and the mode stays the same.
    """
    yield from (("RESTING.token", "REACHING.hand"), ("REACHING.hand", "RESTING.token"), *GIVING_WAY)
    yield from (("RESTING.token", "LIFTING.object"), ("LOWERING.object", "RESTING.token"))
    for mode, crew in MODES.items():
        hands = [slot for slot, _ in places_of(crew)]
        yield from ((f"LIFTING:{mode}.{slot}", f"HOLDING:{mode}.{slot}") for slot in (*hands, "object"))
        yield from ((f"LIFTING:{mode}.{slot}", f"CARRYING:{mode}.{slot}") for slot in (*hands, "object"))
        for held in ("HOLDING", "CARRYING"):
            yield from ((f"{held}:{mode}.{slot}", f"LOWERING:{mode}.{slot}") for slot in (*hands, "object"))
        yield from (("REACHING.hand", f"LIFTING:{mode}.{slot}") for slot in hands)
        yield from ((f"LOWERING:{mode}.{slot}", "REACHING.hand") for slot in hands)
        yield from ((f"LOWERING:{mode}.{slot}", "RESTING.token") for slot in hands)


_BESIDE = ReachGoal(
    targets=(Target("object", Liftable), Target("place", PLACE)),
    position=_beside,
    orientation=_upright,
    entry=conditions((STANDS, UPRIGHT, WITHIN_REACH, FITS)),
    arrived=conditions((AT_PLACE,)),
    lasting=conditions((STANDS,)),
)
_BEARING = tuple(make(mode) for make in (lifting, holding, carrying, lowering) for mode in MODES)
_BLOCKS = (make_reaching(_BESIDE, "place"), *_BEARING, WITHDRAWING, RESTING)

DOMAIN = Domain(
    name="joint_lifting",
    classes=(*find_classes(_BLOCKS), TurningEndEffector),
    predicates=find_predicates(_BLOCKS),
    blocks=_BLOCKS,
    network=ReassignmentNetwork(_edges(), [block.name for block in _BLOCKS]),
    metrics=metrics,
    bounds=CONTROLLED,
    description="several hands together lift objects that are too heavy for fewer hands",
)
