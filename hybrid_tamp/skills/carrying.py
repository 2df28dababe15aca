"""Maker of blocks in which a hand brings the object that it holds to a pose, e.g. to set it down (paper, D10).

The hand follows the demonstrated reach, and turns the object in the high part of the reach.
"""

from collections.abc import Callable

import numpy as np

from hybrid_tamp.model.block import FLOOR, Block, Outcome, Slot, Target
from hybrid_tamp.model.control import Commands, Parameters, Policy, PolicyMaker
from hybrid_tamp.model.course import Course, SweepMaker, sample_times
from hybrid_tamp.model.predicate import Binding, Literal, Parameter, Predicate, Value
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import rotate
from hybrid_tamp.skills.extents import top_of
from hybrid_tamp.skills.grippers import Graspable
from hybrid_tamp.skills.gripping import HANDLE_ENDS, Grip
from hybrid_tamp.skills.handles import attitude, hand_in, lean, side, standing_height, yaw
from hybrid_tamp.skills.holding import HeldBody, held_system, pose_held, sweep_held
from hybrid_tamp.skills.paths import follow_path
from hybrid_tamp.skills.predicates import AT_REST, IN_WORKSPACE, competence
from hybrid_tamp.skills.primitives import advance, reach_over, straight_profile
from hybrid_tamp.skills.reaching import time_of_reach
from hybrid_tamp.skills.roles import BODY, POSE, get_token, get_tokens
from hybrid_tamp.skills.timetable import Reference, Timetable
from hybrid_tamp.skills.vectors import HORIZONTAL, UP, depth_in_workspace, norm, point

HeldPose = tuple[FloatArray, FloatArray, FloatArray]
"""Position ``(..., 3)`` [m] of a hand, and yaw ``(...)`` [rad] and lean ``(...)`` [rad] of the object that it holds."""
Goal = Callable[[Binding, State], HeldPose]
"""``goal(binding, state)`` returns the pose to which a hand brings the object that it holds."""

_TURN = (0.3, 0.4)
"""Beginning and duration of the object's turn, as fractions of the reach's duration."""
_UNSEEN = "the block uses only the initial pose of the object, so the block allows other hands to move the object"
"""Reason why a target need not stay at rest."""


def bring_to(
    state: State, hand: Token, thing: Token, place: FloatArray, direction: FloatArray, angle: float = 0.0
) -> HeldPose:
    """Return the pose in which a hand with its current grasp brings its object to a place.

    Args:
        state: current state.
        hand: hand that holds the object.
        thing: the object.
        place: position of the object's centre ``(..., 3)`` [m].
        direction: yaw of the object ``(...)`` [rad].
        angle: lean of the object [rad]. The object stands if the lean is 0.
    """
    arm = rotate(attitude(direction, angle), hand_in(state, hand, thing))
    return place + arm, direction, np.full_like(direction, angle)


def stand_at(place: str, role: str = "object") -> Goal:
    """Return the goal that the object of a role stands at the middle of a place, with its present yaw.

    A place with a shape is a level surface. A place without a shape is on the floor. The goal returns the position
    ``(..., 3)`` [m] of the hand, and the yaw ``(...)`` [rad] and lean ``(...)`` [rad] of the object.
    """

    def goal(binding: Binding, state: State) -> HeldPose:
        hand, thing, where = get_tokens(binding, "hand", role, place)
        ground = 0.0 if where.shape is None else top_of(state, where)
        up = np.asarray(ground + standing_height(thing))[..., None] * UP
        return bring_to(state, hand, thing, state[where, "position"] * HORIZONTAL + up, yaw(state, thing))

    return goal


def make_carrying(
    name: str,
    grip: Grip,
    goal: Goal,
    arrived: tuple[Literal, ...],
    targets: tuple[Target, ...] = (),
    feasible: tuple[Literal, ...] | None = None,
    entry: tuple[Literal, ...] = (),
    thing: type[Graspable] | None = None,
    ends: tuple[str, ...] = (),
    description: str = "the hand carries the object to its next place",
) -> Block:
    """Return a block in which a hand carries an object. Its slots are `hand` and the role of the grip.

    Args:
        name: name of the block, e.g. ``"CARRYING:down"``.
        grip: the facts about the hands and the objects.
        goal: ``goal(binding, state)`` returns the final position ``(..., 3)`` [m] of the hand, and the final yaw
            ``(...)`` [rad] and lean ``(...)`` [rad] of the object.
        arrived: exit conditions in addition to the grip and to the rest of hand and object.
        targets: roles that determine the goal, e.g. a surface. Use ``reads=()`` for a target that may move meanwhile.
        feasible: feasibility facts of the goal. The default is that the hand stays in its workspace at the goal, with
            at least one grasp (`goal_within_reach`).
        entry: further entry conditions.
        thing: class of the carried objects. The default is the class of the grip.
        ends: targets that determine the final pose of the object, together with its initial pose (see `Block.ends`).
        description: description of the block in one line.
    """
    role = grip.role
    held = grip.held(role, "hand")
    if feasible is None:
        feasible = (_goal_within_reach(grip, goal, targets)("hand", role, *(target.name for target in targets)),)

    chosen, duration = time_of_reach(_way(goal), 1.2)
    return Block(
        name=name,
        slots=(Slot("hand", grip.hand), Slot(role, thing or grip.thing)),
        anchor="hand",
        targets=targets,
        entry=(held, *feasible, *entry),
        exit=(*arrived, held, AT_REST("hand"), AT_REST(role)),
        invariants=(held, IN_WORKSPACE("hand")),
        waived={literal: _UNSEEN for literal in entry if literal.predicate is AT_REST},
        writes={"hand": BODY, role: BODY},
        ends={role: ends} if ends else {},
        allowed_contacts=(("hand", role), (role, FLOOR)),
        hyperparameters=(chosen,),
        duration=duration,
        hold=True,
        policy=_follow(goal, role),
        sweep=_sweep(goal, role),
        path="hand",
        system=held_system(role),
        outcome=_outcome(goal, role),
        description=description,
    )


def _way(goal: Goal) -> Callable[[Binding, State], FloatArray]:
    """Return a function for the distance ``(...)`` [m] of a hand from its place at the goal."""
    return lambda binding, state: norm(goal(binding, state)[0] - state[get_token(binding, "hand"), "position"])


def _outcome(goal: Goal, role: str) -> Outcome:
    def reached(binding: Binding, state: State) -> State:
        hand, thing = get_tokens(binding, "hand", role)
        place, direction, angle = goal(binding, state)
        return state.replace(pose_held(state, hand, thing, place, attitude(direction, angle)))

    return reached


def _goal_within_reach(grip: Grip, goal: Goal, targets: tuple[Target, ...]) -> Predicate:
    """Return the fact that a hand which holds either end of the handle stays in its workspace at the goal."""
    names = ("hand", grip.role, *(target.name for target in targets))
    sorts = (grip.hand, grip.thing, *(target.sort for target in targets))

    def margin(state: State, hand: Token, thing: Token, *values: Value) -> FloatArray:
        binding = dict(zip(names, (hand, thing, *values), strict=True))
        ends = (point(state, thing, np.asarray(thing[end])) for end in HANDLE_ENDS)
        places = (goal(binding, state.replace({(hand.name, "position"): end}))[0] for end in ends)
        return np.asarray(np.max([depth_in_workspace(hand, place) for place in places], axis=0))

    return competence(
        "goal_within_reach",
        tuple(map(Parameter, names, sorts)),
        margin,
        reads={grip.role: POSE} | {target.name: target.reads for target in targets if target.reads},
        description=f"{{hand}} can bring {{{grip.role}}} to its goal without leaving the workspace of the hand",
        denial=f"{{hand}} cannot bring {{{grip.role}}} to its goal without leaving the workspace of the hand",
    )


def _plan(
    goal: Goal, role: str, binding: Binding, start: State, parameters: Parameters
) -> tuple[Reference, FloatArray]:
    """Return the reference of the hand and its object, and the duration ``(...)`` [s] of the movement.

    The reference returns the hand's position [m] and velocity [m/s], the object's orientation, the angular velocity
    of the object about the vertical [rad/s], and the rate of its lean [rad/s].
    """
    hand, thing = get_tokens(binding, "hand", role)
    place, direction, angle = goal(binding, start)
    origin, duration = start[hand, "position"].copy(), np.asarray(parameters.hyperparameters["duration"])
    if parameters.path is None:
        reach = reach_over(origin, place, duration)
    else:
        reach, _, duration = follow_path(origin, parameters.path, place, duration)
    profile, turning = straight_profile(), _TURN[1] * duration
    from_yaw, from_lean = yaw(start, thing), lean(start, thing)
    yawing = (direction - from_yaw + np.pi) % (2 * np.pi) - np.pi
    leaning = angle - from_lean

    def reference(elapsed: FloatArray) -> tuple[FloatArray, ...]:
        done, speed = advance(profile, elapsed - _TURN[0] * duration, turning)
        wanted = attitude(from_yaw + done * yawing, from_lean + done * leaning)
        return (*reach(elapsed), wanted, (speed * yawing)[..., None] * UP, (speed * leaning)[..., None])

    return reference, duration


def _sweep(goal: Goal, role: str) -> SweepMaker:
    """Return the maker of the course of the hand and the object that it holds."""

    def sweep(binding: Binding, start: State, parameters: Parameters) -> Course:
        hand, thing = get_tokens(binding, "hand", role)
        reference, duration = _plan(goal, role, binding, start, parameters)
        places, _, attitudes, *_ = reference(sample_times(duration))
        return Course.through(start, sweep_held(start, hand, thing, places, attitudes))

    return sweep


def _follow(goal: Goal, role: str) -> PolicyMaker:
    """Return the maker of the policy that moves the hand along the reach and turns the object."""

    def make(binding: Binding, start: State, parameters: Parameters) -> Policy:
        hand, thing = get_tokens(binding, "hand", role)
        held = HeldBody(hand, thing)
        timetable = Timetable(_plan(goal, role, binding, start, parameters)[0], start)

        def policy(elapsed: FloatArray, state: State) -> Commands:
            position, velocity, wanted, yaw_rate, lean_rate = timetable(elapsed)
            spin = yaw_rate + lean_rate * side(state, thing)
            return held.servo(state, (position, velocity), (wanted, spin))

        return policy

    return make
