"""The continuous state of all tokens as one flat array, batch dimensions first."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray


@dataclass(frozen=True)
class Layout:
    """The positions of properties or basic actions of tokens in a flat array.

    Attributes:
        entries: (token, property or basic action, size) in order.
    """

    entries: tuple[tuple[str, str, int], ...]

    @cached_property
    def slices(self) -> Mapping[tuple[str, str], slice]:
        """(token, property or basic action) to its slice of the last axis."""
        found, start = {}, 0
        for token, name, size in self.entries:
            found[token, name] = slice(start, start + size)
            start += size
        return found

    @property
    def size(self) -> int:
        """Length of the flat array."""
        return sum(size for _, _, size in self.entries)


@dataclass(frozen=True)
class StateLayout(Layout):
    """The positions of the tokens' varying properties in the flat array."""

    @classmethod
    def of(cls, tokens: Iterable[Token]) -> "StateLayout":
        """Return the layout of the varying properties of the tokens, in their order."""
        return cls(tuple((t.name, varying.name, varying.size) for t in tokens for varying in t.varying))


@dataclass(frozen=True, eq=False)
class State:
    """Varying properties of all tokens; `values` has shape ``(..., layout.size)``.

    Read with ``state[token, "position"]``, of shape ``(..., 3)``; change with `replace`, which copies.
    """

    layout: StateLayout
    values: FloatArray

    @classmethod
    def of(cls, tokens: Iterable[Token], given: Mapping[tuple[str, str], ArrayLike]) -> "State":
        """Make a state from the tokens' defaults and the given values.

        Args:
            tokens: all tokens of the task.
            given: (token, property) to values of shape ``(size,)``.
        """
        tokens = tuple(tokens)
        layout = StateLayout.of(tokens)
        values = np.concatenate(
            [np.asarray(varying.default, dtype=float) for t in tokens for varying in t.varying] or [np.zeros(0)]
        )
        return cls(layout, values).replace(given)

    def __getitem__(self, key: tuple[Token | str, str]) -> FloatArray:
        """Return a view ``(..., size)`` of one property of one token."""
        token, name = key
        return self.values[..., self.layout.slices[token if isinstance(token, str) else token.name, name]]

    def replace(self, changes: Mapping[tuple[str, str], ArrayLike]) -> "State":
        """Return a copy with the given (token, property) values, each broadcast to ``(..., size)``."""
        values = self.values.copy()
        for key, value in changes.items():
            values[..., self.layout.slices[key]] = value
        return State(self.layout, values)

    def repeated(self, count: int) -> "State":
        """Return `count` copies along a new leading batch axis."""
        return State(self.layout, np.tile(self.values, (count,) + (1,) * self.values.ndim))
