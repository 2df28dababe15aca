"""The continuous system of a block that brings none.

Hands obey their basic actions: a force moves the point mass of a hand, whose weight is compensated, a torque turns the
hand, and fingers close at a constant speed until they touch a handle. Every other token that the block writes is held,
pushed or at rest:

- A token is *held* if the block declares it in `attached`, or if fingers grip its handle. It moves with the hand as one
  rigid body. The hand bears the weight, and the wrist bears its torque.
- A token is *pushed* if a hand moves against it. Hand and token meet without a bounce and have the same velocity along
  the movement of the hand. The token keeps its height and its orientation.
- Otherwise, Coulomb friction stops the token.

Only properties that the block writes change.
"""

from collections.abc import Collection, Iterator, Mapping
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.model.control import Commands, ContinuousSystem
from hybrid_tamp.model.extents import extent
from hybrid_tamp.model.grasp import APERTURE, CAPTURE, FINGER_SPEED, GRIP, can_be_gripped, pass_through
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.constants import DEFAULT_FRICTION, DEFAULT_MASS, GRAVITY
from hybrid_tamp.motion.poses import cross, integrate, quaternion_conjugate, quaternion_multiply, rotate

BoolArray = NDArray[np.bool_]

_UP = np.array([0.0, 0.0, 1.0])
_TOUCH = 1e-6
"""Largest gap at which bodies touch [m]."""
_FORCE, _TORQUE = "force", "torque"


class Described(Protocol):
    """The declarations of a block from which its default system follows."""

    @property
    def writes(self) -> Mapping[str, tuple[str, ...]]:
        """Maps each slot to the properties that change."""
        ...

    @property
    def attached(self) -> Mapping[str, str]:
        """Maps the slot of a held token to the slot of its hand."""
        ...


def stay(binding: Binding, start: State) -> ContinuousSystem:
    """Return the system of an instance that moves nothing."""
    return lambda state, commands, dt: state


def make_default_system(block: Described, binding: Binding, start: State) -> ContinuousSystem:
    """Return the default system of an instance of a block. `start` is the initial state."""
    written = {slot: token for slot in block.writes if isinstance(token := binding[slot], Token)}
    hands = {slot: token for slot, token in written.items() if any(a.name == _FORCE for a in token.basic_actions)}
    things = {slot: token for slot, token in written.items() if slot not in hands}
    handles = [token for token in binding.values() if isinstance(token, Token) and can_be_gripped(token)]
    changing = {(token.name, name) for slot, token in written.items() for name in block.writes[slot]}
    moving = {(hand.name, name) for hand in hands.values() for name in ("position", "velocity")}
    if not things and moving <= changing and all(name != APERTURE for _, name in changing):
        return _drive_alone(list(hands.values()), changing)

    def system(state: State, commands: Commands, dt: float) -> State:
        step = _Step(state, commands, dt, changing)
        for slot, hand in hands.items():
            step.close_fingers(hand, handles)
            tools = [(thing, block.attached.get(name) == slot) for name, thing in things.items()]
            step.drive(hand, [(thing, declared) for thing, declared in tools if declared or pass_through(hand, thing)])
        for slot, thing in things.items():
            if slot not in block.attached:
                step.push(thing, [hand for hand in hands.values() if not pass_through(hand, thing)])
        step.move([*hands.values(), *things.values()])
        return state.replace({key: value for key, value in step.after.items() if key in changing})

    return system


def _drive_alone(hands: list[Token], changing: Collection[tuple[str, str]]) -> ContinuousSystem:
    """Return the system of hands that touch nothing (semi-implicit Euler)."""
    masses = [_mass(hand) for hand in hands]
    wrists = [hand for hand in hands if (hand.name, "orientation") in changing and has_wrist(hand)]

    def system(state: State, commands: Commands, dt: float) -> State:
        changes: dict[tuple[str, str], FloatArray] = {}
        for hand, mass in zip(hands, masses, strict=True):
            velocity = state[hand, "velocity"]
            if (force := commands.get((hand.name, _FORCE))) is not None:
                velocity = velocity + force / mass * dt
            changes[hand.name, "velocity"] = velocity
            changes[hand.name, "position"] = state[hand, "position"] + velocity * dt
        for hand in wrists:
            spin = state[hand, "angular_velocity"]
            if (torque := commands.get((hand.name, _TORQUE))) is not None:
                spin = spin + torque / _wrist_inertia(hand) * dt
            changes[hand.name, "angular_velocity"] = spin
            changes[hand.name, "orientation"] = integrate(state[hand, "orientation"], spin, dt)
        return state.replace(changes)

    return system


class _Step:
    """One time step of the default system. `after` has the new values of pairs of (token, property)."""

    def __init__(self, state: State, commands: Commands, dt: float, changing: Collection[tuple[str, str]]) -> None:
        self.state, self.commands, self.dt, self.changing = state, commands, dt, changing
        self.after: dict[tuple[str, str], FloatArray] = {}
        self.held: dict[str, list[tuple[Token, BoolArray]]] = {}

    def close_fingers(self, hand: Token, things: list[Token]) -> None:
        """Move the fingers of a hand, if it has fingers. The fingers stop at the handles of `things`."""
        if (hand.name, APERTURE) not in self.changing:
            return
        closing, aperture = self._gripping(hand), self.state[hand, APERTURE][..., 0]
        narrower = np.where(closing, np.maximum(aperture - FINGER_SPEED * self.dt, 0.0), aperture)
        for thing in things:
            width = thing["handle_width"]
            stops = closing & self._within_grasp(hand, thing) & (narrower <= width) & (width <= aperture + _TOUCH)
            narrower = np.where(stops, width, narrower)
        wider = np.minimum(aperture + FINGER_SPEED * self.dt, hand["maximal_aperture"])
        self.after[hand.name, APERTURE] = np.where(closing, narrower, wider)[..., None]

    def drive(self, hand: Token, things: list[tuple[Token, bool]]) -> None:
        """Move a hand with its load. `things` are the tokens that it may hold, and whether the block declares this."""
        state, dt = self.state, self.dt
        force, torque = self._command(hand, _FORCE), self._command(hand, _TORQUE)
        mass, inertia = np.asarray(_mass(hand)), np.asarray(_wrist_inertia(hand))
        for thing, declared in things:
            holds = np.ones(force.shape[:-1], dtype=bool) if declared else self._grips(hand, thing)
            self.held.setdefault(thing.name, []).append((hand, holds))
            mass = mass + holds[..., None] * _mass(thing)
            weight = -(holds * _mass(thing) * GRAVITY)[..., None] * _UP
            arm = state[thing, "position"] - state[hand, "position"]
            force, torque = force + weight, torque + cross(arm, weight)
            inertia = inertia + (holds * _mass(thing) * np.vecdot(arm, arm))[..., None]
        self.after[hand.name, "velocity"] = state[hand, "velocity"] + force / mass * dt
        if (hand.name, "orientation") in self.changing and has_wrist(hand):
            spin = state[hand, "angular_velocity"] + torque / inertia * dt
            self.after[hand.name, "angular_velocity"] = spin
            self.after[hand.name, "orientation"] = integrate(state[hand, "orientation"], spin, dt)

    def push(self, thing: Token, hands: list[Token]) -> None:
        """Let a token slow down by friction, and let hands push it. Changes the velocities of these hands."""
        velocity = self.state[thing, "velocity"] * np.array([1.0, 1.0, 0.0])
        speed = np.sqrt(np.vecdot(velocity, velocity))
        slower = np.maximum(speed - thing.properties.get("friction", DEFAULT_FRICTION) * GRAVITY * self.dt, 0.0)
        velocity = velocity * (slower / np.maximum(speed, 1e-12))[..., None]
        for hand in hands:
            velocity = self._meet(hand, thing, velocity)
        self.after[thing.name, "velocity"] = velocity

    def _meet(self, hand: Token, thing: Token, velocity: FloatArray) -> FloatArray:
        """Return the velocity of a token after a contact with a hand, and change the velocity of the hand."""
        moving = self.after[hand.name, "velocity"]
        level = moving * np.array([1.0, 1.0, 0.0])
        speed = np.sqrt(np.vecdot(level, level))
        along = level / np.maximum(speed, 1e-12)[..., None]
        alone = np.vecdot(velocity, along)
        offset = self.state[thing, "position"] - self.state[hand, "position"]
        sides = [
            self._gap(hand, thing, axis, offset) for axis in (cross(_UP, along), np.broadcast_to(_UP, along.shape))
        ]
        gap = self._gap(hand, thing, along, offset)
        beside = np.logical_and.reduce([side < 0.0 for side in sides])
        meets = (
            beside & (np.vecdot(offset, along) > 0.0) & (gap <= (speed - alone) * self.dt + _TOUCH) & (speed > alone)
        )
        common = (_mass(hand) * speed + _mass(thing) * alone) / (_mass(hand) + _mass(thing))
        self.after[hand.name, "velocity"] = moving + np.where(meets, common - speed, 0.0)[..., None] * along
        return np.where(meets[..., None], common[..., None] * along, velocity)

    def move(self, tokens: list[Token]) -> None:
        """Compute the new positions from the new velocities. Held tokens follow their hands."""
        for token in tokens:
            velocity = self.after.get((token.name, "velocity"), self.state[token, "velocity"])
            self.after[token.name, "position"] = self.state[token, "position"] + velocity * self.dt
        for token in tokens:
            for hand, holds in self.held.get(token.name, ()):
                for name, value in self._carried(hand, token):
                    free = self.after.get((token.name, name), self.state[token, name])
                    self.after[token.name, name] = np.where(holds[..., None], value, free)

    def _carried(self, hand: Token, thing: Token) -> Iterator[tuple[str, FloatArray]]:
        """Yield the new properties of a token that moves with a hand as one rigid body."""
        before, still = self.state[hand, "orientation"], np.zeros_like(self.state[hand, "position"])
        turned = self.after.get((hand.name, "orientation"), before)
        spin = self.after.get((hand.name, "angular_velocity"), still)
        turn = quaternion_multiply(turned, quaternion_conjugate(before))
        arm = rotate(turn, self.state[thing, "position"] - self.state[hand, "position"])
        yield "position", self.after[hand.name, "position"] + arm
        yield "orientation", quaternion_multiply(turn, self.state[thing, "orientation"])
        yield "velocity", self.after[hand.name, "velocity"] + cross(spin, arm)
        yield "angular_velocity", spin

    def _gap(self, hand: Token, thing: Token, axis: FloatArray, offset: FloatArray) -> FloatArray:
        """Return the gap ``(...)`` [m] between the extents of two bodies along an axis ``(..., 3)``."""
        side = np.where(np.vecdot(offset, axis) < 0.0, -1.0, 1.0)[..., None] * axis
        reach = extent(self.state, hand, side) + extent(self.state, thing, -side)
        return np.asarray(np.vecdot(offset, side) - reach)

    def _command(self, hand: Token, action: str) -> FloatArray:
        command = self.commands.get((hand.name, action))
        return np.zeros_like(self.state[hand, "position"]) if command is None else command

    def _gripping(self, hand: Token) -> BoolArray:
        command = self.commands.get((hand.name, GRIP))
        return (
            np.zeros(self.state.values.shape[:-1], dtype=bool) if command is None else np.asarray(command[..., 0] > 0)
        )

    def _grips(self, hand: Token, thing: Token) -> BoolArray:
        """Return whether the fingers of a hand are closed on the handle of a token, shape ``(...)``."""
        closed = self.state[hand, APERTURE][..., 0] <= thing["handle_width"] + _TOUCH
        return np.asarray(self._gripping(hand) & closed & self._within_grasp(hand, thing))

    def _within_grasp(self, hand: Token, thing: Token) -> BoolArray:
        """Return whether the centre of a hand is at the axis of the handle of a token, shape ``(...)``."""
        ends = (rotate(self.state[thing, "orientation"], np.asarray(thing[f"handle_{end}"])) for end in ("from", "to"))
        first, last = (self.state[thing, "position"] + end for end in ends)
        along, offset = last - first, self.state[hand, "position"] - first
        share = np.clip(np.vecdot(offset, along) / np.maximum(np.vecdot(along, along), 1e-12), 0.0, 1.0)
        away = offset - share[..., None] * along
        return np.asarray(np.vecdot(away, away) <= CAPTURE**2)


def has_wrist(hand: Token) -> bool:
    """Return whether a hand has a wrist, i.e. a basic action with which the hand turns."""
    return any(action.name == _TORQUE for action in hand.basic_actions)


def _wrist_inertia(hand: Token) -> float:
    return float(hand.properties.get("wrist_inertia", 1.0))


def _mass(token: Token) -> float:
    return float(token.properties.get("mass", DEFAULT_MASS))
