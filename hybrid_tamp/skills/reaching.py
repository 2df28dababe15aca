"""The block REACHING (paper, D5): a hand moves along a curve to a place beside an object.

Each domain defines the goals of its reaches as `ReachGoal` objects. A dynamic movement primitive generates the
movement. The default primitive is learnt from a demonstration (``reach.csv``) in which the hand rises, moves across and
descends. REACHING can also be taught another primitive.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from hybrid_tamp.model.block import Block, Duration, Slot, Target
from hybrid_tamp.model.control import Commands, Hyperparameter, Parameters, Policy
from hybrid_tamp.model.course import Course, sample_times
from hybrid_tamp.model.key_pose import KeyPose
from hybrid_tamp.model.movement import Movement
from hybrid_tamp.model.predicate import Binding, Literal, Predicate
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.dmp import DMP
from hybrid_tamp.motion.poses import quaternion_conjugate, quaternion_multiply, rotation_vector
from hybrid_tamp.skills.alignment import turn_along
from hybrid_tamp.skills.classes import StaticEndEffector, can_turn
from hybrid_tamp.skills.paths import Share, follow_path
from hybrid_tamp.skills.predicates import AT_REST, IN_WORKSPACE
from hybrid_tamp.skills.primitives import Reference, advance, demonstrated_reach, straight_profile
from hybrid_tamp.skills.roles import BODY, MOTION, get_token
from hybrid_tamp.skills.servos import TurnReference, hand_servo, turn_wrists
from hybrid_tamp.skills.timetable import Timetable
from hybrid_tamp.skills.vectors import norm

_LIFT = 0.36
"""Height to which the demonstrated reach rises above its start and its goal [m]."""
_MEAN_SPEED = 0.5
_SETTLING = 0.15
_TURNING = (0.25, 0.65)
"""Fractions of the duration between which a hand turns. The demonstrated reach is then above its start and its goal."""


@dataclass(frozen=True)
class ReachGoal:
    """The goal of a reach.

    Attributes:
        targets: roles that determine the goal, e.g. an object and a region.
        position: ``position(binding, state)`` returns the position ``(..., 3)`` [m] of the hand's centre at the goal.
        entry: conditions that must hold when the reach begins.
        lasting: the entry conditions that must hold until the reach ends.
        arrived: conditions that must hold when the reach ends.
        preferences: static conditions under which the reach is preferred, see `Block.preferences`.
        hand_class: capability class that a hand needs for the reach.
        orientation: ``orientation(binding, state)`` returns the orientation ``(..., 4)`` of the hand at the goal. None
            if the hand does not turn.
        keeps: predicates whose truth the reach does not change, although their margins read the hand's position.
        description: description of the block in one line.
    """

    targets: tuple[Target, ...]
    position: Callable[[Binding, State], FloatArray]
    entry: tuple[Literal, ...]
    arrived: tuple[Literal, ...]
    lasting: tuple[Literal, ...] = ()
    preferences: tuple[Literal, ...] = ()
    hand_class: type[StaticEndEffector] = StaticEndEffector
    orientation: Callable[[Binding, State], FloatArray] | None = None
    keeps: tuple[Predicate, ...] = ()
    description: str = "the hand moves along a curve to a place beside the object and stays there"


@dataclass(frozen=True)
class Transit:
    """How a hand moves to the goal of a reach along a path of its own.

    Attributes:
        follow: ``follow(primitive, binding, start, parameters)`` returns the policy. The primitive is one-dimensional
            and generates the travelled share of the path. None stands for `straight_movement`. If `Parameters.path` is
            given, the policy follows this path.
        sweep: ``sweep(primitive, binding, start, parameters)`` returns the course of the movement.
        speed: hyperparameter of the movement.
        duration: bounds of the duration.
    """

    follow: Callable[[DMP | None, Binding, State, Parameters], Policy]
    sweep: Callable[[DMP | None, Binding, State, Parameters], Course]
    speed: Hyperparameter
    duration: Duration


def time_of_reach(
    distance: Callable[[Binding, State], FloatArray], least: float, settling: float | None = None
) -> tuple[Hyperparameter, Duration]:
    """Return the hyperparameter ``duration`` of a reach and the `Duration` of its block.

    Args:
        distance: ``distance(binding, state)`` returns the distance ``(...)`` [m] that determines the initial value.
        least: lower bound of the hyperparameter [s].
        settling: time from the end of the reach until the hand is at rest [s]. None if the expected duration follows
            from a rollout.
    """

    def initial_value(binding: Binding, state: State) -> FloatArray:
        return np.asarray(1.2 + (distance(binding, state) + 2 * _LIFT) / (2 * _MEAN_SPEED))

    chosen = Hyperparameter("duration", "s", least, 8.0, initial_value, "duration of the reach")
    if settling is None:
        return chosen, Duration(0.3, 12.0)
    return chosen, Duration(0.3, 12.0, lambda binding, state, values: float(values["duration"]) + settling)


class _Reach(NamedTuple):
    """The references of a reach, for the position and the orientation of the hand, and its duration ``(...)`` [s]."""

    position: Reference
    orientation: TurnReference
    duration: FloatArray


def _plan(goal: ReachGoal, primitive: DMP | None, binding: Binding, start: State, parameters: Parameters) -> _Reach:
    """Return the movement along a planned path, or the movement of the primitive to the goal."""
    hand = get_token(binding, "hand")
    origin, end = start[hand, "position"], goal.position(binding, start)
    begun = start[hand, "orientation"]
    turned = begun if goal.orientation is None else goal.orientation(binding, start)
    duration = parameters.hyperparameters["duration"]
    if parameters.path is None:
        movement = (primitive or demonstrated_reach()).trajectory(origin, end, duration)
        share: Share = partial(_turned, duration)
        return _Reach(lambda elapsed: movement.at(elapsed)[:2], turn_along(begun, turned, share), duration)
    turn = norm(rotation_vector(quaternion_multiply(turned, quaternion_conjugate(begun))))
    angle = turn if can_turn(hand) else np.zeros_like(turn)
    travel = follow_path(origin, parameters.path, end, duration, angle)
    return _Reach(travel.reference, turn_along(begun, turned, travel.turned), travel.duration)


def _follow(goal: ReachGoal, primitive: DMP | None, binding: Binding, start: State, parameters: Parameters) -> Policy:
    """Return the policy of a hand that follows its references."""
    hand, reach = get_token(binding, "hand"), _plan(goal, primitive, binding, start, parameters)
    timetable, servo = Timetable(reach.position, start), hand_servo(hand, start)

    def policy(elapsed: FloatArray, state: State) -> Commands:
        return servo(state, *timetable(elapsed))

    return policy if goal.orientation is None else turn_wrists(policy, {hand: reach.orientation})


def _sweep(goal: ReachGoal, primitive: DMP | None, binding: Binding, start: State, parameters: Parameters) -> Course:
    hand, reach = get_token(binding, "hand").name, _plan(goal, primitive, binding, start, parameters)
    times = sample_times(reach.duration)
    moved = {(hand, "position"): reach.position(times)[0]}
    if goal.orientation is not None:
        moved[hand, "orientation"] = reach.orientation(times)[0]
    return Course.through(start, moved, times=times)


def _turned(duration: FloatArray, elapsed: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the share of the turn that a hand has made without a path, and the rate of this share [1/s]."""
    begin, end = _TURNING
    return advance(straight_profile(), elapsed - begin * duration, (end - begin) * duration)


def _arrive(goal: ReachGoal, binding: Binding, state: State) -> State:
    """Return the state ``(...)`` with the hand at the goal."""
    hand = get_token(binding, "hand").name
    changes = {(hand, "position"): goal.position(binding, state)}
    if goal.orientation is not None:
        changes[hand, "orientation"] = goal.orientation(binding, state)
    return state.replace(changes)


def _key_poses(goal: ReachGoal, binding: Binding, start: State) -> list[KeyPose]:
    """Return the pose of the hand at the goal."""
    hand, reached = get_token(binding, "hand"), _arrive(goal, binding, start)
    return [KeyPose("hand", reached[hand, "position"], reached[hand, "orientation"])]


def make_reaching(
    goal: ReachGoal, mode: str | None = None, primitive: DMP | None = None, transit: Transit | None = None
) -> Block:
    """Return the block REACHING for one kind of goal.

    Args:
        goal: the goal of the reach.
        mode: name of the mode, or None if REACHING has no modes.
        primitive: three-dimensional motor primitive of the movement. The default is `demonstrated_reach`.
        transit: movement along a path, with a one-dimensional primitive. None stands for a movement that the
            three-dimensional primitive generates.
    """

    def distance(binding: Binding, state: State) -> FloatArray:
        way = goal.position(binding, state) - state[get_token(binding, "hand"), "position"]
        return np.asarray(np.linalg.norm(way, axis=-1))

    chosen, duration = time_of_reach(distance, 0.8, _SETTLING)
    follow, sweep = partial(_follow, goal, primitive), partial(_sweep, goal, primitive)
    if transit is not None:
        chosen, duration = transit.speed, transit.duration
        follow, sweep = partial(transit.follow, primitive), partial(transit.sweep, primitive)
    return Block(
        name="REACHING" if mode is None else f"REACHING:{mode}",
        slots=(Slot("hand", goal.hand_class),),
        anchor="hand",
        targets=goal.targets,
        entry=goal.entry,
        preferences=goal.preferences,
        exit=(*goal.arrived, AT_REST("hand")),
        invariants=(IN_WORKSPACE("hand"), *goal.lasting),
        writes={"hand": MOTION if goal.orientation is None else BODY},
        keeps=goal.keeps,
        hyperparameters=(chosen,),
        duration=duration,
        hold=True,
        policy=follow,
        taught=lambda other: make_reaching(goal, mode, other, transit),
        movement=Movement("hand", "position", 3 if transit is None else 1),
        path="hand",
        sweep=sweep,
        key_poses=partial(_key_poses, goal),
        outcome=partial(_arrive, goal),
        description=goal.description,
    )
