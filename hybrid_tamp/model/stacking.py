"""Bindings stacked: many bindings of a predicate's arguments as one batch of states.

Margins follow from the fixed properties and the state of their arguments, and take batches of states. So bindings whose
tokens have the same fixed properties are one batch of states of one binding's tokens; no margin is written for that.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from hybrid_tamp.model.state import State, StateLayout
from hybrid_tamp.model.token import Token

Values = tuple[Token | str, ...]


@dataclass(frozen=True, eq=False)
class Stack:
    """Bindings that one call decides.

    Attributes:
        places: where they are among all bindings, k of them.
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
        apart: whether tokens of equal properties are told apart, too.
    """
    groups: dict[object, list[int]] = {}
    for place, values in enumerate(bindings):
        first = [values.index(value) for value in values]  # one token may stand at two places
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
    """Return where the varying properties of the tokens lie in the state."""
    slices = (state.layout.slices[token.name, varying.name] for token in _tokens(values) for varying in token.varying)
    return [column for each in slices for column in range(each.start, each.stop)]
