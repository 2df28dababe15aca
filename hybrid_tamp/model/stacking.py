"""Stacks, which evaluate many bindings of a predicate's arguments as one batch of states.

A margin accepts batches of states and depends only on the fixed properties and the states of its arguments. So a single
call can evaluate all bindings whose tokens have the same fixed properties. The call gets the tokens of the first
binding and a batch with the states of all bindings.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from hybrid_tamp.model.state import State, StateLayout
from hybrid_tamp.model.token import Token

Values = tuple[Token | str, ...]


@dataclass(frozen=True, eq=False)
class Stack:
    """A group of k bindings that one call evaluates.

    Attributes:
        places: indices of the k bindings in the sequence of all bindings.
        state: states of the tokens of the bindings, batch shape ``(k, ...)``, in the layout of the first binding.
        values: arguments of the first binding.
    """

    places: list[int]
    state: State
    values: Values


def stack(state: State, bindings: Sequence[Values], *, apart: bool = False) -> Iterator[Stack]:
    """Yield stacks that together contain all bindings. The number of stacks is as small as possible.

    Args:
        state: state of all tokens, batch shape ``(...)``.
        bindings: tuples with a token or symbol for each argument.
        apart: whether bindings of different tokens must be in different stacks, even if tokens have equal properties.
    """
    groups: dict[object, list[int]] = {}
    for place, values in enumerate(bindings):
        first = [values.index(value) for value in values]  # A token can be bound to two arguments.
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
    """Return the columns of the state array that store the varying properties of the tokens."""
    slices = (state.layout.slices[token.name, varying.name] for token in _tokens(values) for varying in token.varying)
    return [column for each in slices for column in range(each.start, each.stop)]
