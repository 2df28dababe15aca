"""Flat arrays of commands with one row for each control period, and the limits of commands."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from hybrid_tamp.model.control import Commands
from hybrid_tamp.model.state import Layout
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray

_ROUNDING = 1e-9

Key = tuple[str, str]
"""Pair of (token, basic action)."""


class CommandError(ValueError):
    """Error for a command that is unknown, of a wrong size, not finite or above its limit."""


@dataclass(frozen=True)
class CommandLayout(Layout):
    """Layout of a row that stores the commands of all basic actions.

    Attributes:
        limits: largest norm of each entry's command, in the unit of the action. Infinite if the action has no limit.
    """

    limits: tuple[float, ...]

    @classmethod
    def of(cls, task: Task) -> "CommandLayout":
        """Return the layout of the basic actions of a task, in the order of the tokens."""
        pairs = [(token, action) for token in task.tokens for action in token.basic_actions]
        return cls(
            tuple((token.name, action.name, action.size) for token, action in pairs),
            tuple(math.inf if a.limit is None else float(token[a.limit]) for token, a in pairs),
        )

    def commands(self, row: FloatArray) -> Commands:
        """Return the commands that a row of shape ``(size,)`` stores."""
        return {key: row[columns] for key, columns in self.slices.items()}

    def row(self, commands: Commands) -> FloatArray:
        """Return the commands as a row of shape ``(size,)``. Missing commands are zero.

        Raises:
            CommandError: if a command has an unknown token or action, or a wrong size.
        """
        row = np.zeros(self.size)
        places = self._places
        for key, command in commands.items():
            if key not in places:
                known = ", ".join(f"{action} on {token}" for token, action in self.slices)
                raise CommandError(f"cannot command {key[1]} on {key[0]}; available: {known or 'none'}")
            columns, wanted = places[key]
            shape = command.shape if isinstance(command, np.ndarray) else np.shape(command)
            if shape != wanted:
                raise CommandError(f"command {key[1]} on {key[0]} must have shape {wanted}, got {shape}")
            row[columns] = command
        return row

    def limited(self, row: FloatArray) -> tuple[FloatArray, tuple[Key, ...]]:
        """Scale down each command that exceeds its limit.

        Returns:
            The row with scaled commands, and the keys of the commands that were scaled.
        """
        cut: list[Key] = []
        for key, norm, limit in self._norms(row.tolist()):
            if norm > limit:
                if not cut:
                    row = row.copy()
                row[self.slices[key]] *= limit / norm
                cut.append(key)
        return row, tuple(cut)

    def checked(self, commands: Commands) -> FloatArray:
        """Return the commands as a row, after checking all of them.

        Raises:
            CommandError: if a command is unknown, of a wrong size, not finite or above its limit.
        """
        row = self.row(commands)
        for key, norm, limit in self._norms(row.tolist()):
            if not math.isfinite(norm):
                raise CommandError(f"command {key[1]} on {key[0]} must be finite, got {norm:g}")
            if norm > limit * (1 + _ROUNDING):
                raise CommandError(f"command {key[1]} on {key[0]} must not exceed its limit of {limit:g}, got {norm:g}")
        return row

    def _norms(self, row: list[float]) -> list[tuple[Key, float, float]]:
        # Plain numbers are faster than arrays of three numbers.
        return [(key, math.hypot(*row[columns]), limit) for key, columns, limit in self._bounded]

    @cached_property
    def _places(self) -> dict[Key, tuple[slice, tuple[int]]]:
        """Maps each pair of (token, basic action) to its slice of the row and to the shape of its command."""
        return {key: (columns, (columns.stop - columns.start,)) for key, columns in self.slices.items()}

    @cached_property
    def _bounded(self) -> tuple[tuple[Key, slice, float], ...]:
        return tuple(
            (key, columns, limit) for (key, columns), limit in zip(self.slices.items(), self.limits, strict=True)
        )
