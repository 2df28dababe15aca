"""Performance measures of blocks (paper, Secs. II-D and III-B)."""

from collections.abc import Callable
from dataclasses import dataclass

from hybrid_tamp.model.control import Commands
from hybrid_tamp.model.parameters import Hyperparameters
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray


@dataclass(frozen=True)
class Measure:
    """One term of a block's performance measure: a figure and its weight.

    Exactly one of `end`, `peak` and `rate` says how the figure is computed.

    Attributes:
        name: e.g. ``"contact"``.
        unit: SI unit of the figure.
        weight: what one `scale` of it adds to the value of a plan; negative for a cost. Tasks may change it.
        scale: size of the figure that counts as one [unit].
        end: ``end(binding, before, after, hyperparameters)`` from the states at the beginning and the end, ``(...)``.
        peak: ``peak(binding, state)``, of which the largest value while the block ran counts, ``(...)``.
        rate: ``rate(binding, state, commands)``, integrated over the time that the block ran, ``(...)`` [unit/s].
        description: one line.
    """

    name: str
    unit: str
    weight: float
    scale: float = 1.0
    end: Callable[[Binding, State, State, Hyperparameters], FloatArray] | None = None
    peak: Callable[[Binding, State], FloatArray] | None = None
    rate: Callable[[Binding, State, Commands], FloatArray] | None = None
    description: str = ""
