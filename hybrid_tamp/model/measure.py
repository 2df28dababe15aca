"""Performance measures of blocks (paper, Secs. II-D and III-B)."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from hybrid_tamp.model.authored import authored
from hybrid_tamp.model.control import Commands, Hyperparameters
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.shapes import check_shape
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray


@dataclass(frozen=True)
class Measure:
    """A weighted term of a block's performance measure (paper, Secs. II-D and III-B).

    Exactly one of the functions `end`, `peak` and `rate` computes the figure of the term. The value of the term is
    ``weight * figure / scale``. All functions return arrays of shape ``(...)``.

    Attributes:
        name: name of the measure, e.g. ``"contact"``.
        unit: SI unit of the figure.
        weight: weight of the term in the value of a plan. Negative for a cost. A task can change the weight.
        scale: divisor of the figure [unit].
        end: function ``end(binding, before, after, hyperparameters)`` that returns the figure. `before` and `after` are
            the states at the start and at the end of the instance.
        peak: function ``peak(binding, state)`` whose maximum over the duration is the figure.
        rate: function ``rate(binding, state, commands)`` [unit/s] whose integral over the duration is the figure.
        description: description in one line.
    """

    name: str
    unit: str
    weight: float
    scale: float = 1.0
    end: Callable[[Binding, State, State, Hyperparameters], FloatArray] | None = None
    peak: Callable[[Binding, State], FloatArray] | None = None
    rate: Callable[[Binding, State, Commands], FloatArray] | None = None
    description: str = ""

    def at_end(
        self, block: str, binding: Binding, before: State, after: State, hyperparameters: Hyperparameters
    ) -> FloatArray:
        """Return the figure of a measure that has the function `end`, shape ``(...)``.

        Args:
            block: name of the block, for messages.
            binding: maps each role of the block to its token or symbol.
            before: state at the start of the instance.
            after: state at the end of the instance.
            hyperparameters: values of the block's hyperparameters.

        Raises:
            DomainError: the function raised an exception, or returned a figure of the wrong shape.
        """
        assert self.end is not None, "the measure must have the function end"
        where = f"{block}.{self.name}"
        with authored(where, binding):
            figure = self.end(binding, before, after, hyperparameters)
        check_shape(where, binding, figure, after.values.shape[:-1])
        return np.asarray(figure)

    def during(self, block: str, binding: Binding, state: State, commands: Commands) -> FloatArray:
        """Return the values of the function `peak` [unit] or `rate` [unit/s] while an instance runs, shape ``(...)``.

        Args:
            block: name of the block, for messages.
            binding: maps each role of the block to its token or symbol.
            state: states after control periods.
            commands: commands in these control periods, for the function `rate`.

        Raises:
            DomainError: the function raised an exception, or returned figures of the wrong shape.
        """
        where = f"{block}.{self.name}"
        with authored(where, binding):
            if self.peak is not None:
                figures = self.peak(binding, state)
            else:
                assert self.rate is not None, "the measure must have one of the functions end, peak and rate"
                figures = self.rate(binding, state, commands)
        check_shape(where, binding, figures, state.values.shape[:-1])
        return np.asarray(figures)
