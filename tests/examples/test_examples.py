"""The examples run and have the results that they describe."""

import importlib.util
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import hybrid_tamp
from hybrid_tamp.model.law import check_law
from hybrid_tamp.report.folder import RunFolder

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def example(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_example_is_tested() -> None:
    tested = {"domain", "environment", "external_planner", "planning_engines", "reading_a_recording", "task_in_python"}
    assert {path.stem for path in EXAMPLES.glob("*.py")} - {"__init__"} == tested


def test_a_task_built_in_python(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plan = example("task_in_python").main(tmp_path)
    task = hybrid_tamp.load_task(tmp_path / "two_drums.yaml")
    assert check_law(task, plan) == []
    assert capsys.readouterr().out == f"{plan}\n"
    assert "ROLLING-2" in str(plan)


def test_a_domain(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    result = example("domain").main(tmp_path / "run")
    assert result.success
    assert capsys.readouterr().out == f"{result}\n"
    # A run of a task without a file writes a task file, from which the run can be replayed.
    report = hybrid_tamp.replay(tmp_path / "run", lambda name: result.task.domain)
    assert report.identical


def test_the_command_line_takes_the_domain_of_the_example() -> None:
    words = [sys.executable, "-m", "hybrid_tamp.cli", "network", str(EXAMPLES / "domain.py")]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    assert "DRIVING" in done.stdout


def test_reading_a_recording(tmp_path: Path) -> None:
    figures = example("reading_a_recording").main(tmp_path / "run")
    assert figures["path length [m]"] == pytest.approx(0.7, abs=0.03)
    assert figures["largest speed before rolling [m/s]"] < 0.02 < figures["largest speed [m/s]"]
    assert 0 < figures["largest force of the hand [N]"] <= 300
    recording = hybrid_tamp.load_recording(tmp_path / "run" / "recording.npz")
    np.testing.assert_array_equal(recording.commanded("hand", "force"), recording.commands)
    with pytest.raises(KeyError):
        recording.commanded("drum", "force")


def test_another_planner(tmp_path: Path) -> None:
    plan = example("external_planner").main(tmp_path)
    task = hybrid_tamp.load_task("tumble_two_hands")
    assert check_law(task, plan) == []
    text = (tmp_path / "external.plan").read_text()
    last = text.splitlines()[-1]
    for wrong in (
        "",
        "(no-such-action a)",
        text.replace(" box ", " bux "),
        text.replace(last, ""),
        text.replace(last, "(x"),
    ):
        (tmp_path / "wrong.plan").write_text(wrong)
        with pytest.raises(hybrid_tamp.InputError, match=r"wrong\.plan: expected a plan of the task tumble_two_hands"):
            hybrid_tamp.read_plan(task, tmp_path / "wrong.plan")
    with pytest.raises(hybrid_tamp.InputError, match="expected a readable plan file"):
        hybrid_tamp.read_plan(task, tmp_path / "none.plan")


def test_planning_engines(capsys: pytest.CaptureFixture[str]) -> None:
    plans = example("planning_engines").main()
    task = hybrid_tamp.load_task("hammer_strike")
    assert list(plans) == ["fast-downward", "pyperplan"]
    assert all(check_law(task, plan) == [] for plan in plans.values())
    assert "pyperplan: 15 actions" in capsys.readouterr().out


def test_an_environment(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    total = example("environment").main(tmp_path / "run")
    assert 60 < total < 80
    assert capsys.readouterr().out.startswith("reached the goal at ")
    assert (tmp_path / "run" / "last.png").stat().st_size > 1000


def test_results_print_as_tables(tmp_path: Path) -> None:
    outcome = hybrid_tamp.plan("roll_cylinder_off_axis", folder=RunFolder.create(tmp_path))
    assert str(outcome).startswith("task")
    assert "<table>" in outcome._repr_html_()
    assert outcome.failure is not None
    assert outcome.failure.message in str(outcome)


@pytest.mark.parametrize("name", ["sweeping", "drawer", "placing"])
def test_a_domain_of_at_most_80_lines_reaches_its_goal_in_physics(name: str, tmp_path: Path) -> None:
    folder = EXAMPLES / name
    assert len((folder / "domain.py").read_text(encoding="utf-8").splitlines()) <= 80
    result = hybrid_tamp.run(folder / "task.yaml", tmp_path)
    assert result.success
    assert check_law(result.task, result.outcome.required()) == []


def test_a_new_domain_is_the_example_and_is_never_overwritten(tmp_path: Path) -> None:
    written = hybrid_tamp.new(tmp_path / "mine")
    assert [path.name for path in written] == ["domain.py", "task.yaml", "test_domain.py"]
    for path in written:
        assert path.read_text(encoding="utf-8") == (EXAMPLES / "sweeping" / path.name).read_text(encoding="utf-8")
    with pytest.raises(hybrid_tamp.InputError, match="the folder must not contain"):
        hybrid_tamp.new(tmp_path / "mine")


def test_the_domain_beside_a_task_has_the_name_in_the_task(tmp_path: Path) -> None:
    hybrid_tamp.new(tmp_path)
    text = (tmp_path / "task.yaml").read_text(encoding="utf-8")
    (tmp_path / "task.yaml").write_text(text.replace("domain: sweeping", "domain: brushing"), encoding="utf-8")
    with pytest.raises(
        hybrid_tamp.InputError, match=r"domain.py in the folder of the task defines another domain; got 'brushing'"
    ):
        hybrid_tamp.load_task(tmp_path / "task.yaml")


def test_a_run_of_a_domain_in_a_file_is_replayed_from_its_own_folder(tmp_path: Path) -> None:
    hybrid_tamp.run(EXAMPLES / "drawer" / "task.yaml", tmp_path / "out")
    assert (tmp_path / "out" / "domain.py").is_file()
    assert hybrid_tamp.replay(tmp_path / "out").identical
