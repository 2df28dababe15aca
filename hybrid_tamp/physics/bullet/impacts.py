"""Measurement of the largest impulse on each token that has the varying property `impulse`."""

from collections import deque
from collections.abc import Mapping
from copy import deepcopy

from hybrid_tamp.model.block import FLOOR
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.bullet.engine import SUBSTEP, SUBSTEPS

IMPULSE = "impulse"
"""Name of the varying property that stores the largest impulse so far [N s]."""

_Pair = tuple[str, str]


class Impacts:
    """Measurement of the impulse between two tokens over a sliding window of one control period.

    The window moves by one substep at a time, so an impact across the boundary of two control periods is measured as a
    whole. A steady push is measured by its impulse during one control period. Contacts with the floor are ignored.
    """

    def __init__(self, task: Task) -> None:
        self._tokens = frozenset(
            token.name for token in task.assigned if any(varying.name == IMPULSE for varying in token.varying)
        )
        self._windows: dict[_Pair, deque[float]] = {}
        self._hardest: dict[str, float] = {}

    def copy(self) -> "Impacts":
        """Return an independent copy."""
        return deepcopy(self)

    def record(self, forces: Mapping[_Pair, float]) -> None:
        """Record the normal forces of one substep.

        Args:
            forces: maps each pair of tokens in contact to its normal force [N].
        """
        if not self._tokens:
            return
        before, self._windows = self._windows, {}
        for pair, force in forces.items():
            if FLOOR in pair or self._tokens.isdisjoint(pair):
                continue
            window = before.get(pair) or deque(maxlen=SUBSTEPS)
            self._windows[pair] = window
            window.append(force * SUBSTEP)
            for token in self._tokens.intersection(pair):
                self._hardest[token] = max(sum(window), self._hardest.get(token, 0.0))

    def update(self, state: State) -> None:
        """Write the largest impulses so far into a state of shape ``(n,)``, in place."""
        for token, impulse in self._hardest.items():
            state[token, IMPULSE][0] = max(impulse, state[token, IMPULSE][0])
