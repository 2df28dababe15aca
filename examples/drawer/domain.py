"""Drawers: a hand reaches into a drawer from above and pulls the drawer open by its front."""

from dataclasses import replace
from typing import ClassVar

import numpy as np

from hybrid_tamp.authoring import Binding, FloatArray, Parameter, Predicate, State, Target, Token, quantity, rotate
from hybrid_tamp.skills import (
    POSE,
    UP,
    Body,
    Surface,
    extent,
    get_tokens,
    height_below,
    make_domain,
    make_pushing,
    make_sliding,
    to_body,
)

BEYOND, ABOVE_BOTTOM = 0.01, 0.03
"""Distance of a pull beyond the opening, and height of the hand above the lowest point of the drawer [m]."""


class Drawer(Body):
    """Boxes without a lid that slide along the x axis of their body frame."""

    name: ClassVar[str] = "DRAWER"

    wall: float = quantity("m", "thickness of the front", gt=0, le=1)
    opening: float = quantity("m", "distance from the middle of the cabinet at which the drawer is open", gt=0, le=10)


def extension(state: State, drawer: Token, cabinet: Token) -> FloatArray:
    """Return the distance ``(...)`` [m] of a drawer from the middle of its cabinet, beyond its opening."""
    return to_body(state, cabinet, state[drawer, "position"] - state[cabinet, "position"])[..., 0] - drawer["opening"]


OPEN = Predicate(
    "open",
    (Parameter("drawer", Drawer), Parameter("cabinet", Surface)),
    extension,
    unit="m",
    scale=0.01,
    reads={"drawer": ("position",), "cabinet": POSE},
    description="{drawer} of {cabinet} is open",
    denial="{drawer} of {cabinet} is not open",
)


def line(binding: Binding, state: State) -> tuple[FloatArray, FloatArray]:
    """Return the direction ``(..., 3)`` in which the drawer opens, and the distance ``(...)`` [m] to pull."""
    drawer, cabinet = get_tokens(binding, "object", "cabinet")
    outward = rotate(state[cabinet, "orientation"], np.array([1.0, 0.0, 0.0]))
    return outward, np.maximum(BEYOND - extension(state, drawer, cabinet), 0.0)


def touching(binding: Binding, state: State, direction: FloatArray) -> FloatArray:
    """Return the distance ``(...)`` [m] from the hand to the middle of the drawer when the hand touches the front."""
    hand, drawer = get_tokens(binding, "hand", "object")
    return np.asarray(extent(state, hand, direction) + drawer["wall"] - extent(state, drawer, direction))


def beside(binding: Binding, state: State) -> FloatArray:
    """Return the point ``(..., 3)`` [m] that the hand follows, above the bottom of the drawer."""
    hand, drawer = get_tokens(binding, "hand", "object")
    up = height_below(state, hand) + ABOVE_BOTTOM - height_below(state, drawer)
    return np.asarray(state[drawer, "position"] + up[..., None] * UP)


PULL = replace(make_sliding(line, "cabinet"), touching=touching, beside=beside, ground=None, steered=False)
TARGETS, EFFECTS = (Target("cabinet", Surface),), (OPEN("object", "cabinet"),)
BLOCKS = make_pushing("PULLING", PULL, Drawer, TARGETS, EFFECTS)
DOMAIN = make_domain("drawers", BLOCKS, description="a hand pulls drawers open")
