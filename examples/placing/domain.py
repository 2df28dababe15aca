"""Placing: a hand takes a cup by its handle, carries the cup to another surface and sets it down upright."""

from typing import ClassVar

from hybrid_tamp.authoring import ANY, Target
from hybrid_tamp.skills import (
    Graspable,
    Grip,
    Surface,
    make_carrying,
    make_domain,
    make_grasping,
    stand_at,
    stands_on,
)


class Cup(Graspable):
    """Cups, bottles and other bodies that stand upright and have a vertical handle."""

    name: ClassVar[str] = "CUP"


GRIP, STANDS_ON, SURFACE = Grip(thing=Cup), stands_on(Cup), Target("surface", Surface)
REACHING, GRASPING, RELEASING = make_grasping(GRIP, STANDS_ON("object", "surface"), SURFACE)
PLACING = make_carrying(
    "PLACING",
    GRIP,
    stand_at("surface"),
    arrived=(~STANDS_ON("object", ANY), STANDS_ON("object", "surface")),
    targets=(SURFACE,),
    ends=("surface",),
    description="the hand carries the cup to the middle of the surface and sets it down",
)
DOMAIN = make_domain(
    "placing",
    (REACHING, GRASPING, PLACING, RELEASING),
    handed=(GRIP.held,),
    description="a hand takes cups by their handles and sets them down",
)
