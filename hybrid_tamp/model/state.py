"""The continuous state of all tokens as one flat array with leading batch dimensions."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from hybrid_tamp.model.token import Token, UnknownProperty, UnknownTarget, UnknownToken
from hybrid_tamp.motion.arrays import FloatArray


@dataclass(frozen=True)
class Layout:
    """Layout of a flat array that stores properties or basic actions of tokens.

    Attributes:
        entries: triples of (token, property or basic action, number of components), in the order of the array.
    """

    entries: tuple[tuple[str, str, int], ...]

    @cached_property
    def slices(self) -> Mapping[tuple[str, str], slice]:
        """Maps each pair of (token, property or basic action) to its slice of the array's last axis."""
        found, start = {}, 0
        for token, name, size in self.entries:
            found[token, name] = slice(start, start + size)
            start += size
        return found

    @cached_property
    def size(self) -> int:
        """Length of the last axis of the flat array."""
        return sum(size for _, _, size in self.entries)


@dataclass(frozen=True)
class StateLayout(Layout):
    """Layout of a flat array that stores the varying properties of tokens."""

    @classmethod
    def of(cls, tokens: Iterable[Token]) -> "StateLayout":
        """Return the layout for the varying properties of the tokens, in the order of the tokens."""
        return cls(tuple((t.name, varying.name, varying.size) for t in tokens for varying in t.varying))


@dataclass(frozen=True, eq=False)
class State:
    """The varying properties of all tokens, as `values` of shape ``(..., layout.size)``.

    ``state[token, "position"]`` returns a position, shape ``(..., 3)``. `replace` returns a changed copy.
    """

    layout: StateLayout
    values: FloatArray

    @classmethod
    def of(cls, tokens: Iterable[Token], given: Mapping[tuple[str, str], ArrayLike]) -> "State":
        """Return a state with the given values, and default values for all other varying properties.

        Args:
            tokens: all tokens of the task.
            given: maps pairs of (token, property) to values of shape ``(size,)``.
        """
        tokens = tuple(tokens)
        layout = StateLayout.of(tokens)
        values = np.concatenate(
            [np.asarray(varying.default, dtype=float) for t in tokens for varying in t.varying] or [np.zeros(0)]
        )
        return cls(layout, values).replace(given)

    def __getitem__(self, key: tuple[Token | str, str]) -> FloatArray:
        """Return a view of one property of one token, shape ``(..., size)``."""
        token, name = key
        owner = token if isinstance(token, str) else token.name
        try:
            return self.values[..., self.layout.slices[owner, name]]
        except KeyError:
            raise self._unknown(owner, name, UnknownToken) from None

    def replace(self, changes: Mapping[tuple[str, str], ArrayLike]) -> "State":
        """Return a copy with new values for pairs of (token, property). Each value is broadcast to ``(..., size)``.

        Raises:
            UnknownProperty: the state does not contain the token or the property.
        """
        values = self.values.copy("K")
        for key, value in changes.items():
            try:
                columns = self.layout.slices[key]
            except KeyError:
                raise self._unknown(*key, UnknownTarget) from None
            values[..., columns] = value
        return State(self.layout, values)

    def _unknown(self, owner: str, name: str, error: type[UnknownToken]) -> UnknownProperty:
        """Return the error for a token or property that the state does not contain."""
        known = [varying for each, varying, _ in self.layout.entries if each == owner]
        if known:
            return UnknownProperty(owner, name, known)
        return error(owner, name, dict.fromkeys(each for each, _, _ in self.layout.entries))

    def repeated(self, count: int) -> "State":
        """Return a state with `count` copies of this state along a new leading batch axis."""
        return State(self.layout, np.tile(self.values, (count,) + (1,) * self.values.ndim))
