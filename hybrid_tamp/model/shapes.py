"""Checks of the shapes of the arrays that the functions of a domain return.

A function that forgets ``axis`` returns one number for a whole batch of states. Numpy would silently broadcast this
number, and the optimiser would then optimise nonsense.
"""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import ArrayLike

from hybrid_tamp.errors import ForeignCommand, Issue, ShapeError
from hybrid_tamp.model.authored import describe_roles
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token

_REMEDY = "compute one result for each state of a batch, e.g. np.linalg.norm(..., axis=-1)"


def check_shape(where: str, values: Mapping[str, Token | str], found: ArrayLike, wanted: tuple[int, ...]) -> None:
    """Check the shape of a result.

    Args:
        where: name of the function, e.g. ``predicate inside``.
        values: maps each role of the block, or each parameter of the predicate, to its value.
        found: the result.
        wanted: shape that the result must have.

    Raises:
        ShapeError: the result has another shape.
    """
    shape = np.shape(found)
    if shape != wanted:
        said = f"the result must have the shape {wanted}{describe_roles(values)}"
        raise ShapeError([Issue(where, said, str(shape), remedy=_REMEDY)])


def check_commands(
    where: str,
    values: Mapping[str, Token | str],
    commands: Mapping[tuple[str, str], ArrayLike],
    sizes: Mapping[tuple[str, str], int],
    state: State,
) -> None:
    """Check the commands of a policy.

    Args:
        where: name of the policy.
        values: maps each role of the block to its value.
        commands: maps each pair of (token, basic action) to a command.
        sizes: maps each pair of (token, basic action) to the number of components of the action.
        state: state for which the policy was called.

    Raises:
        ShapeError: a command has the wrong shape.
        ForeignCommand: no token of the block has the action.
    """
    for (token, action), command in commands.items():
        if (token, action) not in sizes:
            wanted = "each command of a policy must be an action of a token in a slot of the block"
            have = ", ".join(f"{name} of {owner}" for owner, name in sizes) or "none"
            raise ForeignCommand([Issue(where, wanted, f"{action} of {token}", remedy=f"the actions are {have}")])
        shape = (*state.values.shape[:-1], sizes[token, action])
        if np.shape(command) != shape:
            check_shape(f"{where}, {action} of {token}", values, command, shape)


def check_initial_value(
    where: str, values: Mapping[str, Token | str], value: ArrayLike, state: State, initial: Callable[[State], ArrayLike]
) -> None:
    """Check the shape of a hyperparameter's initial value.

    A single number for a whole batch is correct only if the value is constant. So this number must equal the value for
    the first state alone and the value for the last state alone.

    Args:
        where: name of the hyperparameter.
        values: maps each role of the block to its value.
        value: initial value for `state`.
        state: a state, or a batch of states.
        initial: function that returns the initial value for a state.

    Raises:
        ShapeError: the value has the wrong shape.
    """
    batch = state.values.shape[:-1]
    if np.shape(value) == () and batch:
        rows = state.values.reshape(-1, state.values.shape[-1])
        ends = (initial(State(state.layout, row)) for row in (rows[0], rows[-1]))
        if all(np.array_equal(end, value, equal_nan=True) for end in ends):
            return
    check_shape(where, values, value, batch)


def sizes_of(tokens: Mapping[str, Token]) -> dict[tuple[str, str], int]:
    """Return a mapping from pairs of (token, basic action) to numbers of components. `tokens` maps slots to tokens."""
    return {(token.name, action.name): action.size for token in tokens.values() for action in token.basic_actions}
