"""A small domain for tests: a hand cuts parts with cutters after setting them, and two hands carry parts."""

from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np

from hybrid_tamp.model.affordance import (
    TOKEN,
    AffordanceClass,
    CapabilityClass,
    PlaceClass,
    quantity,
)
from hybrid_tamp.model.block import Block, Duration, Slot, Target
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.kind import Kind
from hybrid_tamp.model.network import ReassignmentNetwork
from hybrid_tamp.model.predicate import Atom, Literal, Parameter, Predicate
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray


class Hand(CapabilityClass):
    """A hand that cuts and carries parts."""

    name: ClassVar[str] = "HAND"
    force: float = quantity("N", "what it can bear", gt=0)


class Part(AffordanceClass):
    """A part to cut and carry."""

    name: ClassVar[str] = "PART"
    weight: float = quantity("N", "weight", gt=0)
    hardness: float = quantity("1", "hardness", gt=0)


class Cutter(AffordanceClass):
    """A cutter for parts that are softer than its edge."""

    name: ClassVar[str] = "CUTTER"
    edge: float = quantity("1", "hardness of its edge", gt=0)


class Station(PlaceClass):
    """A place to carry parts to."""

    name: ClassVar[str] = "STATION"
    load: float = quantity("N", "what it bears", gt=0)


def _at_first(held: float) -> Any:
    return lambda state, *values: np.full(state.values.shape[:-1], held)


def _static(name: str, one: type, other: type, margin: Any, unit: str = "N") -> Predicate:
    def batched(state: State, first: Token, second: Token) -> FloatArray:
        return np.full(state.values.shape[:-1], float(margin(first, second)))

    return Predicate(name, (Parameter("x", one), Parameter("y", other)), batched, unit=unit, kind=Kind.STATIC)


SET = Predicate("set", (Parameter("tool", Cutter),), _at_first(-1.0))
CUT = Predicate("cut", (Parameter("part", Part),), _at_first(-1.0))
AT = Predicate(
    "at",
    (Parameter("part", Part), Parameter("place", Station)),
    _at_first(-1.0),
    kind=Kind.FUNCTIONAL,
    value_of="place",
)
BEARS = _static("bears", Hand, Part, lambda hand, part: hand["force"] - part["weight"] / 2.0)
SHARP = _static("sharp", Cutter, Part, lambda tool, part: tool["edge"] - part["hardness"], "1")
SOUND = _static("sound", Station, Part, lambda place, part: place["load"] - part["weight"])


def _block(
    name: str,
    slots: Mapping[str, type],
    anchor: str,
    entry: tuple[Literal, ...],
    exits: tuple[Literal, ...],
    targets: Mapping[str, type] | None = None,
    hold: bool = False,
) -> Block:
    return Block(
        name=name,
        slots=tuple(Slot(slot, sort) for slot, sort in slots.items()),
        anchor=anchor,
        targets=tuple(Target(target, sort) for target, sort in (targets or {}).items()),
        entry=entry,
        exit=exits,
        duration=Duration(0.5, 9.0, lambda *_: 1.0),
        hold=hold,
    )


BLOCKS = (
    Block("RESTING", (Slot("token", TOKEN),), "token", Duration(0.1, 3600.0, lambda *_: 0.1), hold=True),
    _block("SETTING", {"tool": Cutter}, "tool", (), (SET("tool"),), hold=True),
    _block(
        "CUTTING",
        {"hand": Hand, "tool": Cutter, "part": Part},
        "part",
        (SET("tool"), SHARP("tool", "part")),
        (~SET("tool"), CUT("part")),
    ),
    _block(
        "CARRYING",
        {"first": Hand, "second": Hand, "part": Part},
        "part",
        (BEARS("first", "part"), BEARS("second", "part"), SOUND("place", "part")),
        (AT("part", "place"),),
        {"place": Station},
    ),
)
EDGES = (
    ("RESTING.token", "SETTING.tool"),
    ("CUTTING.tool", "SETTING.tool"),
    ("SETTING.tool", "RESTING.token"),
    ("SETTING.tool", "CUTTING.tool"),
    ("RESTING.token", "CUTTING.hand"),
    ("CARRYING.first", "CUTTING.hand"),
    ("CARRYING.second", "CUTTING.hand"),
    ("RESTING.token", "CUTTING.part"),
    ("CARRYING.part", "CUTTING.part"),
    ("CUTTING.hand", "RESTING.token"),
    ("CUTTING.tool", "RESTING.token"),
    ("CUTTING.part", "RESTING.token"),
    ("CUTTING.part", "CARRYING.part"),
    ("RESTING.token", "CARRYING.first"),
    ("RESTING.token", "CARRYING.second"),
    ("CUTTING.hand", "CARRYING.first"),
    ("CUTTING.hand", "CARRYING.second"),
    ("RESTING.token", "CARRYING.part"),
    ("CARRYING.first", "RESTING.token"),
    ("CARRYING.second", "RESTING.token"),
    ("CARRYING.part", "RESTING.token"),
)
WORKSHOP = Domain(
    name="workshop",
    classes=(Hand, Part, Cutter, Station),
    predicates=(SET, CUT, AT, BEARS, SHARP, SOUND),
    blocks=BLOCKS,
    network=ReassignmentNetwork(EDGES),
    disjoint=((Hand, Part), (Hand, Cutter), (Part, Cutter)),
)


def workshop_task(
    goal: tuple[Atom, ...],
    hands: tuple[float, ...] = (50.0, 50.0),
    parts: tuple[tuple[float, float], ...] = ((60.0, 3.0),),
    edges: tuple[float, ...] = (5.0,),
    loads: tuple[float, ...] = (100.0,),
    domain: Domain = WORKSHOP,
) -> Task:
    """Return a task with the given forces of hands, (weight, hardness) of parts, edges, and loads of stations."""
    tokens = [Token.make(f"hand {i}", [Hand], {"force": force}) for i, force in enumerate(hands)]
    tokens += [
        Token.make(f"part {i}", [Part], {"weight": weight, "hardness": hardness})
        for i, (weight, hardness) in enumerate(parts)
    ]
    tokens += [Token.make(f"cutter {i}", [Cutter], {"edge": edge}) for i, edge in enumerate(edges)]
    tokens += [Token.make(f"station {i}", [Station], {"load": load}) for i, load in enumerate(loads)]
    state = {(token.name, "position"): (float(i), 0.0, 0.0) for i, token in enumerate(tokens)}
    agents = {"robot": tuple(f"hand {i}" for i in range(len(hands)))}
    return Task("workshop", domain, tuple(tokens), State.of(tokens, state), goal, agents)


def cut(part: int = 0) -> Atom:
    """Return the goal that a part is cut."""
    return Atom("cut", (f"part {part}",))


def at(part: int = 0, station: int = 0) -> Atom:
    """Return the goal that a part is at a station."""
    return Atom("at", (f"part {part}", f"station {station}"))
