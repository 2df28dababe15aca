"""Interface of physics backends, and functions that open a backend by name."""

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from typing import Any, Protocol, TypeVar

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.control import Commands
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task

_Self = TypeVar("_Self")

GROUP = "hybrid_tamp.physics"
"""Entry-point group for backends of other packages. Each entry point is a function that returns a backend."""

SIMULATOR = "pybullet"
"""Name of the backend that simulates blocks with ``system=PHYSICS`` during planning."""

Pair = tuple[str, str]
"""Names of two tokens, or of a token and `FLOOR`, sorted."""

ContactForce = tuple[str, str, float]
"""Triple of (name, name, normal force [N]) for two bodies in contact. The names are sorted and may include `FLOOR`."""

# The built-in backends are listed here too, so that they work even if this package is not installed.
_BUILT_IN = {
    "analytic": "hybrid_tamp.physics.analytic:AnalyticBackend",
    "pybullet": "hybrid_tamp.physics.bullet.backend:BulletBackend",
}


class Resource(Protocol):
    """A context manager that releases its resources on exit."""

    def close(self) -> None:
        """Release the resources. The object must not be used afterwards."""
        ...

    def __enter__(self: _Self) -> _Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()


class Backend(Resource, Protocol):
    """A simulator that receives commands and returns measured states."""

    @property
    def name(self) -> str:
        """Name under which `open_backend` opens the backend."""
        ...

    @property
    def timestep(self) -> float:
        """Control period [s]."""
        ...

    def reset(self, task: Task, state: State) -> State:
        """Build the scene of a task in a given state ``(n,)`` and return the initial state of the simulation ``(n,)``.

        After a reset to the returned state, the same commands must reproduce the same run bit for bit.

        Raises:
            InputError: the backend cannot simulate the task.
        """
        ...

    def assign(self, running: Sequence[BlockInstance]) -> None:
        """Set the running instances. A backend that does not need the instances may ignore this call."""
        ...

    def step(self, commands: Commands) -> State:
        """Apply constant commands for one control period and return the state measured at its end.

        Missing commands are zero.

        Raises:
            CommandError: a command is unknown, not finite, above its token's limit, or has the wrong size.
        """
        ...

    def contact_forces(self) -> list[ContactForce]:
        """Return the largest normal force of every pair of tokens that touched in the last control period."""
        ...

    def snapshot(self) -> AbstractContextManager[Callable[[], None]]:
        """Save the current state. The context provides a function that restores the saved state bit for bit."""
        ...


def open_backend(name: str) -> Backend:
    """Open the backend with this name.

    Raises:
        InputError: no backend has this name, or a package that the backend needs is not installed.
    """
    others: list[EntryPoint] = sorted(entry_points(group=GROUP), key=lambda entry: entry.name)
    offers = {entry.name: entry.value for entry in others} | _BUILT_IN
    if name not in offers:
        raise InputError([Issue("", "expected the name of a physics backend", repr(name), tuple(sorted(offers)))])
    backend: Backend = load(offers[name])()
    return backend


def load(reference: str) -> Any:
    """Import the module in the reference ``"module:attribute"``, and return its attribute.

    Raises:
        InputError: a package that the module needs is not installed.
    """
    module, _, attribute = reference.partition(":")
    try:
        return getattr(import_module(module), attribute)
    except ModuleNotFoundError as missing:
        remedy = f"install {missing.name}, or choose another physics backend"
        wanted = f"requires the package {missing.name}, which is not installed"
        raise InputError([Issue(module, wanted, remedy=remedy)]) from missing
