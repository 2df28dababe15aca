"""Evaluation, rounding errors and safety factors of margins.

A condition must not fail because of a rounding error. A condition that fails only because of a safety factor does not
prove that a task has no plan.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from hybrid_tamp.model.authored import OWN_ERRORS, authored, blame
from hybrid_tamp.model.shapes import check_shape
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray

ROUNDING = 1e-9
"""Largest absolute value of a margin that is treated as zero, as a fraction of the predicate's scale.

A rounding error is about 1e-16 times the largest term of a margin. So the error is less than 1e-9 times the scale if
each term is less than 1e6 times the scale. All tolerances and all measurement errors are much larger.
"""


@dataclass(frozen=True)
class SafetyFactor:
    """The factor by which a static predicate is stricter than its physical bound.

    Attributes:
        factor: factor, at least 1. With the factor 1, the predicate states the physical bound.
        description: what the factor multiplies, and what it covers.
    """

    factor: float
    description: str


def without_rounding(margin: FloatArray, scale: float) -> FloatArray:
    """Return a margin ``(...)`` in which each value that differs from zero by rounding only is exactly zero.

    Args:
        margin: signed margin ``(...)`` [unit].
        scale: scale of the predicate [unit].
    """
    return np.where(np.abs(margin) <= ROUNDING * scale, 0.0, margin)


class Named(Protocol):
    """A parameter of a predicate."""

    @property
    def name(self) -> str:
        """Name of the parameter."""


class Margin(Protocol):
    """A predicate, which has a margin function (see `model.predicate.Predicate`)."""

    @property
    def name(self) -> str:
        """Name of the predicate."""

    @property
    def parameters(self) -> Sequence[Named]:
        """Parameters of the predicate."""

    @property
    def margin(self) -> Callable[..., FloatArray]:
        """Function ``margin(state, *values)`` that returns the margin, shape ``(...)``."""

    @property
    def keywords(self) -> Mapping[str, float]:
        """Keyword arguments of the margin function."""

    @property
    def scale(self) -> float:
        """Scale of the margin [unit]."""

    @property
    def reads(self) -> Mapping[str, tuple[str, ...]]:
        """Varying properties that the margin reads from each parameter."""

    @property
    def bound(self) -> Callable[..., FloatArray] | None:
        """Function ``bound(state, radius, *values)`` that returns an upper bound of the margin, or None."""


def evaluate_margin(predicate: Margin, state: State, values: Sequence[Token | str]) -> FloatArray:
    """Return the margin of a predicate ``(...)``. Values that differ from zero by rounding only are exactly zero.

    Raises:
        DomainError: the margin function raised an exception, or returned a margin of the wrong shape.
    """
    try:
        margin = predicate.margin(state, *values, **predicate.keywords)
        if state.values.ndim == 1 and np.shape(margin) == ():
            # In runs, margins of single states are computed in every control period, and plain numbers are faster.
            number = float(margin)
            return np.asarray(0.0 if abs(number) <= ROUNDING * predicate.scale else number)
        without = without_rounding(margin, predicate.scale)
    except OWN_ERRORS:
        raise
    except Exception as error:
        # The context manager `authored` would be slower, and margins are evaluated very often.
        raise blame(error, f"predicate {predicate.name}", _roles(predicate, values)) from error
    # A margin that depends only on fixed properties may be one number for all states.
    if without.shape != state.values.shape[:-1] and (predicate.reads or without.shape != ()):
        check_shape(f"predicate {predicate.name}", _roles(predicate, values), without, state.values.shape[:-1])
    return without


def _roles(predicate: Margin, values: Sequence[Token | str]) -> dict[str, Token | str]:
    """Return a mapping from each parameter to its value."""
    return dict(zip((parameter.name for parameter in predicate.parameters), values, strict=False))


def bound_margin(predicate: Margin, state: State, radius: float, values: Sequence[Token | str]) -> float:
    """Return an upper bound of a margin after horizontal displacements of the tokens by at most `radius` [m].

    If the predicate declares no bound, the result is infinite.

    Raises:
        DomainError: the bound function raised an exception.
    """
    if predicate.bound is None:
        return np.inf
    with authored(f"the bound of {predicate.name}", _roles(predicate, values)):
        bound = predicate.bound(state, radius, *values, **predicate.keywords)
    check_shape(f"the bound of {predicate.name}", _roles(predicate, values), bound, state.values.shape[:-1])
    return float(without_rounding(np.asarray(bound), predicate.scale))
