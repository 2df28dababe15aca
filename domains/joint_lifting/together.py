"""Blocks in which a crew of hands bears a box, and the parts that these blocks share.

Each block has two modes: ``two``, with one hand on each side of the box, and ``four``, with two hands on each side.
"""

from collections.abc import Callable, Sequence
from functools import partial
from itertools import chain
from typing import Any

from hybrid_tamp.authoring import Binding, Block, Hyperparameter, Literal, Predicate, Profile
from hybrid_tamp.skills import conditions, make_pressing, squeezing

from .bearing import PlanMaker, bear, bearing_system, sweep_bearing
from .classes import Liftable
from .load import largest_squeeze, squeeze_for
from .places import Roles, places_of
from .predicates import AT_PLACE, OF_BOX, OF_HAND

MODES = {"two": "two hands", "four": "four hands"}
"""Maps each mode to its crew."""


def _squeezes(crew: str, binding: Binding) -> tuple[float, float, float]:
    """Return the limits of the squeeze [N]. The largest squeeze leaves the hands enough force to bear the box."""
    roles = Roles.of(crew, binding)
    largest = min(largest_squeeze(hand, roles.thing, crew) for hand, _ in roles.hands)
    return 0.0, squeeze_for(roles.thing, crew), largest


def for_each_hand(crew: str, facts: Sequence[Predicate]) -> tuple[Literal, ...]:
    """Return conditions on every hand of a crew, on the place of the hand and on the object."""
    hands = (conditions(facts, hand=slot, place=place, crew=crew) for slot, place in places_of(crew))
    return tuple(chain.from_iterable(hands))


def at_places(crew: str) -> tuple[Literal, ...]:
    """Return the conditions that every hand of a crew is at its place."""
    return tuple(AT_PLACE(slot, "object", place) for slot, place in places_of(crew))


def make_together(
    action: str,
    mode: str,
    before: Sequence[Literal],
    plan: PlanMaker,
    profile: Profile,
    hyperparameters: tuple[Hyperparameter, ...] = (),
    system: Callable[..., Any] = bearing_system,
    **told: Any,
) -> Block:
    """Return one mode of a block in which a crew bears a box.

    Args:
        action: name of the block without the mode.
        mode: the mode.
        before: entry conditions in addition to the places of the hands and to the feasibility facts.
        plan: makes the planned movement.
        profile: profile of the movement.
        hyperparameters: hyperparameters in addition to the squeeze.
        system: ``system(crew, binding, start)`` returns the continuous system.
        **told: further arguments of `make_pressing`.
    """
    crew = MODES[mode]
    return make_pressing(
        f"{action}:{mode}",
        [slot for slot, _ in places_of(crew)],
        Liftable,
        entry=(*before, *at_places(crew), *for_each_hand(crew, OF_HAND), *conditions(OF_BOX)),
        hyperparameters=(squeezing(partial(_squeezes, crew)), *hyperparameters),
        policy=partial(bear, crew, profile, plan),
        sweep=partial(sweep_bearing, crew, profile, plan),
        system=partial(system, crew),
        **told,
    )
