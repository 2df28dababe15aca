"""A small correct domain: a hand reaches behind a crate and pushes the crate into a dock.

Tests seed one mistake at a time into this domain. `make_task` takes changes of predicates and blocks by name.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, ClassVar, cast

import numpy as np

import hybrid_tamp
from hybrid_tamp.authoring import (
    ANY,
    FLOOR,
    GRAVITY,
    TOKEN,
    AffordanceClass,
    BasicAction,
    Binding,
    Block,
    Box,
    CapabilityClass,
    Commands,
    ContinuousSystem,
    Domain,
    Duration,
    FloatArray,
    Hyperparameter,
    Kind,
    Literal,
    Parameter,
    Parameters,
    PlaceClass,
    Policy,
    Predicate,
    ReassignmentNetwork,
    Slot,
    State,
    Target,
    Token,
    minimum_jerk,
    quantity,
)

HALF_HAND, HALF_CRATE, GAP = 0.05, 0.1, 0.01


class Hand(CapabilityClass):
    """A hand that the robot moves by a force."""

    name: ClassVar[str] = "HAND"
    basic_actions: ClassVar[tuple[BasicAction, ...]] = (BasicAction("force", 3, "N", limit="maximal_force"),)
    mass: float = quantity("kg", "mass of the hand", gt=0)
    maximal_force: float = quantity("N", "largest force on the hand", gt=0)


class Crate(AffordanceClass):
    """A box that slides on the floor."""

    name: ClassVar[str] = "CRATE"
    mass: float = quantity("kg", "mass of the crate", gt=0)
    friction: float = quantity("1", "friction coefficient", gt=0)


class Dock(PlaceClass):
    """A disc on the floor."""

    name: ClassVar[str] = "DOCK"
    radius: float = quantity("m", "radius of the disc", gt=0)


HAND, CRATE, DOCK = Parameter("hand", Hand), Parameter("crate", Crate), Parameter("dock", Dock)
_POSITIONS = {"hand": ("position",), "crate": ("position",), "dock": ("position",)}


def way(state: State, crate: Token, dock: Token) -> FloatArray:
    """Return the horizontal displacement from the crate to the dock [m], shape ``(..., 3)``."""
    return np.asarray((state[dock, "position"] - state[crate, "position"]) * [1.0, 1.0, 0.0])


def length(vector: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.norm(vector, axis=-1))


def direction(state: State, crate: Token, dock: Token) -> FloatArray:
    there = way(state, crate, dock)
    return np.asarray(there / np.maximum(length(there), 1e-6)[..., None])


def place_behind(state: State, crate: Token, dock: Token) -> FloatArray:
    """Return the place of the hand behind the crate [m], shape ``(..., 3)``."""
    back = (HALF_CRATE + HALF_HAND + GAP) * direction(state, crate, dock)
    return np.asarray(state[crate, "position"] - back)


def docked(state: State, crate: Token, dock: Token) -> FloatArray:
    return np.asarray(dock["radius"] - length(way(state, crate, dock)))


def behind(state: State, hand: Token, crate: Token, dock: Token) -> FloatArray:
    return np.asarray(0.02 - length(state[hand, "position"] - place_behind(state, crate, dock)))


def slow(state: State, token: Token) -> FloatArray:
    return np.asarray(0.02 - length(state[token, "velocity"]))


def in_hall(state: State, hand: Token) -> FloatArray:
    return np.asarray(6.0 - length(state[hand, "position"]))


def low(state: State, crate: Token) -> FloatArray:
    return np.asarray(0.2 - state[crate, "position"][..., 2])


def strong(state: State, hand: Token, crate: Token) -> FloatArray:
    return np.asarray(hand["maximal_force"] - 2.0 * crate["friction"] * crate["mass"] * GRAVITY)


def apart(state: State, crate: Token, dock: Token) -> FloatArray:
    return np.asarray(length(way(state, crate, dock)) - 0.2)


PREDICATES = (
    Predicate("docked", (CRATE, DOCK), docked, "m", 0.05, _POSITIONS, Kind.FUNCTIONAL, "dock"),
    Predicate("behind", (HAND, CRATE, DOCK), behind, "m", 0.02, _POSITIONS, Kind.MAINTAINED),
    Predicate("at_rest", (Parameter("token", TOKEN),), slow, "m/s", 0.02, {"token": ("velocity",)}),
    Predicate("in_hall", (HAND,), in_hall, "m", 0.1, {"hand": ("position",)}),
    Predicate("low", (CRATE,), low, "m", 0.1, {"crate": ("position",)}),
    Predicate("strong", (HAND, CRATE), strong, "N", 1.0, kind=Kind.STATIC),
    Predicate(
        "apart",
        (CRATE, DOCK),
        apart,
        "m",
        0.1,
        {"crate": ("position",), "dock": ("position",)},
        Kind.STATIC,
        bound=lambda state, radius, crate, dock: apart(state, crate, dock) + 2.0 * radius,
    ),
)


def follow(hand: Token, begin: FloatArray, there: FloatArray, duration: FloatArray, share: float = 1.0) -> Policy:
    """Return a policy in which a spring and a damper pull the hand along a minimum-jerk trajectory."""

    def policy(elapsed: FloatArray, state: State) -> Commands:
        wanted = begin + minimum_jerk(np.asarray(elapsed / duration))[..., None] * there
        pull = 400.0 * (wanted - state[hand, "position"]) - 60.0 * state[hand, "velocity"]
        largest = np.maximum(length(pull), 1e-9)[..., None]
        return {(hand.name, "force"): share * pull * np.minimum(1.0, hand["maximal_force"] / largest)}

    return policy


def reach(binding: Binding, start: State, parameters: Parameters) -> Policy:
    hand, crate, dock = tokens(binding)
    begin = start[hand, "position"]
    there = place_behind(start, crate, dock) - begin
    return follow(hand, begin, there, parameters.hyperparameters["duration"])


def push(binding: Binding, start: State, parameters: Parameters) -> Policy:
    hand, crate, dock = tokens(binding)
    there = way(start, crate, dock) + GAP * direction(start, crate, dock)
    return follow(hand, start[hand, "position"], there, parameters.hyperparameters["duration"])


def tokens(binding: Binding) -> tuple[Token, Token, Token]:
    return cast(Token, binding["hand"]), cast(Token, binding["crate"]), cast(Token, binding["dock"])


def move(binding: Binding, start: State) -> ContinuousSystem:
    """Return the system of REACHING: Newton's second law for the hand."""
    hand = cast(Token, binding["hand"])

    def system(state: State, commands: Commands, dt: float) -> State:
        velocity = state[hand, "velocity"] + commands[hand.name, "force"] / hand["mass"] * dt
        position = state[hand, "position"] + velocity * dt
        return state.replace({(hand.name, "velocity"): velocity, (hand.name, "position"): position})

    return system


def shove(binding: Binding, start: State) -> ContinuousSystem:
    """Return the system of PUSHING: the crate stays in front of the hand, and friction stops the crate at once."""
    hand, crate, dock = tokens(binding)
    free, axis = move(binding, start), direction(start, crate, dock)
    reach_of = HALF_HAND + HALF_CRATE
    weight = crate["friction"] * crate["mass"] * GRAVITY

    def system(state: State, commands: Commands, dt: float) -> State:
        between = np.sum((state[crate, "position"] - state[hand, "position"]) * axis, axis=-1)
        force = np.sum(commands[hand.name, "force"] * axis, axis=-1)
        touching = between <= reach_of + 1e-6
        drag = np.where(touching & (force > 0), np.minimum(weight, force), 0.0)
        after = free(state, {(hand.name, "force"): commands[hand.name, "force"] - drag[..., None] * axis}, dt)
        between = np.sum((state[crate, "position"] - after[hand, "position"]) * axis, axis=-1)
        pushed = np.maximum(reach_of - between, 0.0)[..., None] * axis
        return after.replace(
            {
                (crate.name, "position"): state[crate, "position"] + pushed,
                (crate.name, "velocity"): pushed / dt,
            }
        )

    return system


def duration(binding: Binding, start: State) -> FloatArray:
    """Return the duration of a movement at a mean speed of 0.4 m/s [s], shape ``(...)``."""
    _, crate, dock = tokens(binding)
    return np.asarray(1.0 + length(way(start, crate, dock)) / 0.4)


def expected(binding: Binding, start: State, hyperparameters: Mapping[str, Any]) -> float:
    return float(hyperparameters["duration"]) + 0.3


DURATION = Hyperparameter("duration", "s", 1.0, 12.0, duration, "duration of the movement")
Named = Mapping[str, Predicate]
Change = Callable[[Named], Mapping[str, Any]] | Mapping[str, Any]
"""New values of the attributes of a predicate or block, or a function of all predicates that returns these values."""


def make_blocks(on: Named) -> tuple[Block, ...]:
    still: tuple[Literal, ...] = (on["at_rest"]("hand"),)
    free = (on["in_hall"]("hand"),)
    resting = Block(
        "RESTING",
        (Slot("token", TOKEN),),
        "token",
        Duration(0.1, 3600.0, lambda binding, state, hyperparameters: 0.1),
        entry=(on["at_rest"]("token"),),
        invariants=(on["at_rest"]("token"),),
        allowed_contacts=(("token", FLOOR), ("token", "token")),
        hold=True,
    )
    reaching = Block(
        "REACHING",
        (Slot("hand", Hand),),
        "hand",
        Duration(0.5, 20.0, expected),
        targets=(Target("crate", Crate), Target("dock", Dock)),
        entry=(*still, on["apart"]("crate", "dock")),
        exit=(~on["behind"]("hand", ANY, ANY), on["behind"]("hand", "crate", "dock"), *still),
        invariants=free,
        writes={"hand": ("position", "velocity")},
        hyperparameters=(DURATION,),
        hold=True,
        policy=reach,
        system=move,
    )
    pushing = Block(
        "PUSHING",
        (Slot("hand", Hand), Slot("crate", Crate)),
        "hand",
        Duration(0.5, 20.0, expected),
        targets=(Target("dock", Dock),),
        entry=(
            on["behind"]("hand", "crate", "dock"),
            *still,
            on["at_rest"]("crate"),
            on["strong"]("hand", "crate"),
            on["apart"]("crate", "dock"),
        ),
        exit=(~on["docked"]("crate", ANY), on["docked"]("crate", "dock"), on["at_rest"]("crate"), *still),
        invariants=free,
        writes={"hand": ("position", "velocity"), "crate": ("position", "velocity")},
        keeps=(on["low"],),
        hyperparameters=(DURATION,),
        allowed_contacts=(("hand", "crate"), ("crate", FLOOR)),
        policy=push,
        system=shove,
    )
    return resting, reaching, pushing


NETWORK = (
    ("RESTING.token", "REACHING.hand"),
    ("REACHING.hand", "PUSHING.hand"),
    ("REACHING.hand", "RESTING.token"),
    ("RESTING.token", "PUSHING.crate"),
    ("PUSHING.hand", "RESTING.token"),
    ("PUSHING.crate", "RESTING.token"),
)


def make_domain(
    changes: Mapping[str, Change] | None = None,
    more: tuple[Predicate, ...] = (),
    edges: tuple[tuple[str, str], ...] = (),
) -> Domain:
    """Return the domain with changed predicates and blocks, and with more predicates and edges.

    Args:
        changes: maps the name of each changed predicate or block to new values of its attributes.
        more: further predicates.
        edges: further edges of the network.
    """
    changes = changes or {}

    def changed(made: Any, on: Named) -> Any:
        change = changes.get(made.name, {})
        return replace(made, **(change(on) if callable(change) else change))

    on = {each.name: changed(each, {}) for each in (*PREDICATES, *more)}
    return Domain(
        name="crates",
        classes=(Hand, Crate, Dock),
        predicates=tuple(on.values()),
        blocks=tuple(changed(block, on) for block in make_blocks(on)),
        network=ReassignmentNetwork((*NETWORK, *edges)),
        disjoint=((Hand, Crate),),
        description="a hand pushes crates into docks",
    )


def make_task(
    changes: Mapping[str, Change] | None = None,
    more: tuple[Predicate, ...] = (),
    edges: tuple[tuple[str, str], ...] = (),
    hands: tuple[str, ...] = ("hand",),
    dock: str = "near",
    goal: Sequence[Mapping[str, list[str]]] = (),
) -> hybrid_tamp.Task:
    """Return a task in which the hands must push the crate into a dock. See `make_domain` for the other arguments."""
    disc = {"classes": [Dock], "properties": {"radius": 0.08}}
    half = (HALF_CRATE,) * 3
    return hybrid_tamp.make_task(
        make_domain(changes, more, edges),
        tokens={
            **{
                name: {
                    "classes": [Hand],
                    "properties": {"mass": 2.0, "maximal_force": 60.0},
                    "shape": Box(kind="box", half_extents=(HALF_HAND,) * 3),
                    "pose": {"position": [-0.6, 0.4 * number, 0.1]},
                }
                for number, name in enumerate(hands)
            },
            "crate": {
                "classes": [Crate],
                "properties": {"mass": 1.0, "friction": 0.3},
                "shape": Box(kind="box", half_extents=half),
                "pose": {"position": [0.0, 0.0, 0.1]},
            },
            "near": {**disc, "pose": {"position": [0.7, 0.0, 0.0]}},
            "far": {**disc, "pose": {"position": [1.2, 0.0, 0.0]}},
        },
        goal=[{"docked": ["crate", dock]}, *goal],
        agents={"robot": list(hands)},
        name="push_crate",
    )
