"""Stacks: many bindings of a predicate's arguments as one batch of states.

A margin depends on the fixed properties and the states of its arguments and accepts batches of states. So one call
evaluates all bindings whose tokens have the same fixed properties, as a batch of states of the first binding's tokens.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from hybrid_tamp.model.state import State, StateLayout
from hybrid_tamp.model.token import Token

Values = tuple[Token | str, ...]


@dataclass(frozen=True, eq=False)
class Stack:
    """Bindings that one call evaluates.

    Attributes:
        places: indices of its k bindings among all bindings.
        state: the states of their tokens, batch shape ``(k, ...)``, in the layout of the first binding's tokens.
        values: the first binding.
    """

    places: list[int]
    state: State
    values: Values


def stack(state: State, bindings: Sequence[Values], *, apart: bool = False) -> Iterator[Stack]:
    """Yield all bindings in as few stacks as possible.

    Args:
        state: the state of all tokens, batch shape ``(...)``.
        bindings: tokens or symbols for each argument.
        apart: whether tokens with equal properties are in different stacks.
    """
    groups: dict[object, list[int]] = {}
    for place, values in enumerate(bindings):
        first = [values.index(value) for value in values]  # one token may be two arguments
        known = (value if isinstance(value, str) else value.name if apart else value.fixed for value in values)
        groups.setdefault((*first, *known), []).append(place)
    for places in groups.values():
        values = bindings[places[0]]
        columns = np.array([_columns(state, bindings[place]) for place in places], dtype=np.intp)
        stacked = np.moveaxis(state.values[..., columns], -2, 0)
        yield Stack(places, State(StateLayout.of(_tokens(values)), stacked), values)


def _tokens(values: Values) -> list[Token]:
    return [value for value in dict.fromkeys(values) if isinstance(value, Token)]


def _columns(state: State, values: Values) -> list[int]:
    """Return the columns of the varying properties of the tokens in the state."""
    slices = (state.layout.slices[token.name, varying.name] for token in _tokens(values) for varying in token.varying)
    return [column for each in slices for column in range(each.start, each.stop)]
