"""The block CARRYING (paper, D10), in which a hand brings a tool to the place of its next use.

In mode ``push``, the tool ends upright behind the object that it will push. In mode ``strike``, the tool ends raised
above the object that it will strike. In mode ``down``, the tool ends standing at its initial place. The hand follows
the demonstrated reach and turns the tool in the high part of the reach.
"""

from collections.abc import Callable, Mapping

import numpy as np

from hybrid_tamp.authoring import (
    FLOOR,
    AffordanceClass,
    Binding,
    Block,
    Commands,
    FloatArray,
    Literal,
    Parameters,
    Policy,
    PolicyMaker,
    Slot,
    State,
    Target,
    rotate,
)
from hybrid_tamp.skills import (
    AT_REST,
    BODY,
    HORIZONTAL,
    IN_WORKSPACE,
    UP,
    Graspable,
    HeldBody,
    Region,
    Timetable,
    attitude,
    get_token,
    get_tokens,
    hand_in,
    held_system,
    lean,
    norm,
    pose_held,
    reach_over,
    side,
    standing_height,
    straight_profile,
    time_of_reach,
    yaw,
)

from .classes import DexterousHand, Pushable, Pusher, Strikable, Striker
from .feasibility import (
    ABLE_TO_PUSH,
    ABLE_TO_STRIKE,
    FIRM_ENOUGH,
    HOME,
    PUSH_WITHIN_REACH,
    SQUARE_TO,
    STRIKE_WITHIN_REACH,
)
from .geometry import RAISED, push_pose, strike_place, top
from .predicates import HELD, IN_PUSH_STANCE, IN_STRIKE_STANCE, STANDS

Pose = tuple[FloatArray, FloatArray, FloatArray]
"""Triple of (position of the hand ``(..., 3)`` [m], yaw of the tool [rad], swing angle of the tool [rad])."""
Goal = Callable[[Binding, State], Pose]

_UNSEEN = "the block uses only the initial pose of the object, so the block allows other hands to move the object"
"""Reason why the object need not stay at rest."""
_SETTLING = 0.1
_TURN = (0.3, 0.4)
"""Beginning and duration of the tool's turn, as fractions of the reach's duration."""


def _seen(object_class: type[AffordanceClass]) -> Target:
    """Return the target object. Only the object's initial position is used, so the object may move later."""
    return Target("object", object_class, reads=())


def _hand_at(binding: Binding, state: State, place: FloatArray, direction: FloatArray, angle: float) -> Pose:
    """Return the `Pose` in which a hand with its current grasp brings its tool to a place ``(..., 3)`` [m]."""
    hand, tool = get_tokens(binding, "hand", "tool")
    arm = rotate(attitude(direction, angle), hand_in(state, hand, tool))
    return place + arm, direction, np.full_like(direction, angle)


def _behind(binding: Binding, state: State) -> Pose:
    tool, thing, region = get_tokens(binding, "tool", "object", "region")
    return _hand_at(binding, state, *push_pose(state, tool, thing, region), 0.0)


def _above(binding: Binding, state: State) -> Pose:
    hand, tool, thing = get_tokens(binding, "hand", "tool", "object")
    place = strike_place(state, hand, tool, top(state, thing))
    direction = yaw(state, tool)
    return place, direction, np.full_like(direction, RAISED)


def _standing(binding: Binding, state: State) -> Pose:
    tool, region = get_tokens(binding, "tool", "region")
    place = state[region, "position"] * HORIZONTAL + standing_height(tool) * UP
    return _hand_at(binding, state, place, yaw(state, tool), 0.0)


def _policy(goal: Goal) -> PolicyMaker:
    def make(binding: Binding, start: State, parameters: Parameters) -> Policy:
        hand, tool = get_tokens(binding, "hand", "tool")
        held = HeldBody(hand, tool)
        place, direction, angle = goal(binding, start)
        duration = np.asarray(parameters.hyperparameters["duration"])
        reach = reach_over(start[hand, "position"].copy(), place, duration)
        profile, turning = straight_profile(), _TURN[1] * duration
        from_yaw, from_angle = yaw(start, tool), lean(start, tool)
        yawing = (direction - from_yaw + np.pi) % (2 * np.pi) - np.pi
        swinging = angle - from_angle

        def reference(elapsed: FloatArray) -> tuple[FloatArray, ...]:
            phase = (elapsed - _TURN[0] * duration) / turning
            done, speed = profile.share(phase), profile.rate(phase) / turning
            wanted = attitude(from_yaw + done * yawing, from_angle + done * swinging)
            return (*reach(elapsed), wanted, (speed * yawing)[..., None] * UP, (speed * swinging)[..., None])

        timetable = Timetable(reference, start)

        def policy(elapsed: FloatArray, state: State) -> Commands:
            position, velocity, wanted, yaw_rate, swing_rate = timetable(elapsed)
            spin = yaw_rate + swing_rate * side(state, tool)
            return held.servo(state, (position, velocity), (wanted, spin))

        return policy

    return make


def _carrying(
    mode: str,
    goal: Goal,
    tool_class: type[Graspable],
    targets: tuple[Target, ...],
    entry: tuple[Literal, ...],
    arrived: tuple[Literal, ...],
    description: str,
    ends: Mapping[str, tuple[str, ...]] | None = None,
) -> Block:
    def distance(binding: Binding, state: State) -> FloatArray:
        return norm(goal(binding, state)[0] - state[get_token(binding, "hand"), "position"])

    def outcome(binding: Binding, state: State) -> State:
        hand, tool = get_tokens(binding, "hand", "tool")
        place, direction, angle = goal(binding, state)
        return state.replace(pose_held(state, hand, tool, place, attitude(direction, angle)))

    chosen, duration = time_of_reach(distance, 1.2, _SETTLING)
    return Block(
        name=f"CARRYING:{mode}",
        slots=(Slot("hand", DexterousHand), Slot("tool", tool_class)),
        anchor="hand",
        targets=targets,
        entry=(HELD("tool", "hand"), *entry),
        exit=(*arrived, HELD("tool", "hand"), AT_REST("hand"), AT_REST("tool")),
        invariants=(HELD("tool", "hand"), IN_WORKSPACE("hand")),
        waived={literal: _UNSEEN for literal in entry if literal.predicate is AT_REST},
        writes={"hand": BODY, "tool": BODY},
        ends=ends or {},
        allowed_contacts=(("hand", "tool"), ("tool", FLOOR)),
        hyperparameters=(chosen,),
        duration=duration,
        hold=True,
        policy=_policy(goal),
        system=held_system("tool"),
        outcome=outcome,
        description=description,
    )


CARRYING = (
    _carrying(
        "push",
        _behind,
        Pusher,
        (_seen(Pushable), Target("region", Region)),
        (
            ABLE_TO_PUSH("hand", "tool", "object"),
            SQUARE_TO("object", "region"),
            PUSH_WITHIN_REACH("hand", "tool", "object", "region"),
            AT_REST("object"),
        ),
        (IN_PUSH_STANCE("tool", "object", "region"), ~STANDS("tool")),
        "the hand brings the upright tool to a place behind the object that it will push",
    ),
    _carrying(
        "strike",
        _above,
        Striker,
        (_seen(Strikable),),
        (
            ABLE_TO_STRIKE("hand", "tool", "object"),
            FIRM_ENOUGH("hand", "tool", "object"),
            STRIKE_WITHIN_REACH("hand", "tool", "object"),
            AT_REST("object"),
        ),
        (IN_STRIKE_STANCE("hand", "tool", "object"), ~STANDS("tool")),
        "the hand raises the tool above the object that it will strike",
    ),
    _carrying(
        "down",
        _standing,
        Graspable,
        (Target("region", Region),),
        (HOME("tool", "region"),),
        (STANDS("tool"),),
        "the hand sets the tool down at its initial place",
        ends={"tool": ("region",)},
    ),
)
