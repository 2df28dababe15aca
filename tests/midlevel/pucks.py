"""A toy world with optima in closed form: one block slides a puck along x, and a second block slides it along y.
``FIRST`` slides the puck to x = a, and its measure is best at a = 0.2. ``SECOND`` slides the puck to y = b, and its
measures are best at x = 0.8 and at y = x. The joint optimum is a = b = 0.5 with the value -0.18. If each block is
optimised on its own, the optimum is a = b = 0.2 with the value -0.36.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np

from hybrid_tamp.model.affordance import TOKEN, BasicAction, CapabilityClass, VaryingProperty
from hybrid_tamp.model.block import Block, Duration, Slot
from hybrid_tamp.model.control import Hyperparameter
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.measure import Measure
from hybrid_tamp.model.network import ReassignmentNetwork
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.predicate import Atom, Parameter, Predicate
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import MidLevel, Task
from hybrid_tamp.model.token import Token

JOINT, APART = -0.18, -0.36
_SECONDS = 0.1


class Puck(CapabilityClass):
    """Something that slides."""

    name: ClassVar[str] = "PUCK"
    varying: ClassVar[tuple[VaryingProperty, ...]] = (VaryingProperty("place", 2, "m", (0.0, 0.0)),)
    basic_actions: ClassVar[tuple[BasicAction, ...]] = (BasicAction("velocity", 2, "m/s"),)


def _still(state: State, puck: Token) -> Any:
    return np.ones(state.values.shape[:-1])


def _low(state: State, puck: Token) -> Any:
    return 2.0 - state[puck, "place"][..., 1]


SLID = Predicate("slid", (Parameter("puck", Puck),), _low, reads={"puck": ("place",)})


def _system(binding: Any, start: State) -> Any:
    puck = binding["puck"]

    def system(state: State, commands: Any, dt: float) -> State:
        return state.replace({(puck.name, "place"): state[puck, "place"] + commands[puck.name, "velocity"] * dt})

    return system


def _sliding(axis: int, name: str) -> Any:
    def make(binding: Any, start: State, parameters: Any) -> Any:
        puck = binding["puck"]
        way = np.asarray(parameters.hyperparameters[name]) - start[puck, "place"][..., axis]

        def policy(elapsed: Any, state: State) -> Any:
            velocity = np.zeros_like(state[puck, "place"])
            velocity[..., axis] = np.where(elapsed < _SECONDS - 1e-9, way / _SECONDS, 0.0)
            return {(puck.name, "velocity"): velocity}

        return policy

    return make


def hyperparameter(name: str, default: float = 0.0) -> Hyperparameter:
    """Return a hyperparameter between -1 and 1."""
    return Hyperparameter(name, "m", -1.0, 1.0, lambda b, s: np.full(s.values.shape[:-1], default))


def block(name: str, axis: int, own: str, measures: Sequence[Measure], more: Sequence[str] = ()) -> Block:
    """Return a block that slides the puck along an axis to the value of a hyperparameter."""
    return Block(
        name=name,
        slots=(Slot("puck", Puck),),
        anchor="puck",
        exit=(SLID("puck"),),
        writes={"puck": ("place",)},
        hyperparameters=tuple(map(hyperparameter, (own, *more))),
        duration=Duration(_SECONDS, 1.0, lambda b, s, h: _SECONDS),
        policy=_sliding(axis, own),
        system=_system,
        performance=tuple(measures),
    )


def _near(axis: int, wanted: float) -> Any:
    return lambda b, before, after, h: -((after[b["puck"], "place"][..., axis] - wanted) ** 2)


def _along(b: Any, before: State, after: State, h: Any) -> Any:
    place = after[b["puck"], "place"]
    return -((place[..., 1] - place[..., 0]) ** 2)


FIRST = block("FIRST", 0, "a", [Measure("start", "m^2", 1.0, end=_near(0, 0.2))])
SECOND = block(
    "SECOND", 1, "b", [Measure("later", "m^2", 1.0, end=_near(0, 0.8)), Measure("along", "m^2", 1.0, end=_along)]
)
_RESTING = Block("RESTING", (Slot("token", TOKEN),), "token", Duration(0.1, 3600.0, lambda b, s, h: 0.1), hold=True)


def puck_task(first: Block = FIRST, second: Block = SECOND, **settings: Any) -> Task:
    """Return the task. `settings` are settings of the mid-level planner."""
    edges = [("RESTING.token", "FIRST.puck"), ("FIRST.puck", "SECOND.puck"), ("SECOND.puck", "RESTING.token")]
    domain = Domain("pucks", (Puck,), (SLID,), (first, second, _RESTING), ReassignmentNetwork(edges))
    tokens = (Token.make("puck", [Puck], {}),)
    midlevel = MidLevel(**{"evaluations": 1500, **settings})
    return Task("pucks", domain, tokens, State.of(tokens, {}), (Atom("slid", ("puck",)),), midlevel=midlevel)


def puck_plan() -> TaskPlan:
    """Return the plan in which the puck rests, moves in FIRST, moves in SECOND and rests."""
    times = (0.0, 0.1, 0.2, 0.3, 0.4)
    blocks = ("RESTING", "FIRST", "SECOND", "RESTING")
    names = ("RESTING-1", "FIRST-1", "SECOND-1", "RESTING-2")
    slots = [{"token" if name == "RESTING" else "puck": "puck"} for name in blocks]
    instances = map(BlockInstance, names, blocks, slots, times[:-1], times[1:])
    return TaskPlan(tuple(instances), times[-1])


def with_dummies(names: Sequence[str], inert: Block = FIRST) -> Block:
    """Return a block with additional hyperparameters that have no effect."""
    return replace(inert, hyperparameters=(*inert.hyperparameters, *map(hyperparameter, names)))
