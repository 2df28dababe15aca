"""Forward model that all modes of TIPPING share: a rigid box that two hands turn about an edge on the floor."""

import numpy as np

from hybrid_tamp.authoring import (
    GRAVITY,
    Binding,
    Commands,
    ContinuousSystem,
    FloatArray,
    State,
    cross,
    integrate,
    quaternion_from_axis_angle,
    rotate,
)
from hybrid_tamp.skills import NORMALS, contact_distance, dot, force_on, half_extent, meet_face, turn_hand

from .turning import Roles


def turning_system(binding: Binding, start: State) -> ContinuousSystem:
    """Return the system of a rigid box that turns about a fixed edge until the floor stops it.

    The box does not move until both hands touch it. Then the forces of the hands and the weight of the box turn the
    hands and the box about the edge as one body.
    """
    roles = Roles.of(binding)
    thing = roles.thing
    hands = [(hand, contact_distance(thing, face) + hand["radius"]) for hand, face in roles.contacts]
    sides = [half_extent(thing, face) for face in roles.edge]
    own_inertia = np.asarray(thing["mass"] * 4.0 / 3.0 * (sides[0] ** 2 + sides[1] ** 2))
    weight, body = np.array([0.0, 0.0, -GRAVITY * thing["mass"]]), _body_vectors(roles)

    def system(state: State, commands: Commands, dt: float) -> State:
        turned = rotate(state[thing, "orientation"][..., None, :], body)
        arm, axis = -turned[..., 0, :], turned[..., 1, :]
        pivot = state[thing, "position"] - arm
        inertia, moment, touching = own_inertia, dot(cross(arm, weight), axis), np.asarray(True)
        levers, free = [], []
        for index, (hand, touches_at) in enumerate(hands):
            lever, outward = state[hand, "position"] - pivot, turned[..., index + 4, :]
            velocity, touches = meet_face(state, hand, outward, dot(lever - arm, outward) - touches_at, commands, dt)
            levers.append(lever)
            free.append(velocity)
            touching = touching & touches
            inertia = inertia + hand["mass"] * dot(lever, lever)
            moment = moment + dot(cross(lever, force_on(hand, state, commands)), axis)
        speed = np.where(touching, dot(state[thing, "angular_velocity"], axis) + moment / inertia * dt, 0.0)
        angle, still = _turn_to_floor(turned, speed * dt)
        spin = axis * (angle / dt)[..., None]
        turn = quaternion_from_axis_angle(axis, angle, unit=True)
        carried = rotate(turn[..., None, :], np.stack([*levers, arm], axis=-2))
        changes: dict[tuple[str, str], FloatArray] = {}
        for index, (hand, _) in enumerate(hands):
            velocity = np.where(touching[..., None], (carried[..., index, :] - levers[index]) / dt, free[index])
            changes[hand.name, "velocity"] = velocity
            changes[hand.name, "position"] = state[hand, "position"] + velocity * dt
            changes |= turn_hand(hand, state, commands, dt)
        changes[thing.name, "orientation"] = integrate(state[thing, "orientation"], spin, dt)
        changes[thing.name, "position"] = pivot + carried[..., -1, :]
        changes[thing.name, "angular_velocity"] = spin * still
        changes[thing.name, "velocity"] = cross(spin, arm) * still
        return state.replace(changes)

    return system


def _turn_to_floor(turned: FloatArray, wanted: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the angle [rad] by which the box turns in a step, and 0 if the floor stops the box, or else 1.

    If the floor stops the box, the step ends exactly on the floor, with zero speed.
    """
    angle = np.arctan2(-turned[..., 2, 2], -turned[..., 3, 2])
    after = np.clip(angle + wanted, 0.0, np.pi / 2)
    return after - angle, np.where(np.abs(after - angle - wanted) > 1e-12, 0.0, 1.0)[..., None]


def _body_vectors(roles: Roles) -> FloatArray:
    """Return vectors in the body frame of the box, which a step turns at once. Shape ``(6, 3)``.

    The vectors are the position of the edge [m], the axis of the turn, and the normals of the second face and of the
    first face beside the edge, of the near face and of the far face.
    """
    down, forward = roles.edge
    middle = NORMALS[down] * half_extent(roles.thing, down) + NORMALS[forward] * half_extent(roles.thing, forward)
    axis = cross(NORMALS[forward], NORMALS[down])
    return np.array([middle, axis, NORMALS[forward], NORMALS[down], *(NORMALS[face] for _, face in roles.contacts)])
