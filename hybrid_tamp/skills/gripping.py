"""Facts about a hand that grips objects with a handle. All blocks of a domain with a gripper share these facts."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from hybrid_tamp.model.grasp import CAPTURE, grip_limits
from hybrid_tamp.model.kind import Kind
from hybrid_tamp.model.margins import SafetyFactor
from hybrid_tamp.model.predicate import Literal, Parameter, Predicate
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.constants import GRAVITY
from hybrid_tamp.skills.alignment import ALIGNED, Alignment
from hybrid_tamp.skills.facts import within_reach
from hybrid_tamp.skills.grippers import Graspable, Gripper
from hybrid_tamp.skills.handles import (
    beside_handle,
    handle_length,
    least_extent,
    lowest_grasp,
    off_handle,
    side,
)
from hybrid_tamp.skills.predicates import at_place, competence, length_predicate, physical_bound
from hybrid_tamp.skills.roles import POSE
from hybrid_tamp.skills.vectors import point

_OPEN = 0.7
"""Smallest ratio of the gap between an empty hand's fingers to the largest gap."""
_FINGER_TOLERANCE = 1e-4
_BESIDE_TOLERANCE = 0.02
ACROSS = Alignment(lambda state, hand, thing: side(state, thing), ALIGNED)
"""A hand lies across the handle and across the direction in which the fingers close.

So the hand has the same extent ahead of the object in every grasp, whatever its initial orientation.
"""
HANDLE_ENDS = ("handle_from", "handle_to")
"""Names of the properties for the ends of a handle."""


@dataclass(frozen=True)
class Grip:
    """The facts about hands of a class that grip objects of a class. Each attribute is a predicate.

    Attributes:
        hand: class of the hands.
        thing: class of the objects.
        role: role of the object in blocks, and in the messages of the facts. The role of the hand is `hand`.
    """

    hand: type[Gripper] = Gripper
    thing: type[Graspable] = Graspable
    role: str = "object"

    @property
    def facts(self) -> tuple[Literal, ...]:
        """The feasibility facts of every grasp."""
        found = (self.liftable, self.wide_enough, self.high_enough, self.handle_within_reach)
        return tuple(fact("hand", self.role) for fact in found)

    @cached_property
    def at_handle(self) -> Predicate:
        """``at_handle`` (hand, object): the hand is beside the handle, ready to grasp it."""
        return at_place(
            "at_handle",
            self._both,
            _BESIDE_TOLERANCE,
            beside_handle,
            ACROSS,
            reads={"hand": POSE, self.role: POSE},
            description=self._say("{hand} is beside the handle of {object}"),
            denial=self._say("{hand} is not beside the handle of {object}"),
        )

    @cached_property
    def empty(self) -> Predicate:
        """``empty`` (hand): the fingers are open."""
        return length_predicate(
            "empty",
            self._both[:1],
            lambda state, hand: np.asarray(state[hand, "aperture"][..., 0] - _OPEN * hand["maximal_aperture"]),
            reads={"hand": ("aperture",)},
            description="{hand} is open and empty",
            denial="{hand} is closed or not empty",
        )

    @cached_property
    def held(self) -> Predicate:
        """``held`` (object, hand): the handle is between the fingers, and the fingers touch the handle."""
        return length_predicate(
            "held",
            self._both[::-1],
            _grip,
            reads={self.role: POSE, "hand": ("position", "aperture")},
            kind=Kind.FUNCTIONAL,
            value_of="hand",
            description=self._say("{object} is held by {hand}"),
            denial=self._say("{object} is not held by {hand}"),
        )

    @cached_property
    def liftable(self) -> Predicate:
        """``liftable`` (hand, object): the grip and the hand bear the weight of the object."""
        return physical_bound(
            "liftable",
            self._both,
            _lift,
            unit="N",
            scale=10.0,
            description=self._say("{hand} can grip hard enough to lift {object}"),
            denial=self._say("{hand} cannot grip hard enough to lift {object}"),
            safety=SafetyFactor(
                1.5,
                f"ratio of the load that the grip can bear to the weight of the {self.role}; covers acceleration",
            ),
        )

    @cached_property
    def wide_enough(self) -> Predicate:
        """``wide_enough`` (hand, object): the handle fits between the open fingers."""
        return competence(
            "wide_enough",
            self._both,
            lambda hand, thing: float(_OPEN * hand["maximal_aperture"] - thing["handle_width"]),
            description=self._say("{hand} can open wide enough for the handle of {object}"),
            denial=self._say("the handle of {object} is too wide for {hand}"),
        )

    @cached_property
    def high_enough(self) -> Predicate:
        """``high_enough`` (hand, object): there is room for a level hand below the upper end of the handle."""
        return competence(
            "high_enough",
            self._both,
            _room,
            description=self._say("the handle of {object} is high enough for {hand}"),
            denial=self._say("the handle of {object} is too low for {hand}, which would touch what {object} stands on"),
        )

    @cached_property
    def handle_within_reach(self) -> Predicate:
        """``handle_within_reach`` (hand, object): both ends of the handle are in the hand's workspace."""
        return within_reach(
            "handle_within_reach",
            self._both,
            lambda state, hand, thing: [point(state, thing, np.asarray(thing[end])) for end in HANDLE_ENDS],
            reads={self.role: POSE},
            description=self._say("the handle of {object} is inside the workspace of {hand}"),
            denial=self._say("the handle of {object} is not inside the workspace of {hand}"),
        )

    @property
    def _both(self) -> tuple[Parameter, Parameter]:
        return Parameter("hand", self.hand), Parameter(self.role, self.thing)

    def _say(self, sentence: str) -> str:
        return sentence.replace("{object}", "{" + self.role + "}")


def _grip(state: State, thing: Token, hand: Token) -> FloatArray:
    closed = _FINGER_TOLERANCE - np.abs(state[hand, "aperture"][..., 0] - thing["handle_width"])
    return np.asarray(np.minimum(closed, CAPTURE - off_handle(state, hand, thing)))


def _lift(hand: Token, thing: Token, factor: float) -> float:
    weight = factor * GRAVITY * thing["mass"]
    along = grip_limits(hand, thing, hand["maximal_grip"])[0]
    return float(min(along, hand["maximal_force"]) - weight)


def _room(hand: Token, thing: Token) -> float:
    return float(handle_length(thing) - lowest_grasp(thing, least_extent(hand)))
