"""The backend protocol: a backend moves the tokens, one control period at a time, and is found by its name."""

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
"""Entry-point group for backends of other packages; each entry is a callable without arguments."""

FLOOR = "(floor)"
"""Name of the floor in contacts; no token can have this name."""

ContactForce = tuple[str, str, float]
"""Two tokens in contact, or a token and `FLOOR`, sorted, and the normal force between them [N]."""

# Listed here as well, so that a source tree runs without an installed distribution.
_BUILT_IN = {
    "analytic": "hybrid_tamp.physics.analytic:AnalyticBackend",
    "pybullet": "hybrid_tamp.physics.bullet.backend:BulletBackend",
}


class Resource(Protocol):
    """A context manager that closes itself on exit."""

    def close(self) -> None:
        """Free the resources; the object cannot be used afterwards."""
        ...

    def __enter__(self: _Self) -> _Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()


class Backend(Resource, Protocol):
    """A simulated world that takes commands and is measured."""

    @property
    def name(self) -> str:
        """Name of the backend, as in `open_backend`."""
        ...

    @property
    def timestep(self) -> float:
        """Control period [s]."""
        ...

    def reset(self, task: Task, state: State) -> State:
        """Build the task's scene in a state of shape ``(n,)`` and return the initial state of the simulation.

        A reset to a returned state starts the same run again, bit for bit.

        Raises:
            InputError: the backend cannot simulate the task.
        """
        ...

    def assign(self, running: Sequence[BlockInstance]) -> None:
        """Tell the backend which instances run from now on; a full simulator may ignore this."""
        ...

    def step(self, commands: Commands) -> State:
        """Hold the commands for one control period and return the state measured after it.

        Tokens without a command get zero.

        Raises:
            CommandError: a command is unknown, of a wrong size, not finite or above its token's limit.
        """
        ...

    def contact_forces(self) -> list[ContactForce]:
        """Return the tokens that were in contact within the last period, with the largest force of each pair."""
        ...

    def snapshot(self) -> AbstractContextManager[Callable[[], None]]:
        """Save the current state; the context gives a function that restores it, bit for bit."""
        ...


def open_backend(name: str) -> Backend:
    """Open the backend with this name.

    Raises:
        InputError: no backend has this name, or a package that it needs is not installed.
    """
    others: list[EntryPoint] = sorted(entry_points(group=GROUP), key=lambda entry: entry.name)
    offers = {entry.name: entry.value for entry in others} | _BUILT_IN
    if name not in offers:
        raise InputError([Issue("", "the name of a physics backend", repr(name), tuple(sorted(offers)))])
    backend: Backend = load(offers[name])()
    return backend


def load(reference: str) -> Any:
    """Import ``"module:attribute"``.

    Raises:
        InputError: a package that the module needs is not installed.
    """
    module, _, attribute = reference.partition(":")
    try:
        return getattr(import_module(module), attribute)
    except ModuleNotFoundError as missing:
        remedy = f"install {missing.name}, or choose another physics backend"
        wanted = f"the package {missing.name}, which is not installed"
        raise InputError([Issue(module, wanted, remedy=remedy)]) from missing
