"""A toy world for tests of physics and execution: pushers that move to spots, and passive things."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, cast

import numpy as np

from hybrid_tamp.geometry.shapes import Box, Cylinder, Sphere
from hybrid_tamp.model.affordance import TOKEN, AffordanceClass, BasicAction, CapabilityClass, PlaceClass, quantity
from hybrid_tamp.model.block import FLOOR, Block, Duration, Slot, Target
from hybrid_tamp.model.control import Commands, ContinuousSystem, Hyperparameter, Parameters
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.kind import Kind
from hybrid_tamp.model.network import ReassignmentNetwork
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.predicate import Atom, Binding, Parameter, Predicate
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token


class Pusher(CapabilityClass):
    """A body that the robot moves by force."""

    name: ClassVar[str] = "PUSHER"
    basic_actions: ClassVar[tuple[BasicAction, ...]] = (BasicAction("force", 3, "N", "maximal_force"),)

    mass: float = quantity("kg", "mass", gt=0)
    maximal_force: float = quantity("N", "largest force", gt=0)
    friction: float = quantity("1", "friction", default=0.5)


class Twister(CapabilityClass):
    """A body that the robot turns; PyBullet does not know its action."""

    name: ClassVar[str] = "TWISTER"
    basic_actions: ClassVar[tuple[BasicAction, ...]] = (BasicAction("torque", 1, "N m"),)


class Thing(AffordanceClass):
    """A passive body."""

    name: ClassVar[str] = "THING"

    mass: float = quantity("kg", "mass", gt=0)
    friction: float = quantity("1", "friction", default=0.5)
    rolling_friction: float = quantity("m", "rolling friction", default=0.0)


class Spot(PlaceClass):
    """A place to move to."""

    name: ClassVar[str] = "SPOT"

    radius: float = quantity("m", "radius", gt=0)


def _closeness(state: State, pusher: Token, spot: Token) -> Any:
    offset = state[pusher, "position"] - state[spot, "position"]
    return spot["radius"] - np.linalg.norm(offset, axis=-1)


def _slowness(state: State, token: Token) -> Any:
    return 0.02 - np.linalg.norm(state[token, "velocity"], axis=-1)


NEAR = Predicate(
    "near",
    (Parameter("pusher", Pusher), Parameter("spot", Spot)),
    _closeness,
    unit="m",
    reads={"pusher": ("position",), "spot": ("position",)},
    kind=Kind.FUNCTIONAL,
    value_of="spot",
)
AT_REST = Predicate("at_rest", (Parameter("token", TOKEN),), _slowness, unit="m/s", reads={"token": ("velocity",)})


def servo(binding: Binding, start: State, parameters: Parameters) -> Any:
    pusher, spot = cast(Token, binding["pusher"]), cast(Token, binding["spot"])

    def policy(elapsed: Any, state: State) -> Commands:
        stiffness = np.asarray(parameters.hyperparameters["stiffness"])[..., None]
        pull = stiffness * (state[spot, "position"] - state[pusher, "position"])
        return {(pusher.name, "force"): pull - 40.0 * state[pusher, "velocity"]}

    return policy


def free_motion(binding: Binding, start: State) -> ContinuousSystem:
    pusher = cast(Token, binding["pusher"])

    def system(state: State, commands: Commands, dt: float) -> State:
        velocity = state[pusher, "velocity"] + commands[pusher.name, "force"] / pusher["mass"] * dt
        moved = state[pusher, "position"] + velocity * dt
        return state.replace({(pusher.name, "velocity"): velocity, (pusher.name, "position"): moved})

    return system


MOVING = Block(
    name="MOVING",
    slots=(Slot("pusher", Pusher),),
    anchor="pusher",
    targets=(Target("spot", Spot),),
    exit=(NEAR("pusher", "spot"), AT_REST("pusher")),
    writes={"pusher": ("position", "velocity")},
    hyperparameters=(Hyperparameter("stiffness", "N/m", 1.0, 1000.0, lambda binding, state: np.asarray(200.0)),),
    duration=Duration(0.2, 3.0, lambda binding, state, hyperparameters: 1.0),
    policy=servo,
    system=free_motion,
)
RESTING = Block(
    name="RESTING",
    slots=(Slot("token", TOKEN),),
    anchor="token",
    entry=(AT_REST("token"),),
    waived={AT_REST("token"): "toys may touch"},
    allowed_contacts=(("token", FLOOR), ("token", "token")),
    duration=Duration(0.1, 3600.0, lambda binding, state, hyperparameters: 0.1),
    hold=True,
)


def domain(moving: Block = MOVING, facts: tuple[Predicate, ...] = ()) -> Domain:
    stated = (literal.predicate for literal in (*moving.entry, *moving.invariants))
    more = dict.fromkeys(each for each in (*stated, *moving.keeps, *facts) if each not in (NEAR, AT_REST))
    return Domain(
        name="toy",
        classes=(Pusher, Twister, Thing, Spot),
        predicates=(NEAR, AT_REST, *more),
        blocks=(moving, RESTING),
        network=ReassignmentNetwork(
            [
                ("RESTING.token", "MOVING.pusher"),
                ("MOVING.pusher", "RESTING.token"),
                ("MOVING.pusher", "MOVING.pusher"),
            ]
        ),
    )


@dataclass(frozen=True)
class World:
    """Builds toy tasks: tokens with states, and plans for them."""

    tokens: tuple[Token, ...] = ()
    given: Mapping[tuple[str, str], Any] = field(default_factory=dict)
    moving: Block = MOVING
    facts: tuple[Predicate, ...] = ()

    def _with(self, token: Token, **state: Any) -> "World":
        new = {(token.name, name): value for name, value in state.items()}
        return replace(self, tokens=(*self.tokens, token), given={**self.given, **new})

    def pusher(self, name: str = "pusher", mass: float = 1.5, limit: float = 100.0, **state: Any) -> "World":
        shape = Sphere(kind="sphere", radius=0.05)
        token = Token.make(name, [Pusher], {"mass": mass, "maximal_force": limit}, shape)
        return self._with(token, **{"position": (0.0, 0.0, 0.5), **state})

    def thing(self, name: str, shape: Any, properties: Mapping[str, Any], **state: Any) -> "World":
        return self._with(Token.make(name, [Thing], properties, shape), **state)

    def twister(self, name: str = "twister") -> "World":
        return self._with(Token.make(name, [Twister], {}, Sphere(kind="sphere", radius=0.05)))

    def spot(self, name: str = "spot", x: float = 0.4, radius: float = 0.01, height: float = 0.5) -> "World":
        return self._with(Token.make(name, [Spot], {"radius": radius}), position=(x, 0.0, height))

    def block(self, **changes: Any) -> "World":
        """Return a world whose block MOVING is declared differently."""
        return replace(self, moving=replace(self.moving, **changes))

    def task(self, *goal: Atom) -> Task:
        state = State.of(self.tokens, self.given)
        return Task("toy", domain(self.moving, self.facts), self.tokens, state, goal)


@dataclass(frozen=True)
class Toys:
    """Classes and functions that the fixture `toys` provides."""

    world: World = World()
    moving: Block = MOVING
    resting: Block = RESTING
    near: Predicate = NEAR
    at_rest: Predicate = AT_REST
    cylinder: Callable[..., Cylinder] = lambda r, length: Cylinder(kind="cylinder", radius=r, length=length)
    box: Callable[..., Box] = lambda *half: Box(kind="box", half_extents=half)
    sphere: Callable[..., Sphere] = lambda r: Sphere(kind="sphere", radius=r)

    @staticmethod
    def move(name: str, start: float, end: float, pusher: str = "pusher", spot: str = "spot", **h: float) -> Any:
        return BlockInstance(name, "MOVING", {"pusher": pusher}, start, end, {"spot": spot}, h)

    @staticmethod
    def rest(name: str, start: float, end: float, token: str = "pusher") -> BlockInstance:
        return BlockInstance(name, "RESTING", {"token": token}, start, end)

    def one_move(self, **hyperparameters: float) -> TaskPlan:
        """Return the plan in which a pusher rests, moves to a spot and rests."""
        return TaskPlan(
            (
                self.rest("RESTING-1", 0.0, 0.1),
                self.move("MOVING-1", 0.1, 1.1, **hyperparameters),
                self.rest("RESTING-2", 1.1, 1.2),
            ),
            1.2,
        )

    def one_move_task(self, **changes: Any) -> Task:
        world = self.world.block(**changes) if changes else self.world
        return world.pusher().spot().task(Atom("near", ("pusher", "spot")))
