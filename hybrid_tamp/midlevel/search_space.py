"""The space of hyperparameters that an optimiser searches: a box in real units, mapped to the unit cube."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from math import isfinite

import numpy as np

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.motion.arrays import FloatArray


@dataclass(frozen=True)
class Variable:
    """One hyperparameter of the space.

    Attributes:
        name: unique in its space, e.g. ``"GRASPING(hand).grasp"``.
        unit: SI unit.
        lower: lower bound [unit].
        upper: upper bound [unit]; a variable with equal bounds is a constant.
        default: the value without optimisation [unit].

    Raises:
        InputError: the bounds are not finite or in the wrong order, or the default is outside them.
    """

    name: str
    unit: str
    lower: float
    upper: float
    default: float

    def __post_init__(self) -> None:
        """Check bounds and default."""
        bounds = f"[{self.lower}, {self.upper}]"
        if not (self.lower <= self.upper and isfinite(self.lower) and isfinite(self.upper)):
            raise InputError([Issue(self.name, "finite bounds, the lower one first", bounds)])
        if not self.lower <= self.default <= self.upper:
            raise InputError([Issue(self.name, f"a default within {bounds}", str(self.default))])


@dataclass(frozen=True)
class SearchSpace:
    """A box of d variables; a point is a row ``(d,)`` in real units, in the order of the variables.

    Attributes:
        variables: the d variables.
        whole: the space that this is a part of, whose other variables keep their defaults; or None.

    Raises:
        InputError: two variables have the same name.
    """

    variables: tuple[Variable, ...]
    whole: "SearchSpace | None" = None

    def __post_init__(self) -> None:
        """Check that names are unique."""
        twice = sorted({name for name in self.names if self.names.count(name) > 1})
        if twice:
            raise InputError([Issue(name, "a unique name for each variable") for name in twice])

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the variables, in order."""
        return tuple(variable.name for variable in self.variables)

    @property
    def d(self) -> int:
        """Number of variables, constants included."""
        return len(self.variables)

    @cached_property
    def lower(self) -> FloatArray:
        """Lower bounds [units], shape ``(d,)``."""
        return np.array([variable.lower for variable in self.variables], dtype=np.float64)

    @cached_property
    def upper(self) -> FloatArray:
        """Upper bounds [units], shape ``(d,)``."""
        return np.array([variable.upper for variable in self.variables], dtype=np.float64)

    @cached_property
    def default(self) -> FloatArray:
        """The default point [units], shape ``(d,)``."""
        return np.array([variable.default for variable in self.variables], dtype=np.float64)

    @property
    def varying(self) -> tuple[str, ...]:
        """Names of the variables that are not constant."""
        return tuple(variable.name for variable in self.variables if variable.lower < variable.upper)

    def clip(self, points: FloatArray) -> FloatArray:
        """Move points ``(..., d)`` outside the bounds to the bounds."""
        return np.clip(points, self.lower, self.upper)

    def to_unit(self, points: FloatArray) -> FloatArray:
        """Map points ``(..., d)`` to the unit cube ``[0, 1]^d``; constants get the coordinate 0."""
        span = self.upper - self.lower
        return (points - self.lower) / np.where(span > 0.0, span, 1.0)

    def from_unit(self, cube: FloatArray) -> FloatArray:
        """Return the points ``(..., d)`` with these coordinates in the unit cube; never outside the bounds."""
        # Clipped, because rounding may put lower + 1 * (upper - lower) just above the upper bound.
        return self.clip(self.lower + cube * (self.upper - self.lower))

    def only(self, names: Iterable[str]) -> "SearchSpace":
        """Return the part with these k variables, in the order of this space; the others keep their defaults.

        Raises:
            InputError: the space has no variable with one of the names.
        """
        wanted = set(names)
        unknown = sorted(wanted.difference(self.names))
        if unknown:
            raise InputError([Issue("", "unknown hyperparameter", repr(name), self.names) for name in unknown])
        return SearchSpace(tuple(variable for variable in self.variables if variable.name in wanted), whole=self)

    def starting_at(self, point: FloatArray) -> "SearchSpace":
        """Return this space with a point ``(d,)`` as its default."""
        variables = (replace(v, default=float(at)) for v, at in zip(self.variables, point, strict=True))
        return replace(self, variables=tuple(variables))

    def embed(self, points: FloatArray) -> FloatArray:
        """Return points ``(n, k)`` of a part as points ``(n, d)`` of its whole; a space without a whole keeps them."""
        if self.whole is None:
            return points
        embedded = np.tile(self.whole.default, (len(points), 1))
        embedded[:, [self.whole.names.index(name) for name in self.names]] = points
        return embedded
