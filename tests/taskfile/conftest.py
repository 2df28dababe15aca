"""A toy domain with one item of each kind that a task file can name, and a task file without faults."""

from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np
import pytest
from texts import load_task_text

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.affordance import (
    TOKEN,
    AffordanceClass,
    BasicAction,
    CapabilityClass,
    Direction,
    Number,
    PlaceClass,
    VaryingProperty,
    Vector3,
    quantity,
)
from hybrid_tamp.model.block import Block, Duration, Slot, Target
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.kind import Kind
from hybrid_tamp.model.network import ReassignmentNetwork
from hybrid_tamp.model.predicate import Parameter, Predicate, SymbolSort
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.taskfile.places import shown


class Hand(CapabilityClass):
    """A hand that pushes."""

    name: ClassVar[str] = "HAND"
    basic_actions: ClassVar[tuple[BasicAction, ...]] = (BasicAction("force", 3, "N", "force"),)
    force: Number = quantity("N", "largest force", gt=0)


class Rollable(AffordanceClass):
    """An object that can be rolled."""

    name: ClassVar[str] = "ROLLABLE"
    axis: Direction = quantity("1", "axis of rotation")
    mass: Number = quantity("kg", "mass of the body", gt=0)
    friction: Number = quantity("1", "friction coefficient", default=0.5, ge=0, le=5)

    @staticmethod
    def consistent(token: Token) -> str | None:
        """Return an error message if a token has no shape, otherwise None."""
        return "a rolling token has no shape" if token.shape is None else None


class Heavy(AffordanceClass):
    """An object with a mass, which ROLLABLE also declares, and with two kinds of angles."""

    name: ClassVar[str] = "HEAVY"
    mass: Number = quantity("kg", "mass of the body", gt=0)
    center: Vector3 = quantity("m", "centre of mass", default=(0.0, 0.0, 0.0))
    tilts: Vector3 = quantity("rad", "tilts about three axes", default=(0.0, 0.0, 0.0))
    turns: Number = quantity("rad", "angle of many turns", default=0.0, le=1000)


class Liquid(AffordanceClass):
    """A liquid, which is disjoint from ROLLABLE."""

    name: ClassVar[str] = "LIQUID"


class Region(PlaceClass):
    """A disc."""

    name: ClassVar[str] = "REGION"
    radius: Number = quantity("m", "radius of the disc", gt=0)


class Hole(PlaceClass):
    """A hole whose radius is in millimetres, which conflicts with REGION."""

    name: ClassVar[str] = "HOLE"
    radius: Number = quantity("mm", "radius of the hole", gt=0)


class Idea(PlaceClass):
    """A place without a position."""

    name: ClassVar[str] = "IDEA"
    varying: ClassVar[tuple[VaryingProperty, ...]] = ()


FACES = SymbolSort("face", ("front", "back"))
_OBJECT, _REGION = Parameter("object", Rollable), Parameter("region", Region)


def _zero(state: Any, *values: Any) -> Any:
    return np.zeros(state.values.shape[:-1])


def _no_time(binding: Any, state: Any, hyperparameters: Any) -> float:
    return 1.0


WITHIN = Predicate(
    "within",
    (_OBJECT, _REGION),
    _zero,
    unit="m",
    kind=Kind.FUNCTIONAL,
    value_of="region",
    description="{object} is within {region}",
)
BESIDE = Predicate("beside", (Parameter("one", TOKEN), Parameter("other", TOKEN)), _zero)
SHOWS = Predicate("shows", (_OBJECT, Parameter("face", FACES)), _zero, kind=Kind.MAINTAINED)
TOY = Domain(
    name="toy",
    classes=(Hand, Rollable, Heavy, Liquid, Region, Hole, Idea),
    disjoint=((Rollable, Liquid),),
    predicates=(WITHIN, BESIDE, SHOWS),
    blocks=(
        Block("RESTING", (Slot("token", TOKEN),), "token", Duration(0.1, 60, _no_time), hold=True),
        Block("GUARDING", (Slot("hand", Hand),), "hand", Duration(0.1, 60, _no_time), hold=True),
        Block(
            "ROLLING",
            (Slot("hand", Hand), Slot("object", Rollable)),
            "object",
            Duration(0.1, 60, _no_time),
            targets=(Target("region", Region),),
            exit=(~WITHIN("object", "*"), WITHIN("object", "region")),
            description="the hand rolls the object",
        ),
    ),
    network=ReassignmentNetwork(
        [
            ("RESTING.token", "GUARDING.hand"),
            ("GUARDING.hand", "RESTING.token"),
            ("RESTING.token", "ROLLING.hand"),
            ("RESTING.token", "ROLLING.object"),
            ("ROLLING.hand", "RESTING.token"),
            ("ROLLING.object", "RESTING.token"),
        ]
    ),
    description="rolling in small",
)
TEXT = """\
# A hand rolls a drum.
domain: toy
agents:
  robot: [hand]
tokens:
  hand:
    classes: [HAND]
    properties: {force: 300}
    pose: {position: [0, 0, 0.3]}
  drum:
    classes: [ROLLABLE]
    properties: {axis: [0, 0, 2], mass: 5}
    shape: {kind: cylinder, radius: 0.1, length: 0.3}
    pose: {position: [0, 0, 0.1], rpy: [1.5707963267948966, 0, 0]}
  goal:
    classes: [REGION]
    properties: {radius: 0.02}
    pose: {position: [0.8, 0, 0]}
assignment: {hand: GUARDING}
goal:
  - within: [drum, goal]
planner: fast-downward
limits: {time: 30, memory: 1024, refinements: 2}
seed: 7
"""


def find_toy(name: str) -> Domain:
    """Return the toy domain if the name is the name of the toy domain."""
    if name != "toy":
        raise InputError([Issue("", "unknown domain", shown(name), ("toy",))])
    return TOY


def check_planner(name: str) -> None:
    """Raise an `InputError` if the planner is not one of two known planners."""
    if name not in ("fast-downward", "symk"):
        raise InputError([Issue("planner", "unknown planner", shown(name), ("fast-downward", "symk"))])


@pytest.fixture(scope="session")
def toy() -> Domain:
    return TOY


@pytest.fixture(scope="session")
def text() -> str:
    return TEXT


@pytest.fixture(scope="session")
def load() -> Callable[[str], Task]:
    """Return a function that loads a text as the task file ``t.yaml`` of the toy domain."""
    return lambda text: load_task_text(text, "t.yaml", find_toy, check_planner)


@pytest.fixture(scope="session")
def issues(load: Callable[[str], Task]) -> Callable[[str], tuple[Issue, ...]]:
    """Return a function that returns the faults of a text."""

    def found(text: str) -> tuple[Issue, ...]:
        try:
            load(text)
        except InputError as error:
            return error.issues
        return ()

    return found
