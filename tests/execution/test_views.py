"""Policies and systems see the same tokens in rollouts and in runs: those in their slots, and their targets."""

from typing import Any

import numpy as np
import pytest
from toys import free_motion, servo

from hybrid_tamp.errors import DomainError
from hybrid_tamp.execution.execute import execute
from hybrid_tamp.midlevel.rollout import Rollouts
from hybrid_tamp.model.control import CONTROL_PERIOD, Hyperparameter
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.view import View
from hybrid_tamp.physics.protocol import open_backend
from hybrid_tamp.testing import check_domain

OTHER = "elsewhere"


def peeking_policy(binding: Any, start: Any, parameters: Any) -> Any:
    inner = servo(binding, start, parameters)

    def policy(elapsed: Any, state: Any) -> Any:
        return {key: force + 0.0 * state[OTHER, "position"] for key, force in inner(elapsed, state).items()}

    return policy


def peeking_maker(binding: Any, start: Any, parameters: Any) -> Any:
    assert start[OTHER, "position"] is not None
    return servo(binding, start, parameters)


def peeking_system(binding: Any, start: Any) -> Any:
    inner = free_motion(binding, start)

    def system(state: Any, commands: Any, dt: float) -> Any:
        assert state[OTHER, "position"] is not None
        return inner(state, commands, dt)

    return system


def commanding_system(binding: Any, start: Any) -> Any:
    inner = free_motion(binding, start)

    def system(state: Any, commands: Any, dt: float) -> Any:
        return inner(state, {key: command + commands["aside", "force"] for key, command in commands.items()}, dt)

    return system


PEEKING = [
    pytest.param({"policy": peeking_policy}, "MOVING.policy", id="policy"),
    pytest.param({"policy": peeking_maker}, "MOVING.policy", id="maker of a policy"),
    pytest.param({"system": peeking_system}, "MOVING.system", id="system"),
    pytest.param({"system": commanding_system}, "MOVING.system", id="system that reads a command"),
]


def scene(toys: Any, **changes: Any) -> Task:
    world = toys.world.block(**changes).pusher().spot().spot(OTHER)
    task: Task = world.pusher(name="aside", position=(0, 3, 0.5)).task()
    return task


def fail(action: Any) -> str:
    with pytest.raises(DomainError) as caught:
        action()
    return str(caught.value)


@pytest.mark.parametrize(("changes", "where"), PEEKING)
def test_reading_another_token_fails_in_runs_as_in_rollouts(toys: Any, changes: Any, where: str) -> None:
    task, plan = scene(toys, **changes), toys.one_move()
    said = fail(lambda: Rollouts(task, plan)({}))
    assert said.startswith(f"{where}: the function must not raise an exception for pusher=pusher, spot=spot")
    assert OTHER in said or "aside" in said
    for name in ("analytic", "pybullet") if "policy" in changes else ("analytic",):
        with open_backend(name) as backend:
            assert fail(lambda backend=backend: execute(task, plan, backend)) == said
    (seen,) = check_domain(task, samples=1, simulate=False)
    assert (seen.kind, seen.block) == ("error" if "commanding" in str(changes) else "sees", "MOVING")
    assert seen.declared.startswith(where)


def test_the_initial_value_of_a_hyperparameter_sees_the_same_view(toys: Any) -> None:
    def peek(binding: Any, state: Any) -> Any:
        return 200.0 + state[OTHER, "position"][..., 0]

    task, plan = scene(toys, hyperparameters=(Hyperparameter("stiffness", "N/m", 1.0, 1000.0, peek),)), toys.one_move()
    said = fail(lambda: Rollouts(task, plan)({}))
    assert "contains only pusher, spot" in said
    with open_backend("analytic") as backend:
        assert fail(lambda: execute(task, plan, backend)) == said


def test_a_command_of_the_wrong_shape_fails_in_runs_as_in_rollouts(toys: Any) -> None:
    def flat(binding: Any, start: Any, parameters: Any) -> Any:
        return lambda elapsed, state: {("pusher", "force"): np.linalg.norm(state["pusher", "velocity"], axis=-1)}

    task, plan = scene(toys, policy=flat), toys.one_move()
    assert "must have the shape (1, 3)" in fail(lambda: Rollouts(task, plan)({}))
    with open_backend("analytic") as backend:
        said = fail(lambda: execute(task, plan, backend))
    assert "MOVING.policy, force of pusher: the result must have the shape (3,) for pusher=pusher, spot=spot" in said


def test_a_view_of_a_batch_is_written_back_to_the_tokens_of_the_instance_only(toys: Any) -> None:
    task = scene(toys)
    view = View({"pusher": task.value("pusher"), "spot": task.value("spot")}, task.state.layout)
    state = task.state.repeated(2)
    seen = view.of(state)
    changed = view.update(state, State(seen.layout, seen.values + CONTROL_PERIOD))
    for token, name in state.layout.slices:
        moved = CONTROL_PERIOD if token in ("pusher", "spot") else 0.0
        np.testing.assert_array_equal(changed[token, name], state[token, name] + moved)
