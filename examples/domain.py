"""Example of a complete domain, in which a robot drives carts to docks.

The domain has two classes, two predicates and two blocks. ``python examples/domain.py`` checks the domain, plans a task
and runs the plan with the blocks' continuous systems. The command line accepts the file too:
``hybrid-tamp network examples/domain.py``.
"""

import sys
from pathlib import Path
from typing import ClassVar, cast

import numpy as np

import hybrid_tamp
from hybrid_tamp.authoring import (
    TOKEN,
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
    Hyperparameters,
    Kind,
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
from hybrid_tamp.testing import check_domain


class Cart(CapabilityClass):
    """A cart that the robot drives by a force."""

    name: ClassVar[str] = "CART"
    basic_actions: ClassVar[tuple[BasicAction, ...]] = (BasicAction("force", 3, "N", limit="maximal_force"),)
    mass: float = quantity("kg", "mass of the cart", gt=0)
    maximal_force: float = quantity("N", "largest force on the cart", gt=0)


class Dock(PlaceClass):
    """A place where a cart can stop."""

    name: ClassVar[str] = "DOCK"
    radius: float = quantity("m", "largest distance between the dock's centre and a docked cart", gt=0)


def distance_left(state: State, cart: Token, dock: Token) -> FloatArray:
    """Return the radius of the dock minus the distance between the cart and the dock [m], shape ``(...)``."""
    return np.asarray(dock["radius"] - np.linalg.norm(_way(state, cart, dock), axis=-1))


def slowness(state: State, token: Token) -> FloatArray:
    """Return 0.02 m/s minus the speed of the token [m/s], shape ``(...)``."""
    return np.asarray(0.02 - np.linalg.norm(state[token, "velocity"], axis=-1))


DOCKED = Predicate(
    "docked",
    (Parameter("cart", Cart), Parameter("dock", Dock)),
    distance_left,
    unit="m",
    scale=0.05,
    reads={"cart": ("position",), "dock": ("position",)},
    kind=Kind.FUNCTIONAL,
    value_of="dock",
    description="{cart} is at {dock}",
    denial="{cart} is not at {dock}",
)
AT_REST = Predicate(
    "at_rest",
    (Parameter("token", TOKEN),),
    slowness,
    unit="m/s",
    scale=0.02,
    reads={"token": ("velocity",)},
    description="{token} is at rest",
    denial="{token} is not at rest",
)


def _way(state: State, cart: Token, dock: Token) -> FloatArray:
    """Return the horizontal displacement from a cart to a dock [m], shape ``(..., 3)``."""
    return np.asarray((state[dock, "position"] - state[cart, "position"]) * [1.0, 1.0, 0.0])


def drive(binding: Binding, start: State, parameters: Parameters) -> Policy:
    """Make the policy. A spring and a damper pull the cart along a minimum-jerk trajectory."""
    cart, dock = cast(Token, binding["cart"]), cast(Token, binding["dock"])
    begin, way = start[cart, "position"], _way(start, cart, dock)
    duration = parameters.hyperparameters["duration"]
    stiffness = 100.0 * cart["mass"]
    damping = 20.0 * cart["mass"]

    def policy(elapsed: FloatArray, state: State) -> Commands:
        wanted = begin + minimum_jerk(elapsed / duration)[..., None] * way
        force = stiffness * (wanted - state[cart, "position"]) - damping * state[cart, "velocity"]
        largest = np.linalg.norm(force, axis=-1, keepdims=True)
        return {(cart.name, "force"): force * np.minimum(1.0, cart["maximal_force"] / np.maximum(largest, 1e-9))}

    return policy


def roll(binding: Binding, start: State) -> ContinuousSystem:
    """Make the continuous system, which applies Newton's second law to the cart."""
    cart = cast(Token, binding["cart"])

    def system(state: State, commands: Commands, dt: float) -> State:
        velocity = state[cart, "velocity"] + commands[cart.name, "force"] / cart["mass"] * dt
        position = state[cart, "position"] + velocity * dt
        return state.replace({(cart.name, "velocity"): velocity, (cart.name, "position"): position})

    return system


def initial_duration(binding: Binding, state: State) -> FloatArray:
    """Return the duration of the drive at a mean speed of 0.5 m/s [s], shape ``(...)``."""
    way = _way(state, cast(Token, binding["cart"]), cast(Token, binding["dock"]))
    return np.asarray(np.linalg.norm(way, axis=-1) / 0.5)


def expected(binding: Binding, state: State, hyperparameters: Hyperparameters) -> float:
    """Return the expected duration of a drive [s], which is the duration of the movement plus 0.5 s to settle."""
    return float(hyperparameters["duration"]) + 0.5


DRIVING = Block(
    name="DRIVING",
    slots=(Slot("cart", Cart),),
    anchor="cart",
    targets=(Target("dock", Dock),),
    entry=(AT_REST("cart"),),
    exit=(~DOCKED("cart", "*"), DOCKED("cart", "dock"), AT_REST("cart")),
    writes={"cart": ("position", "velocity")},
    hyperparameters=(Hyperparameter("duration", "s", 0.5, 20.0, initial_duration, "duration of the movement"),),
    duration=Duration(0.5, 30.0, expected),
    policy=drive,
    system=roll,
    description="the cart drives to the dock",
)
RESTING = Block(
    name="RESTING",
    slots=(Slot("token", TOKEN),),
    anchor="token",
    entry=(AT_REST("token"),),
    invariants=(AT_REST("token"),),
    duration=Duration(0.1, 3600.0, lambda binding, state, hyperparameters: 0.1),
    hold=True,
    description="nothing manipulates the token",
)
DOMAIN = Domain(
    name="carts",
    classes=(Cart, Dock),
    predicates=(DOCKED, AT_REST),
    blocks=(RESTING, DRIVING),
    network=ReassignmentNetwork([("RESTING.token", "DRIVING.cart"), ("DRIVING.cart", "RESTING.token")]),
    description="carts drive to docks",
)


def make_task() -> hybrid_tamp.Task:
    """Return a task in which two carts must drive to two different docks."""
    cart = {
        "classes": [Cart],
        "properties": {"mass": 4.0, "maximal_force": 40.0},
        "shape": Box(kind="box", half_extents=(0.2, 0.1, 0.1)),
    }
    dock = {"classes": [Dock], "properties": {"radius": 0.05}}
    return hybrid_tamp.make_task(
        DOMAIN,
        tokens={
            "red": {**cart, "pose": {"position": [0.0, 0.0, 0.1]}},
            "blue": {**cart, "pose": {"position": [0.0, 1.0, 0.1]}},
            "near": {**dock, "pose": {"position": [2.0, 0.0, 0.0]}},
            "far": {**dock, "pose": {"position": [3.0, 1.0, 0.0]}},
        },
        goal=[{"docked": ["red", "near"]}, {"docked": ["blue", "far"]}],
        agents={"robot": ["red", "blue"]},
        name="two_carts",
    )


def main(folder: Path) -> hybrid_tamp.RunResult:
    """Check the domain, and then plan and run a task of this domain."""
    task = make_task()
    assert check_domain(task) == []
    result = hybrid_tamp.run(task, folder, backend="analytic")
    print(result)
    return result


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "out-carts"))
