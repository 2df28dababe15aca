"""Small tasks for tests: hands, drums and regions of the domain rolling_tumbling."""

import math
from collections.abc import Sequence

from hybrid_tamp_domains.rolling_tumbling import DOMAIN
from hybrid_tamp_domains.rolling_tumbling.classes import Rollable

from hybrid_tamp.geometry.shapes import Cylinder
from hybrid_tamp.model.plan import PlannedAction
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.skills import Region, StaticEndEffector

HAND = {
    "radius": 0.035,
    "length": 0.16,
    "mass": 1.5,
    "maximal_force": 300.0,
    "workspace_lower": (-1.5, -1.5, 0.0),
    "workspace_upper": (2.5, 2.5, 1.2),
}
DRUM = {"axis_of_rotation": (0.0, 0.0, 1.0), "radius_of_rotation": 0.1, "mass": 5.0, "friction": 0.6}
LYING = (math.sin(math.pi / 4), 0.0, 0.0, math.cos(math.pi / 4))
"""Rotation of the body's z axis to the world's -y axis, so that the drum rolls along x."""


def rolling_task(
    hands: int = 1,
    drums: Sequence[tuple[float, float]] = ((0.0, 0.0),),
    regions: Sequence[tuple[float, float]] = ((0.7, 0.0),),
    goal: Sequence[tuple[int, int]] = ((0, 0),),
) -> Task:
    """Return a task. `goal` contains pairs of (number of the drum, number of its region)."""
    tokens: list[Token] = []
    state: dict[tuple[str, str], tuple[float, ...]] = {}
    for number in range(hands):
        tokens.append(Token.make(f"hand {number}", [StaticEndEffector], HAND))
        state[f"hand {number}", "position"] = (0.25, -0.45 - 0.2 * number, 0.3)
    for number, (x, y) in enumerate(drums):
        shape = Cylinder(kind="cylinder", radius=0.1, length=0.3)
        tokens.append(Token.make(f"drum {number}", [Rollable], DRUM, shape))
        state[f"drum {number}", "position"] = (x, y, 0.1)
        state[f"drum {number}", "orientation"] = LYING
    for number, (x, y) in enumerate(regions):
        tokens.append(Token.make(f"region {number}", [Region], {"radius": 0.02}))
        state[f"region {number}", "position"] = (x, y, 0.0)
    atoms = tuple(Atom("inside", (f"drum {drum}", f"region {region}")) for drum, region in goal)
    return Task("rolling", DOMAIN, tuple(tokens), State.of(tokens, state), atoms)


def reach_and_roll(hand: str, drum: str, region: str, source: str = "no-region-of-inside") -> list[PlannedAction]:
    """Return the PDDL actions by which a hand rolls a drum to a region and rests."""
    return [
        PlannedAction("begin-reaching-behind-from-resting", (hand, drum, region, "none-reading", "n1")),
        PlannedAction("fill-rolling-hand-from-reaching-behind", (hand, drum, region, "n1", "none-reading")),
        PlannedAction("begin-rolling-from-resting", (drum, region, source)),
        PlannedAction("begin-resting-from-rolling", (drum,)),
        PlannedAction("leave-rolling-hand-to-resting", (hand, drum)),
    ]
