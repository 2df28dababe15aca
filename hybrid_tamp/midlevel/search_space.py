"""Search space of the hyperparameters. The space is a box in real units that maps to the unit cube."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from math import isfinite

import numpy as np

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.motion.arrays import FloatArray


@dataclass(frozen=True)
class Variable:
    """One hyperparameter as a variable of a search space.

    Attributes:
        name: unique name in the space, for example ``"GRASPING(hand).grasp"``.
        unit: SI unit of the values.
        lower: lower bound, in the unit of the variable.
        upper: upper bound, in the unit of the variable. A variable with equal bounds is constant.
        default: value if the variable is not optimised, in the unit of the variable.

    Raises:
        InputError: if a bound is not finite, if the bounds are in the wrong order, or if the default is out of bounds.
    """

    name: str
    unit: str
    lower: float
    upper: float
    default: float

    def __post_init__(self) -> None:
        """Check the bounds and the default."""
        bounds = f"[{self.lower}, {self.upper}]"
        if not (self.lower <= self.upper and isfinite(self.lower) and isfinite(self.upper)):
            raise InputError([Issue(self.name, "the bounds must be finite with lower <= upper", bounds)])
        if not self.lower <= self.default <= self.upper:
            raise InputError([Issue(self.name, f"the default must be within {bounds}", str(self.default))])


@dataclass(frozen=True)
class SearchSpace:
    """A box of d variables. A point has shape ``(d,)``, in real units and in the order of the variables.

    Attributes:
        variables: the d variables.
        whole: the larger space that contains this part, or None. Variables outside the part keep their defaults.

    Raises:
        InputError: if two variables have the same name.
    """

    variables: tuple[Variable, ...]
    whole: "SearchSpace | None" = None

    def __post_init__(self) -> None:
        """Check that names are unique."""
        twice = sorted({name for name in self.names if self.names.count(name) > 1})
        if twice:
            raise InputError([Issue(name, "the names of variables must be unique") for name in twice])

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the variables, in order."""
        return tuple(variable.name for variable in self.variables)

    @property
    def d(self) -> int:
        """Number of variables, including constants."""
        return len(self.variables)

    @cached_property
    def lower(self) -> FloatArray:
        """Lower bounds, in real units. Shape ``(d,)``."""
        return np.array([variable.lower for variable in self.variables], dtype=np.float64)

    @cached_property
    def upper(self) -> FloatArray:
        """Upper bounds, in real units. Shape ``(d,)``."""
        return np.array([variable.upper for variable in self.variables], dtype=np.float64)

    @cached_property
    def default(self) -> FloatArray:
        """Default point, in real units. Shape ``(d,)``."""
        return np.array([variable.default for variable in self.variables], dtype=np.float64)

    @property
    def varying(self) -> tuple[str, ...]:
        """Names of the variables that are not constant."""
        return tuple(variable.name for variable in self.variables if variable.lower < variable.upper)

    def clip(self, points: FloatArray) -> FloatArray:
        """Return points of shape ``(..., d)`` clipped to the bounds."""
        return np.clip(points, self.lower, self.upper)

    def to_unit(self, points: FloatArray) -> FloatArray:
        """Map points of shape ``(..., d)`` to the unit cube ``[0, 1]^d``. Constants get the coordinate 0."""
        span = self.upper - self.lower
        return (points - self.lower) / np.where(span > 0.0, span, 1.0)

    def from_unit(self, cube: FloatArray) -> FloatArray:
        """Map coordinates in the unit cube to points of shape ``(..., d)``, which are never out of bounds."""
        # Clip the points, because rounding may put lower + 1 * (upper - lower) just above the upper bound.
        return self.clip(self.lower + cube * (self.upper - self.lower))

    def only(self, names: Iterable[str]) -> "SearchSpace":
        """Return the part of the space with the named variables, in the order of the space.

        Raises:
            InputError: if the space has no variable with one of the names.
        """
        wanted = set(names)
        unknown = sorted(wanted.difference(self.names))
        if unknown:
            raise InputError([Issue("", "unknown hyperparameter", repr(name), self.names) for name in unknown])
        return SearchSpace(tuple(variable for variable in self.variables if variable.name in wanted), whole=self)

    def starting_at(self, point: FloatArray) -> "SearchSpace":
        """Return the space with a point of shape ``(d,)`` as its default."""
        variables = (replace(v, default=float(at)) for v, at in zip(self.variables, point, strict=True))
        return replace(self, variables=tuple(variables))

    def embed(self, points: FloatArray) -> FloatArray:
        """Return points ``(n, k)`` of this part as points ``(n, d)`` of `whole`, or unchanged if `whole` is None."""
        if self.whole is None:
            return points
        embedded = np.tile(self.whole.default, (len(points), 1))
        embedded[:, [self.whole.names.index(name) for name in self.names]] = points
        return embedded
