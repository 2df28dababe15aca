"""Commands as one flat row per control period, and their limits."""

import math
from dataclasses import dataclass

import numpy as np

from hybrid_tamp.model.control import Commands
from hybrid_tamp.model.state import Layout
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray

_ROUNDING = 1e-9

Key = tuple[str, str]
"""(token, basic action)."""


class CommandError(ValueError):
    """An invalid command: unknown, of a wrong size, not finite or above its limit."""


@dataclass(frozen=True)
class CommandLayout(Layout):
    """The positions of the tokens' basic actions in a row of commands.

    Attributes:
        limits: largest norm of each entry's command, in the unit of the action; infinite if it has no limit.
    """

    limits: tuple[float, ...]

    @classmethod
    def of(cls, task: Task) -> "CommandLayout":
        """Return the layout of all basic actions of the tokens of the task, in their order."""
        pairs = [(token, action) for token in task.tokens for action in token.basic_actions]
        return cls(
            tuple((token.name, action.name, action.size) for token, action in pairs),
            tuple(math.inf if a.limit is None else float(token[a.limit]) for token, a in pairs),
        )

    def commands(self, row: FloatArray) -> Commands:
        """Return the commands in a row ``(size,)``."""
        return {key: row[columns] for key, columns in self.slices.items()}

    def row(self, commands: Commands) -> FloatArray:
        """Return the commands as one row ``(size,)``; missing commands are zero.

        Raises:
            CommandError: a command has an unknown token or action, or a wrong size.
        """
        row = np.zeros(self.size)
        for key, command in commands.items():
            columns = self.slices.get(key)
            if columns is None:
                known = ", ".join(f"{action} on {token}" for token, action in self.slices)
                raise CommandError(f"there is no {key[1]} on {key[0]} to command; there is {known or 'none'}")
            if np.shape(command) != (columns.stop - columns.start,):
                wanted = columns.stop - columns.start
                raise CommandError(f"{key[1]} on {key[0]} has {wanted} components, got {np.shape(command)}")
            row[columns] = command
        return row

    def limited(self, row: FloatArray) -> tuple[FloatArray, tuple[Key, ...]]:
        """Scale commands above their limits down to them.

        Returns:
            The row, and the commands that were scaled.
        """
        cut: list[Key] = []
        for key, norm, limit in self._norms(row):
            if norm > limit:
                if not cut:
                    row = row.copy()
                row[self.slices[key]] *= limit / norm
                cut.append(key)
        return row, tuple(cut)

    def checked(self, commands: Commands) -> FloatArray:
        """Return the commands as a row for a backend, which checks them again.

        Raises:
            CommandError: a command is unknown, of a wrong size, not finite or above its limit.
        """
        row = self.row(commands)
        for key, norm, limit in self._norms(row):
            if not math.isfinite(norm):
                raise CommandError(f"{key[1]} on {key[0]} is not finite")
            if norm > limit * (1 + _ROUNDING):
                raise CommandError(f"{key[1]} on {key[0]} is {norm:g}, above its limit of {limit:g}")
        return row

    def _norms(self, row: FloatArray) -> list[tuple[Key, float, float]]:
        return [
            (key, math.hypot(*row[columns].tolist()), limit)
            for (key, columns), limit in zip(self.slices.items(), self.limits, strict=True)
        ]
