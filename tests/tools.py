"""A small domain in which a hand drives nails with tools, and tasks with any number of unrelated objects."""

from collections.abc import Iterable, Mapping
from typing import Any, ClassVar

from serial import RESTING, block, changing, predicate

from hybrid_tamp.model.affordance import AffordanceClass, BasicAction, CapabilityClass, ObjectClass
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.kind import Kind
from hybrid_tamp.model.network import ReassignmentNetwork
from hybrid_tamp.model.predicate import Atom, Predicate
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token


class Hand(CapabilityClass):
    """A hand that the robot moves."""

    name: ClassVar[str] = "HAND"
    basic_actions: ClassVar[tuple[BasicAction, ...]] = (BasicAction("force", 3, "N"),)


class Nail(AffordanceClass):
    """A nail, which only a tool can drive."""

    name: ClassVar[str] = "NAIL"


class Graspable(AffordanceClass):
    """A thing that a hand can take."""

    name: ClassVar[str] = "GRASPABLE"


class Striker(AffordanceClass):
    """A tool that drives nails."""

    name: ClassVar[str] = "STRIKER"


class Ball(AffordanceClass):
    """A thing that can be pushed: a distractor."""

    name: ClassVar[str] = "BALL"


class Lid(AffordanceClass):
    """A lid on a nail, which only its own tool can remove."""

    name: ClassVar[str] = "LID"


class Lever(AffordanceClass):
    """A tool that removes lids."""

    name: ClassVar[str] = "LEVER"


DRIVEN = changing("driven", Nail)
BARE = predicate("bare", Nail, holds=lambda nail: "covered" not in nail)
HEAVY = predicate("heavy_enough", Striker, Nail, holds=lambda tool, _: "light" not in tool, kind=Kind.STATIC)
HELD = changing("held", Graspable, Hand, kind=Kind.MAINTAINED)
PUSHED = changing("pushed", Ball)

BLOCKS: tuple[Block, ...] = (
    block("PUSHING", {"hand": Hand, "ball": Ball}, (), [PUSHED("ball")]),
    block("GRASPING", {"hand": Hand, "tool": Graspable}, (), [HELD("tool", "hand")], hold=True),
    block(
        "DRIVING",
        {"hand": Hand, "tool": Striker, "nail": Nail},
        [BARE("nail"), HEAVY("tool", "nail")],
        [DRIVEN("nail")],
    ),
    block("LEVERING", {"hand": Hand, "tool": Lever}, (), [BARE("nail")], {"nail": Nail, "lid": Lid}),
)
EDGES = (
    ("RESTING.token", "PUSHING.hand"),
    ("RESTING.token", "PUSHING.ball"),
    ("PUSHING.hand", "RESTING.token"),
    ("PUSHING.ball", "RESTING.token"),
    ("RESTING.token", "GRASPING.hand"),
    ("RESTING.token", "GRASPING.tool"),
    ("GRASPING.hand", "DRIVING.hand"),
    ("GRASPING.tool", "DRIVING.tool"),
    ("GRASPING.hand", "LEVERING.hand"),
    ("GRASPING.tool", "LEVERING.tool"),
    ("RESTING.token", "DRIVING.nail"),
    ("DRIVING.nail", "RESTING.token"),
    ("DRIVING.hand", "RESTING.token"),
    ("DRIVING.tool", "RESTING.token"),
    ("LEVERING.hand", "RESTING.token"),
    ("LEVERING.tool", "RESTING.token"),
)
CLASSES = (Hand, Nail, Graspable, Striker, Ball, Lid, Lever)


def unrelated(number: int) -> tuple[type[ObjectClass], Block, Predicate]:
    """Return a class unrelated to nails, a block for its members, and a predicate over pairs of them."""
    made: type[ObjectClass] = type(f"Odd{number}", (AffordanceClass,), {"name": f"ODD-{number}", "__module__": "tools"})
    near = changing(f"near-{number}", made, made)
    pushed = changing(f"moved-{number}", made)
    return made, block(f"ODD-{number}-MOVING", {"hand": Hand, "thing": made}, (), [pushed("thing")]), near


def domain(others: int = 0) -> Domain:
    """Return the domain of nails with this number of unrelated classes and blocks."""
    more = [unrelated(number) for number in range(others)]
    blocks = [made for _, made, _ in more]
    edges = [
        edge
        for made in blocks
        for slot in ("hand", "thing")
        for edge in ((f"{made.name}.{slot}", "RESTING.token"), ("RESTING.token", f"{made.name}.{slot}"))
    ]
    return Domain(
        name="nails",
        classes=(*CLASSES, *(made for made, _, _ in more)),
        predicates=(
            *(DRIVEN, BARE, HEAVY, HELD, PUSHED),
            *(near for _, _, near in more),
            *(literal.predicate for made in blocks for literal in made.exit),
        ),
        blocks=(RESTING, *BLOCKS, *blocks),
        network=ReassignmentNetwork([*EDGES, *edges]),
    )


DOMAIN = domain()
HAMMER: tuple[type[ObjectClass], ...] = (Graspable, Striker)
CROWBAR: tuple[type[ObjectClass], ...] = (Graspable, Lever)


def task(
    things: Mapping[str, Iterable[type[ObjectClass]]],
    goal: str = "nail",
    of: Domain = DOMAIN,
    places: Mapping[str, tuple[float, float, float]] | None = None,
    **changes: Any,
) -> Task:
    """Return a task with a nail, a hand, and `things` with their classes. By default, a thing is 1 m away."""
    classes = {"hand": (Hand,), goal: (Nail,), **things}
    tokens = [Token.make(name, list(members), {}) for name, members in classes.items()]
    where = {(name, "position"): (1.0, 0.0, 0.0) for name in things}
    where |= {(name, "position"): place for name, place in (places or {}).items()}
    state = State.of(tokens, where)
    return Task("nails", of, tuple(tokens), state, (Atom("driven", (goal,)),), {"robot": ("hand",)}).replaced(**changes)
