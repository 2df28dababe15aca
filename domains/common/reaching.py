"""REACHING (paper, D5): a hand's curved reach to a place beside an object.

The block is written once; a domain says where its hands reach to (`ReachGoal`). The movement is a dynamic movement
primitive learnt from a demonstrated reach (``reach.csv``) that lifts the hand, carries it over and sets it down, or
whatever other one it is taught.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import cast

import numpy as np

from hybrid_tamp.authoring import (
    DMP,
    Binding,
    Block,
    Commands,
    Duration,
    FloatArray,
    Hyperparameter,
    Hyperparameters,
    Literal,
    Movement,
    Parameters,
    Policy,
    Predicate,
    Slot,
    State,
    Target,
    Token,
)

from .classes import StaticEndEffector
from .predicates import AT_REST
from .primitives import demonstrated_reach
from .servos import hand_servo, hand_system
from .timetable import Timetable

LIFT = 0.36
"""How far above its start and goal the demonstrated reach carries the hand [m]."""
_MEAN_SPEED = 0.5
_SETTLING = 0.15


@dataclass(frozen=True)
class ReachGoal:
    """Where a domain's hands reach to.

    Attributes:
        targets: what the goal is given by, e.g. an object and a region.
        position: ``position(binding, state)`` of the hand's centre when it has arrived, ``(..., 3)`` [m].
        entry: conditions under which the reach makes sense.
        arrived: the conditions that say the hand is there.
        hand_class: the hands that reach there.
        keeps: predicates that stay as they are although they read where the hand is.
    """

    targets: tuple[Target, ...]
    position: Callable[[Binding, State], FloatArray]
    entry: tuple[Literal, ...]
    arrived: tuple[Literal, ...]
    hand_class: type[StaticEndEffector] = StaticEndEffector
    keeps: tuple[Predicate, ...] = ()


def reaching(goal: ReachGoal, mode: str | None = None, primitive: DMP | None = None) -> Block:
    """Return REACHING for one kind of goal.

    Args:
        goal: where the hands reach to.
        mode: its name as one mode of several, or None.
        primitive: the movement, in three dimensions; the demonstrated reach by default.
    """

    def initial_duration(binding: Binding, state: State) -> FloatArray:
        hand = cast(Token, binding["hand"])
        distance = np.linalg.norm(goal.position(binding, state) - state[hand, "position"], axis=-1)
        return np.asarray(1.2 + (distance + 2 * LIFT) / (2 * _MEAN_SPEED))

    def expected(binding: Binding, state: State, hyperparameters: Hyperparameters) -> float:
        return float(hyperparameters["duration"]) + _SETTLING

    def make_policy(binding: Binding, start: State, parameters: Parameters) -> Policy:
        hand = cast(Token, binding["hand"])
        movement = primitive or demonstrated_reach()
        reference = movement.trajectory(
            start[hand, "position"], goal.position(binding, start), parameters.hyperparameters["duration"]
        )

        servo = hand_servo(hand, start)
        timetable = Timetable(lambda elapsed: reference.at(elapsed)[:2], start)

        def policy(elapsed: FloatArray, state: State) -> Commands:
            return servo(state, *timetable(elapsed))

        return policy

    def outcome(binding: Binding, state: State) -> State:
        return state.replace({(cast(Token, binding["hand"]).name, "position"): goal.position(binding, state)})

    return Block(
        name="REACHING" if mode is None else f"REACHING:{mode}",
        slots=(Slot("hand", goal.hand_class),),
        anchor="hand",
        targets=goal.targets,
        entry=goal.entry,
        exit=(*goal.arrived, AT_REST("hand")),
        writes={"hand": ("position", "velocity")},
        keeps=goal.keeps,
        hyperparameters=(Hyperparameter("duration", "s", 0.8, 8.0, initial_duration, "how long the reach takes"),),
        duration=Duration(0.3, 12.0, expected),
        hold=True,
        policy=make_policy,
        system=hand_system,
        taught=lambda other: reaching(goal, mode, other),
        movement=Movement("hand", "position", 3),
        outcome=outcome,
        description="the hand moves on a curve to its place beside the object and holds there",
    )
