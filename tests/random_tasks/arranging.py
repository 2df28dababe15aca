"""Scenes whose bodies can be moved before a task is made of them."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from hybrid_tamp.geometry.convex import Body, placed
from hybrid_tamp.geometry.overlaps import overlap
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.poses import quaternion_from_rpy, quaternion_multiply, rotate

UPRIGHT = np.array([0.0, 0.0, 0.0, 1.0])
_LEVEL = 0.5


@dataclass
class Arrangement:
    """Tokens with their poses.

    Attributes:
        tokens: the tokens.
        poses: maps the name of each token to its position ``(3,)`` [m] and its orientation ``(4,)``.
    """

    tokens: list[Token]
    poses: dict[str, tuple[np.ndarray, np.ndarray]]

    @classmethod
    def of(cls, task: Task, tokens: Iterable[Token] | None = None) -> "Arrangement":
        """Return the initial arrangement of a task, possibly with other tokens of the same names."""
        chosen = list(tokens or task.tokens)
        oriented = {token for token, name, _ in task.state.layout.entries if name == "orientation"}
        poses = {
            token.name: (
                task.state[token.name, "position"],
                task.state[token.name, "orientation"] if token.name in oriented else UPRIGHT,
            )
            for token in chosen
        }
        return cls(chosen, poses)

    def task(self, task: Task, name: str) -> Task:
        """Return a task with these tokens at rest at their poses."""
        given: dict[tuple[str, str], ArrayLike] = {}
        oriented = {token.name for token in self.tokens if any(each.name == "orientation" for each in token.varying)}
        for token, (position, orientation) in self.poses.items():
            given[token, "position"] = position
            if token in oriented:
                given[token, "orientation"] = orientation
        return task.replaced(name=name, tokens=tuple(self.tokens), state=State.of(self.tokens, given))

    def add(self, token: Token, position: np.ndarray, orientation: np.ndarray = UPRIGHT) -> None:
        """Add a token."""
        self.tokens.append(token)
        self.poses[token.name] = (position, orientation)

    def turn(self, name: str, yaw: float) -> None:
        """Turn a token about the vertical through the origin."""
        position, orientation = self.poses[name]
        spin = quaternion_from_rpy(np.array([0.0, 0.0, yaw]))
        self.poses[name] = (rotate(spin, position), quaternion_multiply(spin, orientation))

    def spin(self, name: str, yaw: float) -> None:
        """Turn a token about the vertical through its own centre."""
        position, _ = self.poses[name]
        self.turn(name, yaw)
        self.poses[name] = (position, self.poses[name][1])

    def shift(self, name: str, by: ArrayLike) -> None:
        """Move a token by a displacement ``(3,)`` [m]."""
        position, orientation = self.poses[name]
        self.poses[name] = (position + by, orientation)

    def heading(self, name: str) -> float:
        """Return the angle about the vertical [rad] of the body axis x, or of y minus 90 degrees if x is steep."""
        x, y = (rotate(self.poses[name][1], axis)[:2] for axis in np.eye(3)[:2])
        if np.linalg.norm(x) > _LEVEL:
            return float(np.arctan2(x[1], x[0]))
        return float(np.arctan2(y[1], y[0]) - np.pi / 2)

    def body(self, token: Token) -> Body:
        """Return a token as a body in the world."""
        return placed(token.solid, *self.poses[token.name])

    def is_free(self, body: Body) -> bool:
        """Return whether a body overlaps no body of the scene."""
        return all(overlap(body, self.body(token)) is None for token in self.tokens if token.shape is not None)
