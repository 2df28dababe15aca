"""The reassignment network of joint lifting: hands come to a box, lift it, hold it, set it down and let it go."""

from collections.abc import Iterable, Iterator

from hybrid_tamp.authoring import Block, ReassignmentNetwork

from .bearing import places_of
from .lifting import MODES

_EDGES = (
    ("RESTING.token", "REACHING.hand"),
    ("REACHING.hand", "RESTING.token"),
    ("RESTING.token", "LIFTING.object"),
    ("LOWERING.object", "RESTING.token"),
)


def network(blocks: Iterable[Block]) -> ReassignmentNetwork:
    """Return the network over the blocks; an edge that names an action alone holds for each of its modes.

    A box in the air is passed on whole, with all its hands, in the mode in which it was lifted.
    """
    return ReassignmentNetwork((*_EDGES, *_of_modes()), [block.name for block in blocks])


def _of_modes() -> Iterator[tuple[str, str]]:
    for mode, crew in MODES.items():
        hands = [slot for slot, _ in places_of(crew)]
        yield from ((f"LIFTING:{mode}.{slot}", f"HOLDING:{mode}.{slot}") for slot in (*hands, "object"))
        yield from ((f"HOLDING:{mode}.{slot}", f"LOWERING:{mode}.{slot}") for slot in (*hands, "object"))
        yield from (("REACHING.hand", f"LIFTING:{mode}.{slot}") for slot in hands)
        yield from ((f"LOWERING:{mode}.{slot}", "REACHING.hand") for slot in hands)
        yield from ((f"LOWERING:{mode}.{slot}", "RESTING.token") for slot in hands)
