"""Sweeping: a hand pushes crumbs over the edge of a table into a tray."""

from typing import ClassVar

import numpy as np

from hybrid_tamp.authoring import ANY, Binding, FloatArray, Kind, Parameter, Predicate, State, Target
from hybrid_tamp.skills import (
    POSE,
    Body,
    Container,
    Surface,
    depth_within,
    distance_to_edge,
    edge_towards,
    get_tokens,
    lies_on,
    make_domain,
    make_pushing,
    make_sliding,
)

BEYOND = 0.1
"""Distance of a sweep beyond the edge [m]. The hand stops earlier, as soon as the crumb falls."""


class Crumb(Body):
    """Bodies that a hand can sweep off a table."""

    name: ClassVar[str] = "CRUMB"


CLEARED = Predicate(
    "cleared",
    (Parameter("crumb", Crumb), Parameter("tray", Container)),
    depth_within,
    unit="m",
    scale=0.01,
    reads={"crumb": ("position",), "tray": POSE},
    kind=Kind.FUNCTIONAL,
    value_of="tray",
    description="{crumb} is in {tray}",
    denial="{crumb} is not in {tray}",
)


def line(binding: Binding, state: State) -> tuple[FloatArray, FloatArray]:
    """Return the direction ``(..., 3)`` of a sweep, across the edge that faces the tray, and its distance [m]."""
    crumb, table, tray = get_tokens(binding, "object", "table", "tray")
    normal, half = edge_towards(state, table, state[tray, "position"])
    return normal, np.maximum(distance_to_edge(state, crumb, table, normal, half) + BEYOND, 0.0)


REACHING, SWEEPING = make_pushing(
    "SWEEPING",
    make_sliding(line, "table", "tray"),
    Crumb,
    targets=(Target("table", Surface), Target("tray", Container)),
    effects=(~CLEARED("object", ANY), CLEARED("object", "tray")),
    feasible=(lies_on(Crumb)("object", "table"),),
    description="the hand sweeps the crumb over the edge of the table into the tray",
)
DOMAIN = make_domain("sweeping", (REACHING, SWEEPING), description="a hand sweeps crumbs off a table into a tray")
