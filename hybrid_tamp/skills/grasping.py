"""Maker of the blocks with which a hand takes and releases an object: REACHING, GRASPING (paper, D7), RELEASING (D11).

The hand waits beside the handle, moves to a place on the handle and closes its fingers. The object stands meanwhile.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from hybrid_tamp.model.block import FLOOR, Block, Duration, Slot, Target
from hybrid_tamp.model.control import Commands, Hyperparameter, Hyperparameters, Parameters, Policy, PolicyMaker
from hybrid_tamp.model.course import Course, SweepMaker, sample_times
from hybrid_tamp.model.measure import Measure
from hybrid_tamp.model.predicate import Binding, Literal
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.skills.extents import height_below
from hybrid_tamp.skills.gripping import ACROSS, Grip
from hybrid_tamp.skills.handles import (
    beside_handle,
    handle_length,
    least_extent,
    location_on_handle,
    lowest_grasp,
    on_handle,
)
from hybrid_tamp.skills.predicates import AT_REST, IN_WORKSPACE
from hybrid_tamp.skills.primitives import Reference, move_straight
from hybrid_tamp.skills.reaching import ReachGoal, make_reaching
from hybrid_tamp.skills.roles import MOTION, get_token, get_tokens
from hybrid_tamp.skills.servos import hand_servo
from hybrid_tamp.skills.timetable import Timetable
from hybrid_tamp.skills.vectors import point

_APPROACH = 0.8
"""Duration of the hand's movement from its waiting position to the grasp location [s]."""
_CLOSES_AFTER = 0.95
"""Elapsed time at which the hand, which is then at rest, begins to close [s]."""
_OPENING = 0.3
"""Time in which the fingers open before the hand moves away [s]."""
_LEAVING = 0.8
"""Duration of the movement away from the handle [s]."""


def make_grasping(grip: Grip, stands: Literal, *targets: Target) -> tuple[Block, Block, Block]:
    """Return the blocks ``REACHING:handle``, GRASPING and RELEASING. Their slots are `hand` and the grip's role.

    The hyperparameter `grasp_location` is the place of the grasp on the handle. The measure `contact` is the fraction
    of the fingers' pads that touches the handle.

    Args:
        grip: the facts about the hands and the objects.
        stands: condition that the object stands. The condition must hold before the grasp and after the release.
        *targets: roles in `stands`, e.g. the surface on which the object stands.
    """
    return (
        make_reaching(_reach(grip, stands, targets), "handle"),
        _grasp(grip, stands, targets),
        _release(grip, stands, targets),
    )


def _reach(grip: Grip, stands: Literal, targets: tuple[Target, ...]) -> ReachGoal:
    still = (grip.empty("hand"), stands, AT_REST(grip.role))
    return ReachGoal(
        targets=(Target(grip.role, grip.thing), *targets),
        position=lambda binding, state: beside_handle(state, *get_tokens(binding, "hand", grip.role)),
        entry=(*grip.facts, *still),
        arrived=(grip.at_handle("hand", grip.role),),
        lasting=still,
        hand_class=grip.hand,
        orientation=lambda binding, state: ACROSS.orientation(state, *get_tokens(binding, "hand", grip.role)),
        # Only an empty hand can reach, so no hand leaves an object behind.
        keeps=(grip.held,),
    )


def _at_the_handle(name: str, grip: Grip, stands: Literal, targets: tuple[Target, ...], **told: Any) -> Block:
    """Return a block in which a hand moves near the handle of an object that stands."""
    return Block(
        name=name,
        slots=(Slot("hand", grip.hand), Slot(grip.role, grip.thing)),
        anchor="hand",
        targets=targets,
        invariants=(IN_WORKSPACE("hand"), stands),
        writes={"hand": (*MOTION, "aperture")},
        allowed_contacts=(("hand", grip.role), (grip.role, FLOOR)),
        **told,
    )


def _grasp(grip: Grip, stands: Literal, targets: tuple[Target, ...]) -> Block:
    role = grip.role
    return _at_the_handle(
        "GRASPING",
        grip,
        stands,
        targets,
        entry=(*grip.facts, grip.at_handle("hand", role), grip.empty("hand"), stands, AT_REST(role)),
        exit=(grip.held(role, "hand"), ~grip.empty("hand"), AT_REST("hand")),
        waived={AT_REST(role): f"the fingers may shake the {role} when they close"},
        hyperparameters=(_grasp_location(role),),
        duration=Duration(_APPROACH, 5.0),
        hold=True,
        policy=_closing(role),
        sweep=_sweep(partial(_approach, role), _APPROACH),
        performance=(_contact(role),),
        description="the hand moves to the grasp location and closes on the handle",
    )


def _grasp_location(role: str) -> Hyperparameter:
    def middle(binding: Binding, state: State) -> FloatArray:
        """Return the middle of the handle, or a higher place if the middle is too low for the hand."""
        hand, thing = get_tokens(binding, "hand", role)
        return np.maximum(handle_length(thing) / 2, lowest_grasp(thing, height_below(state, hand)))

    def bounds(binding: Binding) -> tuple[float, float]:
        hand, thing = get_tokens(binding, "hand", role)
        lowest = float(lowest_grasp(thing, least_extent(hand)))
        return min(max(0.0, lowest), handle_length(thing)), handle_length(thing)

    description = "distance of the grasp from handle_to, along the handle"
    return Hyperparameter("grasp_location", "m", 0.0, 100.0, middle, description, bounds)


def _contact(role: str) -> Measure:
    def share(binding: Binding, before: State, after: State, hyperparameters: Hyperparameters) -> FloatArray:
        hand, thing = get_tokens(binding, "hand", role)
        place, half = location_on_handle(after, hand, thing), hand["contact_width"] / 2
        touching = np.minimum(place + half, handle_length(thing)) - np.maximum(place - half, 0.0)
        return np.asarray(np.clip(touching / hand["contact_width"], 0.0, 1.0))

    return Measure("contact", "1", 1.0, end=share, description="fraction of contact_width that touches the handle")


_Way = Callable[[Binding, State, Parameters], Reference]
"""``way(binding, start, parameters)`` returns the reference of the hand's position."""


def _sweep(way: _Way, duration: float) -> SweepMaker:
    def sweep(binding: Binding, start: State, parameters: Parameters) -> Course:
        positions, _ = way(binding, start, parameters)(sample_times(duration))
        return Course.through(start, {(get_token(binding, "hand").name, "position"): positions})

    return sweep


def _approach(role: str, binding: Binding, start: State, parameters: Parameters) -> Reference:
    hand, thing = get_tokens(binding, "hand", role)
    origin, place = start[hand, "position"].copy(), on_handle(thing, parameters.hyperparameters["grasp_location"])
    return move_straight(origin, point(start, thing, place) - origin, _APPROACH)


def _leave(role: str, binding: Binding, start: State, parameters: Parameters) -> Reference:
    hand, thing = get_tokens(binding, "hand", role)
    origin = start[hand, "position"].copy()
    return move_straight(origin, beside_handle(start, hand, thing) - origin, _LEAVING, _OPENING)


def _closing(role: str) -> PolicyMaker:
    def make(binding: Binding, start: State, parameters: Parameters) -> Policy:
        hand = get_token(binding, "hand")
        servo, grip = hand_servo(hand, start), hand["maximal_grip"]
        timetable = Timetable(_approach(role, binding, start, parameters), start)

        def policy(elapsed: FloatArray, state: State) -> Commands:
            closing = np.where(elapsed > _CLOSES_AFTER, grip, 0.0)
            gripping = np.broadcast_to(closing[..., None], state[hand, "aperture"].shape)
            return servo(state, *timetable(elapsed)) | {(hand.name, "grip"): gripping}

        return policy

    return make


def _release(grip: Grip, stands: Literal, targets: tuple[Target, ...]) -> Block:
    role = grip.role
    return _at_the_handle(
        "RELEASING",
        grip,
        stands,
        targets,
        entry=(grip.held(role, "hand"), stands),
        # The object must not fall over when the hand opens.
        exit=(~grip.held(role, "hand"), grip.empty("hand"), stands, AT_REST("hand"), AT_REST(role)),
        duration=Duration(_OPENING + _LEAVING, 5.0),
        policy=_opening(role),
        sweep=_sweep(partial(_leave, role), _OPENING + _LEAVING),
        description=f"the hand opens and moves away, and the {role} remains standing",
    )


def _opening(role: str) -> PolicyMaker:
    def make(binding: Binding, start: State, parameters: Parameters) -> Policy:
        servo = hand_servo(get_token(binding, "hand"), start)
        timetable = Timetable(_leave(role, binding, start, parameters), start)

        def policy(elapsed: FloatArray, state: State) -> Commands:
            return servo(state, *timetable(elapsed))

        return policy

    return make
