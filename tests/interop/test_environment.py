"""Environments follow Gymnasium's contract, and the commands of a run lead to the same states as in the run."""

import warnings
from collections.abc import Iterator
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import hybrid_tamp
from hybrid_tamp import InputError, Recording, State, Task, TaskPlan, make_environment
from hybrid_tamp.execution.execute import execute
from hybrid_tamp.interop.task_environment import TaskEnvironment
from hybrid_tamp.model.commands import CommandError
from hybrid_tamp.model.goal_distance import measure_goal_distance
from hybrid_tamp.physics.protocol import open_backend

ADVICE = ("infinity. This is probably too", "we recommend using a symmetric and normalized space")
"""Parts of the advice that does not apply: states have no bounds, and commands have SI units."""


@pytest.fixture
def environment() -> Iterator[TaskEnvironment]:
    with make_environment(hybrid_tamp.load_task("roll_cylinder")) as made:
        yield made


@pytest.fixture(scope="module")
def rolled(planned: tuple[Task, TaskPlan]) -> Recording:
    with open_backend("pybullet") as physics:
        return execute(*planned, physics)


@pytest.mark.parametrize("name", ["roll_cylinder", "hammer_strike", "tumble_two_boxes_four_hands"])
def test_gymnasiums_own_check_passes(name: str) -> None:
    with make_environment(hybrid_tamp.load_task(name)) as environment, warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        check_env(environment)
    assert [str(each.message) for each in told if not any(part in str(each.message) for part in ADVICE)] == []


def test_commands_of_a_run_lead_to_the_same_states(environment: TaskEnvironment, rolled: Recording) -> None:
    seen, _ = environment.reset(seed=1)
    assert seen.tobytes() == rolled.states[0].tobytes()
    start = seen
    rewards, ended = 0.0, []
    for commands, state in zip(rolled.commands, rolled.states[1:], strict=True):
        seen, reward, terminated, truncated, information = environment.step(commands)
        assert seen.tobytes() == state.tobytes()
        assert not truncated
        rewards += reward - terminated
        ended.append(terminated)
    assert ended[-1]
    assert not ended[0]
    assert information["time"] == pytest.approx(rolled.duration)
    assert information["margins"] == {each.atom.text: each.measured for each in rolled.goal}
    # Without the rewards of the goal, the rewards add up to the decrease of the distance.
    first, last = (measure_goal_distance(environment.task, State(rolled.layout, each)) for each in (start, seen))
    assert rewards == pytest.approx(float(first - last))
    assert first > last


def test_an_action_above_its_limit_is_scaled_down(environment: TaskEnvironment) -> None:
    environment.reset()
    above = environment.step(np.array([3000.0, 4000.0, 0.0]))[0]
    environment.reset()
    at = environment.step(np.array([180.0, 240.0, 0.0]))[0]
    np.testing.assert_allclose(above, at)
    assert State(environment.observation_layout, at)["hand", "velocity"][0] > 0.3


def test_a_command_at_its_limit_keeps_its_bits(environment: TaskEnvironment) -> None:
    """A command that was scaled down may exceed its limit by a rounding error."""
    layout = environment.action_layout
    rows = [layout.limited(row)[0] for row in 1000.0 * np.random.default_rng(0).standard_normal((100, 3))]
    assert any(layout.limited(row)[1] for row in rows)
    assert all(environment._limit(row).tobytes() == row.tobytes() for row in rows)


def test_a_changed_observation_does_not_change_the_episode(environment: TaskEnvironment) -> None:
    environment.reset()
    wanted = environment.step(np.ones(3))[0]
    seen, _ = environment.reset()
    seen[:] = 0.0
    np.testing.assert_array_equal(environment.step(np.ones(3))[0], wanted)


@pytest.mark.parametrize("action", [np.zeros(2), np.zeros((1, 3)), np.array([np.nan, 0.0, 0.0])])
def test_a_wrong_action_is_refused(environment: TaskEnvironment, action: np.ndarray) -> None:
    environment.reset()
    with pytest.raises(CommandError, match=r"must (have shape \(3,\)|be finite), got"):
        environment.step(action)


def test_an_episode_ends_after_its_number_of_steps() -> None:
    with make_environment(hybrid_tamp.load_task("roll_cylinder"), most_steps=3) as environment:
        for _ in range(2):
            environment.reset()
            assert [environment.step(np.zeros(3))[3] for _ in range(3)] == [False, False, True]


def test_pictures_show_the_current_state(environment: TaskEnvironment, rolled: Recording) -> None:
    environment.reset()
    before = environment.render()
    assert before is not None
    assert before.dtype == np.uint8
    np.testing.assert_array_equal(before, environment.render())
    for commands in rolled.commands:
        environment.step(commands)
    after = environment.render()
    assert after is not None
    assert (before != after).any()
    for picture in (before, after):
        # The picture does not cut any token, because its edges show only the grey floor and the white background.
        edges = np.concatenate([picture[0], picture[-1], picture[:, 0], picture[:, -1]]).astype(int)
        assert np.ptp(edges, axis=-1).max() < 20 < np.ptp(picture.astype(int), axis=-1).max()


def test_the_specification_makes_environments_of_the_same_task(environment: TaskEnvironment) -> None:
    assert environment.spec is not None
    others = gymnasium.make_vec(environment.spec, 2, vectorization_mode="sync")
    seen, _ = others.reset(seed=0)
    assert seen.shape == (2, environment.observation_layout.size)
    np.testing.assert_array_equal(seen[1], environment.reset()[0])
    others.close()


def test_there_are_no_pictures_without_a_render_mode() -> None:
    with make_environment(hybrid_tamp.load_task("roll_cylinder"), render_mode=None) as environment:
        environment.reset()
        assert environment.render() is None


def test_an_episode_must_begin(environment: TaskEnvironment) -> None:
    for early in (environment.render, lambda: environment.step(np.zeros(3))):
        with pytest.raises(gymnasium.error.ResetNeeded, match=r"call reset\(\) before"):
            early()


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"backend": "analytic"}, "requires a physics backend that simulates bodies; got analytic; choose"),
        ({"backend": "pybulet"}, "did you mean 'pybullet'"),
        ({"render_mode": "human"}, "render_mode: expected a render mode, or None; got 'human'; available: rgb_array"),
    ],
)
def test_a_wrong_argument_is_named(wrong: dict[str, str], message: str) -> None:
    with pytest.raises(InputError, match=message):
        make_environment(hybrid_tamp.load_task("roll_cylinder"), **wrong)  # type: ignore[arg-type]


def test_a_task_without_hands_has_no_environment() -> None:
    task = hybrid_tamp.load_task("roll_cylinder").restrict({"drum", "goal"})
    with pytest.raises(InputError, match="task roll_cylinder: an environment requires a task with basic actions"):
        make_environment(task)


def test_the_remedy_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("hybrid_tamp.interop.environment.find_spec", lambda name: None)
    with pytest.raises(
        InputError, match=r"requires gymnasium, which is not installed; pip install 'hybrid-tamp\[gym\]'"
    ):
        make_environment(hybrid_tamp.load_task("roll_cylinder"))
    extras = (Path(__file__).resolve().parents[2] / "pyproject.toml").read_text(encoding="utf-8")
    assert 'gym = ["gymnasium' in extras
