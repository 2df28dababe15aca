"""Environments with Gymnasium's contract. Gymnasium is an optional dependency, which is imported at first use."""

from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.analytic import AnalyticBackend
from hybrid_tamp.physics.protocol import SIMULATOR, Backend, open_backend

if TYPE_CHECKING:
    from hybrid_tamp.interop.task_environment import TaskEnvironment

NAME = "hybrid_tamp/Task-v0"
"""Name of the environments in Gymnasium."""

MOST_STEPS = 7200
"""Default number of steps after which an episode is truncated. In PyBullet, this is half a minute."""


def make_environment(
    task: Task, *, backend: str = SIMULATOR, most_steps: int = MOST_STEPS, render_mode: str | None = "rgb_array"
) -> "TaskEnvironment":
    """Return a Gymnasium environment in which an agent commands the hands of a task.

    The attribute `spec` makes further environments of the same task, e.g. ``gymnasium.make_vec(environment.spec, 4)``.

    Args:
        task: task to solve.
        backend: name of the physics backend. It must simulate bodies. The backend ``analytic`` simulates blocks.
        most_steps: number of steps after which an episode is truncated.
        render_mode: ``rgb_array`` if `render` shall return pictures, or None.

    Raises:
        InputError: Gymnasium is not installed, the task has no basic actions, or the backend is unknown or unsuitable.
    """
    if find_spec("gymnasium") is None:
        remedy = "pip install 'hybrid-tamp[gym]'"
        raise InputError([Issue("", "an environment requires gymnasium, which is not installed", remedy=remedy)])
    from gymnasium.envs.registration import EnvSpec

    from hybrid_tamp.interop.task_environment import TaskEnvironment

    def open_physics() -> Backend:
        physics = open_backend(backend)
        if isinstance(physics, AnalyticBackend):
            wanted = "an environment requires a physics backend that simulates bodies"
            raise InputError([Issue("", wanted, backend, remedy=f"choose another backend, e.g. {SIMULATOR}")])
        return physics

    def make(**others: Any) -> TaskEnvironment:
        return TaskEnvironment(task, open_physics, **{"most_steps": most_steps, "render_mode": render_mode, **others})

    environment = make()
    # Gymnasium copies the arguments in a specification, but not what a function contains.
    environment.spec = EnvSpec(NAME, entry_point=make)
    return environment
