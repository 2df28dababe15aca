"""Check the initial poses of a task file against the floor, the other tokens and the tokens' classes."""

from typing import Any

import numpy as np

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.geometry.convex import CONTACT, Body, lowest_height, placed
from hybrid_tamp.geometry.overlaps import overlaps
from hybrid_tamp.model.authored import authored
from hybrid_tamp.model.grasp import pass_through
from hybrid_tamp.model.state import State
from hybrid_tamp.model.support import find_floating, with_grounds
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.taskfile.places import Faults, KeyPath, shown
from hybrid_tamp.taskfile.roles import is_capability
from hybrid_tamp.taskfile.tokens import Scene
from hybrid_tamp.taskfile.wording import subject


def check_starts(data: dict[str, Any], faults: Faults, scene: Scene) -> None:
    """Record each token that starts below the floor, inside another token or in a pose that its classes do not allow.

    Args:
        data: the plain data of the file.
        faults: the faults found so far. Tokens with a fault are skipped.
        scene: the tokens.
    """
    sound, state = _sound(data, faults, scene)
    bodies = [
        (token, placed(token.shape, state[token, "position"], state[token, "orientation"]))
        for token in sound
        if token.shape is not None
    ]
    whole = faults.sound(("tokens",))
    for token, body in bodies:
        _check_floor(token, body, faults)
    _check_overlaps(bodies, faults)
    if whole:
        for token in sound:
            _check_classes(token, state, scene, faults)


def put_on_grounds(data: dict[str, Any], faults: Faults, scene: Scene) -> None:
    """Add to the tokens of a scene what they rest on, and what rests on them. Tokens with a fault are left out."""
    sound, state = _sound(data, faults, scene)
    changed = {token.name: token for token in with_grounds(sound, state)}
    scene.tokens = [changed.get(token.name, token) for token in scene.tokens]


def check_still(task: Task) -> None:
    """Check that no fixed body of a task has a velocity. In a task file, no body can have an initial velocity.

    Raises:
        InputError: a fixed body has a velocity; the issues list all of them.
    """
    moving = [
        Issue(f"token {token.name}", f"a fixed body must have no {name}", f"{np.linalg.norm(value):.3g} {unit}")
        for token in task.tokens
        if token.fixed_body
        for name, unit in (("velocity", "m/s"), ("angular_velocity", "rad/s"))
        if (token.name, name) in task.state.layout.slices and np.any(value := task.state[token, name])
    ]
    if moving:
        raise InputError(moving)


def _sound(data: dict[str, Any], faults: Faults, scene: Scene) -> tuple[list[Token], State]:
    """Return the tokens without faults that have a pose, and the state of all tokens."""
    sound = [t for t in scene.tokens if faults.sound(("tokens", t.name)) and data["tokens"][t.name].get("pose")]
    names = {token.name for token in scene.tokens}
    return sound, State.of(scene.tokens, {key: value for key, value in scene.given.items() if key[0] in names})


def _path(token: Token) -> KeyPath:
    return ("tokens", token.name, "pose", "position")


def _check_floor(token: Token, body: Body, faults: Faults) -> None:
    """Record a fault if a body is below the floor, which is the plane z = 0."""
    lowest = lowest_height(body)
    if lowest < -CONTACT:
        wanted = f"{subject(_path(token))} must place the token above the floor (z = 0)"
        came = f"a lowest point at z = {_metres(lowest)} m"
        faults.at(_path(token), wanted, came, remedy=f"raise the token by {_metres(-lowest)} m")


def _check_overlaps(bodies: list[tuple[Token, Body]], faults: Faults) -> None:
    # Report the later of two overlapping tokens as the token to move. Hands come last, so messages move hands.
    ordered = sorted(bodies, key=lambda body: is_capability(body[0]))

    def may_share(earlier: int, later: int) -> bool:
        one, other = ordered[earlier][0], ordered[later][0]
        return pass_through(one, other) or (one.immovable and other.immovable)

    for earlier, later, way in overlaps([body for _, body in ordered], may_share):
        one, other = ordered[earlier][0], ordered[later][0]
        wanted = f"{subject(_path(other))} must not overlap other tokens"
        came = f"an overlap with token {shown(one.name)}{faults.on_line(_path(one), 'whose position is')}"
        faults.at(_path(other), wanted, came, remedy=f"move token {shown(other.name)} by {_vector(way)} m")


def _check_classes(token: Token, state: State, scene: Scene, faults: Faults) -> None:
    if token.bystander and not token.immovable:
        complaint = find_floating(token, state, scene.tokens)
        if complaint is not None:
            came = f"{complaint}; if nothing moves the body, write 'fixed: true'"
            faults.at(_path(token)[:-1], f"{subject(_path(token)[:-1])} is not valid: {came}", key=True)
    for member in token.classes:
        if not faults.sound(_path(token)):
            continue
        with authored(f"{member.name}.consistent_start", {"token": token}):
            complaint = member.consistent_start(token, state, scene.tokens)
        if complaint is not None:
            faults.at(_path(token)[:-1], f"{subject(_path(token)[:-1])} is not valid: {complaint}", key=True)


def _metres(length: float) -> str:
    return f"{round(length, 4):g}"


def _vector(way: FloatArray) -> str:
    """Return a vector [m] as text. Components are rounded away from zero to 0.1 mm, so that the move suffices."""
    rounded = np.copysign(np.ceil(np.abs(way) * 1e4 - 1e-6) / 1e4, way)
    return f"[{', '.join(f'{component + 0.0:g}' for component in rounded)}]"
