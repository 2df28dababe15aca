"""Comparison of the analytic backend with closed forms."""

from typing import Any

import numpy as np
import pytest

from hybrid_tamp.model.commands import CommandError
from hybrid_tamp.model.state import State
from hybrid_tamp.physics.analytic import AnalyticBackend


def test_constant_force_gives_constant_acceleration(toys: Any) -> None:
    task = toys.world.pusher(mass=2.0).spot().task()
    force = np.array([3.0, 0.0, -1.0])
    steps = 240
    with AnalyticBackend() as backend:
        backend.reset(task, task.state)
        backend.assign([toys.move("MOVING-1", 0.0, 1.0)])
        for _ in range(steps):
            state = backend.step({("pusher", "force"): force})
        assert backend.contact_forces() == []
    time = steps * backend.timestep
    assert state["pusher", "velocity"] == pytest.approx(force / 2.0 * time)
    # Semi-implicit Euler is ahead of the parabola by half the distance of a step.
    ahead = (1 + 1 / steps) / 2
    assert state["pusher", "position"] == pytest.approx(np.array([0, 0, 0.5]) + force / 2.0 * time**2 * ahead)


def test_what_no_instance_holds_stays(toys: Any) -> None:
    task = toys.world.pusher("one").pusher("two", position=(0.0, 1.0, 0.5)).spot().task()
    with AnalyticBackend() as backend:
        start = backend.reset(task, task.state)
        backend.assign([toys.move("MOVING-1", 0.0, 1.0, pusher="one")])
        state = backend.step({(name, "force"): np.ones(3) for name in ("one", "two")})
    assert state["one", "velocity"][0] > 0
    assert np.array_equal(state["two", "position"], start["two", "position"])
    assert np.array_equal(start.values, task.state.values)


def test_a_system_speaks_for_its_own_slots_only(toys: Any) -> None:
    def meddling(binding: Any, start: State) -> Any:
        return lambda state, commands, dt: State(state.layout, state.values + 1.0)

    task = toys.world.block(system=meddling).pusher().spot().task()
    with AnalyticBackend() as backend:
        start = backend.reset(task, task.state)
        backend.assign([toys.move("MOVING-1", 0.0, 1.0)])
        state = backend.step({})
    assert state["pusher", "position"][0] == start["pusher", "position"][0] + 1
    assert np.array_equal(state["spot", "position"], start["spot", "position"])


def test_commands_that_are_not_given_are_zero_and_bad_ones_refused(toys: Any) -> None:
    task = toys.one_move_task()
    with AnalyticBackend() as backend:
        start = backend.reset(task, task.state)
        backend.assign([toys.move("MOVING-1", 0.0, 1.0)])
        assert np.array_equal(backend.step({}).values, start.values)
        with pytest.raises(CommandError, match="must not exceed its limit"):
            backend.step({("pusher", "force"): np.array([101.0, 0, 0])})
