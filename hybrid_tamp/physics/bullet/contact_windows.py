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
        windows, largest = self._windows, self._largest
        for pair, force in forces.items():
            if (window := windows.get(pair)) is None:
                window = windows[pair] = deque(maxlen=_WHOLE + 1)
            window.append(force)
        if len(windows) > len(forces):
            for pair in windows.keys() - forces.keys():
                windows[pair].append(0.0)
                if not any(windows[pair]):
                    del windows[pair]
        for pair, window in windows.items():
            left_out = _LEFT_OUT * window[0] if len(window) > _WHOLE else 0.0
            force = (sum(window) - left_out) * _AVERAGE
            if force > largest.get(pair, 0.0):
                largest[pair] = force
            else:
                largest.setdefault(pair, 0.0)

    def empty(self, tokens: Collection[str]) -> None:
        """Empty the windows of all pairs with one of these tokens."""
        self._windows = {pair: window for pair, window in self._windows.items() if not set(tokens) & set(pair)}

    @property
    def largest(self) -> Mapping[Pair, float]:
        """The largest force of each pair in the last control period [N]."""
        return self._largest
