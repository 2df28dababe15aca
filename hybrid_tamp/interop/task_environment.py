"""An environment of Gymnasium, in which an agent commands the hands of a task for one control period per step."""

from collections.abc import Callable
from contextlib import ExitStack
from typing import Any

import gymnasium
import numpy as np
from gymnasium.error import ResetNeeded
from gymnasium.spaces import Box
from numpy.typing import NDArray

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.execution.running_instance import measure_goal
from hybrid_tamp.model.commands import CommandError, CommandLayout
from hybrid_tamp.model.control import CONTROL_PERIOD
from hybrid_tamp.model.goal_distance import measure_goal_distance
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.state import State, StateLayout
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.physics.pictures.rendering import Renderer, open_renderer
from hybrid_tamp.physics.protocol import Backend

GOAL_REWARD = 1.0
"""Additional reward of a step after which the goal holds."""

_ROUNDING = 1e-9


class TaskEnvironment(gymnasium.Env[FloatArray, FloatArray]):
    """An environment with the tokens, the initial state and the goal of a task.

    An action contains the commands of all basic actions of all hands, in the order of `action_layout`, in SI units. A
    command whose norm exceeds its limit is scaled down, as in a run. An observation contains the varying properties of
    all tokens, in the order of `observation_layout`, in SI units. Recordings have the same orders, so
    ``recording.commands[i]`` is an action and ``recording.states[i]`` is an observation.

    The reward is the decrease of the distance to the goal (paper, Sec. II-D), plus `GOAL_REWARD` if the goal holds. An
    episode is terminated when the goal holds, and truncated after `most_steps` steps.

    Attributes:
        task: task of the environment.
        action_layout: layout of an action, e.g. ``action[action_layout.slices["hand", "force"]]``.
        observation_layout: layout of an observation, e.g. ``State(observation_layout, seen)["drum", "position"]``.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": round(1 / CONTROL_PERIOD)}  # noqa: RUF012 as in the base

    def __init__(
        self, task: Task, open_physics: Callable[[], Backend], most_steps: int, render_mode: str | None
    ) -> None:
        """Create an environment that opens and closes a backend. See `hybrid_tamp.make_environment`."""
        if render_mode not in (None, *self.metadata["render_modes"]):
            modes = tuple(self.metadata["render_modes"])
            raise InputError([Issue("render_mode", "expected a render mode, or None", repr(render_mode), modes)])
        self.task = task
        self.render_mode = render_mode
        self.action_layout = CommandLayout.of(task)
        self.observation_layout: StateLayout = task.state.layout
        if not self.action_layout.size:
            wanted = "an environment requires a task with basic actions"
            raise InputError([Issue(f"task {task.name}", wanted, remedy="add a hand")])
        sizes = [size for _, _, size in self.action_layout.entries]
        most = np.repeat(self.action_layout.limits, sizes)
        self.action_space = Box(-most, most, dtype=np.float64)
        self.observation_space = Box(-np.inf, np.inf, (self.observation_layout.size,), dtype=np.float64)
        self._resources = ExitStack()
        self._backend = self._resources.enter_context(open_physics())
        self._renderer: Renderer | None = None
        self._most_steps, self._steps = most_steps, 0
        self._state: State | None = None
        self._distance = 0.0

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[FloatArray, dict[str, Any]]:
        """Begin an episode in the initial state of the task, and return the observation and the information.

        Args:
            seed: seed of `np_random`. The initial state does not depend on the seed.
            options: ignored.

        Raises:
            InputError: the backend cannot simulate the task.
        """
        super().reset(seed=seed)
        self._steps = 0
        self._state = self._backend.reset(self.task, self.task.state)
        self._distance = float(measure_goal_distance(self.task, self._state))
        return self._observe(self._state)

    def step(self, action: FloatArray) -> tuple[FloatArray, float, bool, bool, dict[str, Any]]:
        """Apply constant commands for one control period.

        Args:
            action: commands of shape ``(action_layout.size,)``.

        Returns:
            Tuple of (observation, reward, terminated, truncated, information).

        Raises:
            ResetNeeded: no episode has begun.
            CommandError: the action has the wrong shape or is not finite.
        """
        if self._state is None:
            raise ResetNeeded("call reset() before step()")
        self._state = self._backend.step(self.action_layout.commands(self._limit(action)))
        self._steps += 1
        before, self._distance = self._distance, float(measure_goal_distance(self.task, self._state))
        observation, information = self._observe(self._state)
        reached = bool(information["is_success"])
        reward = before - self._distance + (GOAL_REWARD if reached else 0.0)
        return observation, reward, reached, self._steps >= self._most_steps, information

    def render(self) -> NDArray[np.uint8] | None:
        """Return a picture of shape ``(height, width, 3)``, or None without a render mode. The camera does not move.

        Raises:
            ResetNeeded: no episode has begun.
        """
        if self.render_mode is None:
            return None
        if self._state is None:
            raise ResetNeeded("call reset() before render()")
        if self._renderer is None:
            self._renderer = self._resources.enter_context(open_renderer(self.task, self._imagine_run()))
        return self._renderer.picture(self._state)

    def close(self) -> None:
        """Close the backend and the renderer. Further calls have no effect."""
        self._resources.close()

    def _limit(self, action: FloatArray) -> FloatArray:
        """Return the commands with norms within their limits, as a row of shape ``(action_layout.size,)``."""
        row = np.asarray(action, dtype=np.float64)
        if row.shape != self.action_space.shape:
            raise CommandError(f"an action must have shape {self.action_space.shape}, got {row.shape}")
        limited, _ = self.action_layout.limited(row)
        # A recorded command may exceed its limit by a rounding error. Its bits must stay the same.
        return np.where(np.isclose(limited, row, rtol=_ROUNDING, atol=0.0), row, limited)

    def _observe(self, state: State) -> tuple[FloatArray, dict[str, Any]]:
        """Return new arrays with the observation and the information."""
        goal = measure_goal(self.task, state)
        information = {
            "time": self._steps * self._backend.timestep,
            "distance": self._distance,
            "margins": {margin.atom.text: margin.measured for margin in goal},
            "is_success": all(margin.holds for margin in goal),
        }
        return state.values.copy(), information

    def _imagine_run(self) -> Recording:
        """Return a recording with the initial state, and with states in which all tokens are where one token begins.

        The camera, which shows a whole recording, then shows the space in which tokens move. All tokens also occur at
        the height of the highest token, because hands lift tokens.
        """
        begun = self.task.state
        places = [begun[token, "position"] for token in self.task.tokens]
        highest = max(place[2] for place in places)
        spots = [spot for place in places for spot in (place, np.array([*place[:2], highest]))]
        moved = [begun.replace({(token.name, "position"): spot for token in self.task.tokens}) for spot in spots]
        states = np.stack([state.values for state in (begun, *moved)])
        return Recording(
            layout=self.observation_layout,
            commands_layout=self.action_layout.entries,
            times=np.arange(len(states), dtype=np.float64) * self._backend.timestep,
            states=states,
            commands=np.zeros((len(moved), self.action_layout.size)),
            instances=(),
            exits={},
            goal=(),
            backend=self._backend.name,
            timestep=self._backend.timestep,
        )
