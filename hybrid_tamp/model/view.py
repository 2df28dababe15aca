"""The part of a state that the functions of a block instance may read (paper, Sec. II-B).

A policy and a continuous system see only the tokens in the slots of their instance and its targets. Rollouts and runs
use the same view, so a policy that reads another token fails in both.
"""

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.state import State, StateLayout
from hybrid_tamp.model.token import Token


class View:
    """The view of one block instance.

    Args:
        binding: maps each role of the instance to its token or symbol.
        whole: layout of the states that are viewed.

    Attributes:
        layout: layout of the view, which contains the tokens of the binding.
        columns: indices of the view's values in a state of layout `whole`. Shape ``(m,)``.
    """

    def __init__(self, binding: Binding, whole: StateLayout) -> None:
        tokens = {value.name: value for value in binding.values() if isinstance(value, Token)}
        self.layout = StateLayout.of(tokens.values())
        places = [range(*whole.slices[token, name].indices(whole.size)) for token, name, _ in self.layout.entries]
        self.columns: NDArray[np.intp] = np.array([index for place in places for index in place], dtype=np.intp)
        self._whole = self.layout == whole
        first, count = (int(self.columns[0]), len(self.columns)) if len(self.columns) else (0, 0)
        # A slice is a view of the state, which is faster than a copy.
        side_by_side = bool((self.columns == np.arange(first, first + count)).all())
        self._read: slice | NDArray[np.intp] = slice(first, first + count) if side_by_side else self.columns

    def of(self, state: State) -> State:
        """Return the values of the instance's tokens in a state of shape ``(..., n)``, as a state ``(..., m)``."""
        return state if self._whole else State(self.layout, state.values[..., self._read])

    def update(self, state: State, seen: State) -> State:
        """Return a state of shape ``(..., n)`` with the values of the instance's tokens from a view ``(..., m)``."""
        if self._whole:
            return seen
        values = state.values.copy("K")
        values[..., self.columns] = seen.values
        return State(state.layout, values)
