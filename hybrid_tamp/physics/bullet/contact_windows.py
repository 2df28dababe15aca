"""Contact forces as impulses over a sliding window of 10 ms.

The largest force of a substep depends on the solver. The impulse over 10 ms does not: it is the reduced mass times the
closing speed.
"""

from collections import deque
from collections.abc import Collection, Mapping
from copy import deepcopy

from hybrid_tamp.physics.bullet.engine import SUBSTEP
from hybrid_tamp.physics.protocol import Pair

WINDOW = 0.01
"""Length of the window [s]."""
_WHOLE = int(WINDOW / SUBSTEP)
"""Number of whole substeps in a window."""
_LEFT_OUT = 1.0 - (WINDOW / SUBSTEP - _WHOLE)
"""Share of the oldest recorded substep that is not in a window."""
_AVERAGE = SUBSTEP / WINDOW
"""Factor that converts the sum of the forces in a window to their average."""


class ContactWindows:
    """The recent contact forces of each pair of bodies.

    A window that spans a reassignment would mix a contact that was allowed with one that is not. So the windows of a
    token are emptied when its instance changes.
    """

    def __init__(self) -> None:
        self._windows: dict[Pair, deque[float]] = {}
        self._largest: dict[Pair, float] = {}

    def copy(self) -> "ContactWindows":
        """Return an independent copy."""
        return deepcopy(self)

    def begin_period(self) -> None:
        """Forget the largest forces of the last control period."""
        self._largest = {}

    def record(self, forces: Mapping[Pair, float]) -> None:
        """Record one substep.

        Args:
            forces: maps each pair of bodies in contact to its normal force [N].
        """
        windows, largest, over = self._windows, self._largest, []
        for pair in forces:
            if pair not in windows:
                windows[pair] = deque(maxlen=_WHOLE + 1)
        for pair, window in windows.items():
            window.append(forces.get(pair, 0.0))
            total = sum(window)
            if len(window) > _WHOLE:
                total -= _LEFT_OUT * window[0]
            force = total * _AVERAGE
            if pair not in forces and not any(window):
                over.append(pair)
            elif pair not in largest:
                largest[pair] = force if force > 0.0 else 0.0
            elif force > largest[pair]:
                largest[pair] = force
        for pair in over:
            del windows[pair]

    def empty(self, tokens: Collection[str]) -> None:
        """Empty the windows of all pairs with one of these tokens."""
        self._windows = {pair: window for pair, window in self._windows.items() if not set(tokens) & set(pair)}

    @property
    def largest(self) -> Mapping[Pair, float]:
        """The largest force of each pair in the last control period [N]."""
        return self._largest
