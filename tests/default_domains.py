"""Two small domains whose blocks bring no continuous system: a hand shoves a crate, and a gripper hoists a can."""

from typing import Any, ClassVar

import numpy as np

import hybrid_tamp
from hybrid_tamp.authoring import (
    ANY,
    BODY_STATE,
    FLOOR,
    BasicAction,
    Binding,
    Block,
    Commands,
    Domain,
    Duration,
    FloatArray,
    Hyperparameter,
    Kind,
    Parameter,
    Parameters,
    Policy,
    Slot,
    State,
    Target,
    Token,
    VaryingProperty,
    aperture_property,
    minimum_jerk,
    quantity,
)
from hybrid_tamp.skills import (
    AT_REST,
    BODY,
    HORIZONTAL,
    IN_WORKSPACE,
    MOTION,
    POSE,
    UP,
    Body,
    ReachGoal,
    Region,
    StaticEndEffector,
    extent,
    get_token,
    get_tokens,
    hand_servo,
    inside,
    length_predicate,
    make_domain,
    make_reaching,
    near,
    norm,
)

GAP = 0.02
HAND = {"mass": 1.0, "maximal_force": 80.0, "workspace_lower": [-2, -2, 0], "workspace_upper": [2, 2, 2]}


class Crate(Body):
    """Boxes that a hand shoves."""

    name: ClassVar[str] = "CRATE"


class Gripper(StaticEndEffector):
    """A hand with two fingers."""

    name: ClassVar[str] = "GRIPPER"
    varying: ClassVar[tuple[VaryingProperty, ...]] = (*BODY_STATE, aperture_property(0.08))
    basic_actions: ClassVar[tuple[BasicAction, ...]] = (
        *StaticEndEffector.basic_actions,
        BasicAction("torque", 3, "N m", "maximal_torque"),
        BasicAction("grip", 1, "N", "maximal_grip"),
    )
    maximal_torque: float = quantity("N m", "largest torque", gt=0)
    maximal_grip: float = quantity("N", "largest force of a finger", gt=0)
    maximal_aperture: float = quantity("m", "largest gap between the fingers", gt=0)
    wrist_inertia: float = quantity("kg m^2", "moment of inertia of the hand", gt=0)


class Can(Body):
    """Bodies with a handle."""

    name: ClassVar[str] = "CAN"
    handle_from: tuple[float, float, float] = quantity("m", "one end of the handle")
    handle_to: tuple[float, float, float] = quantity("m", "other end of the handle")
    handle_width: float = quantity("m", "width of the handle", gt=0)


DELIVERED = inside(Crate)


def way(state: State, thing: Token, region: Token) -> FloatArray:
    return np.asarray((state[region, "position"] - state[thing, "position"]) * HORIZONTAL)


def behind(state: State, hand: Token, thing: Token, region: Token) -> FloatArray:
    """Return the place ``(..., 3)`` [m] of a hand behind a crate."""
    there = way(state, thing, region)
    axis = there / np.maximum(norm(there), 1e-6)[..., None]
    back = extent(state, hand, axis) + extent(state, thing, -axis) + GAP
    return np.asarray(state[thing, "position"] - back[..., None] * axis + 0.02 * UP)


BEHIND = length_predicate(
    "behind",
    (Parameter("hand", StaticEndEffector), Parameter("object", Crate), Parameter("region", Region)),
    near(0.02, behind),
    reads={"hand": POSE, "object": POSE, "region": ("position",)},
    kind=Kind.MAINTAINED,
    description="{hand} is behind {object}",
    denial="{hand} is not behind {object}",
)


def follow(hand: Token, start: State, there: FloatArray, duration: FloatArray) -> Any:
    """Return a function of elapsed time and state that moves a hand along a straight minimum-jerk path."""
    begin, servo = start[hand, "position"].copy(), hand_servo(hand, start)

    def commands(elapsed: FloatArray, state: State) -> Commands:
        return servo(state, begin + minimum_jerk(np.asarray(elapsed / duration))[..., None] * there, 0.0)

    return commands


def shove(binding: Binding, start: State, parameters: Parameters) -> Policy:
    hand, thing, region = get_tokens(binding, "hand", "object", "region")
    there = way(start, thing, region)
    there = there * (1.0 + GAP / np.maximum(norm(there), 1e-6))[..., None]
    policy: Policy = follow(hand, start, there, parameters.hyperparameters["duration"])
    return policy


def squeeze(binding: Binding, start: State, parameters: Parameters) -> Policy:
    hand = get_token(binding, "hand")
    stay = follow(hand, start, np.zeros(3), np.asarray(1.0))

    def policy(elapsed: FloatArray, state: State) -> Commands:
        grip = np.full((*state.values.shape[:-1], 1), hand["maximal_grip"])
        return {**stay(elapsed, state), (hand.name, "grip"): grip}

    return policy


def hoist(binding: Binding, start: State, parameters: Parameters) -> Policy:
    hand, chosen = get_token(binding, "hand"), parameters.hyperparameters
    lift = follow(hand, start, np.asarray(chosen["height"])[..., None] * UP, np.asarray(chosen["duration"]))

    def policy(elapsed: FloatArray, state: State) -> Commands:
        grip = np.full((*state.values.shape[:-1], 1), hand["maximal_grip"])
        return {**lift(elapsed, state), (hand.name, "grip"): grip}

    return policy


def speed_of(default: float) -> Hyperparameter:
    return Hyperparameter("duration", "s", 1.0, 6.0, lambda b, s: np.asarray(default), "duration of the movement")


def make_shoving(**changes: Any) -> Domain:
    reach = ReachGoal(
        targets=(Target("object", Crate), Target("region", Region)),
        position=lambda b, s: behind(s, *get_tokens(b, "hand", "object", "region")),
        entry=(AT_REST("object"),),
        arrived=(BEHIND("hand", "object", "region"), IN_WORKSPACE("hand")),
        lasting=(AT_REST("object"),),
    )
    told: dict[str, Any] = {
        "writes": {"hand": MOTION, "object": MOTION},
        "allowed_contacts": (("hand", "object"), ("object", FLOOR)),
    }
    shoving = Block(
        "SHOVING",
        (Slot("hand", StaticEndEffector), Slot("object", Crate)),
        "object",
        Duration(0.5, 12.0),
        targets=(Target("region", Region),),
        entry=(BEHIND("hand", "object", "region"), AT_REST("object")),
        exit=(
            ~DELIVERED("object", ANY),
            DELIVERED("object", "region"),
            *map(AT_REST, ("object", "hand")),
            IN_WORKSPACE("hand"),
        ),
        invariants=(IN_WORKSPACE("hand"),),
        hyperparameters=(speed_of(3.0),),
        policy=shove,
        **(told | changes),
    )
    return make_domain("shoving", (make_reaching(reach, "behind"), shoving))


def shoving_task(**changes: Any) -> hybrid_tamp.Task:
    """Return a task in which a hand shoves a crate by 0.5 m. `changes` replace attributes of the block."""
    return hybrid_tamp.make_task(
        make_shoving(**changes),
        tokens={
            "hand": {
                "classes": [StaticEndEffector],
                "properties": {**HAND, "radius": 0.04, "length": 0.1},
                "pose": {"position": [-0.4, 0.0, 0.3], "rpy": [np.pi / 2, 0.0, 0.0]},
            },
            "crate": {
                "classes": [Crate],
                "properties": {"mass": 0.8, "friction": 0.4},
                "shape": {"kind": "box", "half_extents": [0.08, 0.1, 0.06]},
                "pose": {"position": [0.0, 0.0, 0.06]},
            },
            "goal": {"classes": [Region], "properties": {"radius": 0.05}, "pose": {"position": [0.5, 0.0, 0.0]}},
        },
        goal=[{"inside": ["crate", "goal"]}],
        midlevel=hybrid_tamp.MidLevel(evaluations=60),
    )


HELD = length_predicate(
    "held",
    (Parameter("hand", Gripper), Parameter("object", Can)),
    lambda state, hand, thing: np.minimum(
        0.01 - norm(state[hand, "position"] - state[thing, "position"]),
        thing["handle_width"] + 0.001 - state[hand, "aperture"][..., 0],
    ),
    reads={"hand": ("position", "aperture"), "object": ("position",)},
    kind=Kind.MAINTAINED,
)
RAISED = length_predicate(
    "raised",
    (Parameter("object", Can),),
    lambda state, thing: state[thing, "position"][..., 2] - 0.25,
    reads={"object": ("position",)},
)


def make_hoisting() -> Domain:
    slots = (Slot("hand", Gripper), Slot("object", Can))
    gripping: dict[str, Any] = {
        "allowed_contacts": (("hand", "object"), ("object", FLOOR)),
        "hold": True,
    }
    grasping = Block(
        "GRASPING",
        slots,
        "hand",
        Duration(0.2, 4.0),
        entry=(AT_REST("object"), AT_REST("hand")),
        exit=(HELD("hand", "object"), IN_WORKSPACE("hand"), AT_REST("hand"), AT_REST("object")),
        writes={"hand": (*MOTION, "orientation", "angular_velocity", "aperture"), "object": BODY},
        keeps=(RAISED,),
        invariants=(IN_WORKSPACE("hand"), AT_REST("object"), AT_REST("hand")),
        policy=squeeze,
        **gripping,
    )
    hoisting = Block(
        "HOISTING",
        slots,
        "hand",
        Duration(0.5, 10.0),
        entry=(HELD("hand", "object"),),
        exit=(HELD("hand", "object"), RAISED("object"), IN_WORKSPACE("hand"), AT_REST("hand"), AT_REST("object")),
        writes={"hand": (*MOTION, "orientation", "angular_velocity", "aperture"), "object": BODY},
        hyperparameters=(
            Hyperparameter("height", "m", 0.1, 0.6, lambda b, s: np.asarray(0.25), "height of the lift"),
            speed_of(2.0),
        ),
        invariants=(IN_WORKSPACE("hand"),),
        policy=hoist,
        **gripping,
    )
    return make_domain("hoisting", (grasping, hoisting))


def hoisting_task() -> hybrid_tamp.Task:
    """Return a task in which a gripper grasps a can and lifts it."""
    finger = {"maximal_torque": 20.0, "maximal_grip": 100.0, "maximal_aperture": 0.08, "wrist_inertia": 0.01}
    handle = {"handle_from": [-0.05, 0, 0], "handle_to": [0.05, 0, 0], "handle_width": 0.03}
    return hybrid_tamp.make_task(
        make_hoisting(),
        tokens={
            "hand": {
                "classes": [Gripper],
                "properties": {**HAND, **finger, "radius": 0.03, "length": 0.08},
                "pose": {"position": [0.0, 0.0, 0.05]},
            },
            "can": {
                "classes": [Can],
                "properties": {"mass": 0.5, "friction": 0.5, **handle},
                "shape": {"kind": "box", "half_extents": [0.08, 0.03, 0.05]},
                "pose": {"position": [0.0, 0.0, 0.05]},
            },
        },
        goal=[{"raised": ["can"]}],
        midlevel=hybrid_tamp.MidLevel(evaluations=60),
    )
