"""The hardest impact that each token has taken, if its class asks for it."""

from collections import deque
from collections.abc import Mapping
from copy import deepcopy

from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.bullet.engine import SUBSTEP, SUBSTEPS
from hybrid_tamp.physics.protocol import FLOOR

IMPULSE = "impulse"
"""The varying property that tells the hardest impact so far [N s]."""

_Pair = tuple[str, str]


class Impacts:
    """Measures the impulse between two tokens over as many consecutive substeps as a control period has.

    The window slides, so that an impact over the border of two periods counts as one. A steady push counts no more than
    what it gives within a period. Contacts with the floor do not count.
    """

    def __init__(self, task: Task) -> None:
        self._tokens = frozenset(
            token.name for token in task.assigned if any(varying.name == IMPULSE for varying in token.varying)
        )
        self._windows: dict[_Pair, deque[float]] = {}
        self._hardest: dict[str, float] = {}

    def copy(self) -> "Impacts":
        """Return another one that has felt the same."""
        return deepcopy(self)

    def feel(self, forces: Mapping[_Pair, float]) -> None:
        """Take note of the normal forces [N] of one substep, of all pairs in contact."""
        if not self._tokens:
            return
        felt = {
            pair: force for pair, force in forces.items() if FLOOR not in pair and not self._tokens.isdisjoint(pair)
        }
        self._windows = {pair: self._windows.get(pair, deque(maxlen=SUBSTEPS)) for pair in felt}
        for pair, force in felt.items():
            window = self._windows[pair]
            window.append(force * SUBSTEP)
            for token in self._tokens.intersection(pair):
                self._hardest[token] = max(sum(window), self._hardest.get(token, 0.0))

    def update(self, state: State) -> None:
        """Write the hardest impact so far into a state, of shape ``(n,)``, in place."""
        for token, impulse in self._hardest.items():
            state[token, IMPULSE][0] = max(impulse, state[token, IMPULSE][0])
