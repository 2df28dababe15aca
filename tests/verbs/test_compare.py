"""``run --compare``: the values of the optimised plan and of its defaults, predicted and measured."""

import json
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from cli.test_optimising import DOMAIN, TASK
from midlevel.pucks import JOINT, puck_plan, puck_task

from hybrid_tamp.model.outcome import PlannerFigures, PlanOutcome
from hybrid_tamp.model.planned_network import PlannedNetwork
from hybrid_tamp.model.task import Task
from hybrid_tamp.report.documents import parse_document
from hybrid_tamp.verbs.run import run

Command = Callable[..., "subprocess.CompletedProcess[str]"]


def find_sliding(task: Task) -> PlanOutcome:
    return PlanOutcome(task, PlannerFigures("by hand", 0.0), PlannedNetwork.of(task, task), puck_plan(), chosen=task)


def test_both_choices_are_predicted_and_measured_in_the_same_physics(tmp_path: Path) -> None:
    result = run(puck_task(), tmp_path, backend="analytic", compare=True, find_plan=find_sliding)
    best, defaults = result.comparison
    assert (best.hyperparameters, defaults.hyperparameters) == ("optimised", "defaults")
    assert best.measured is not None
    assert defaults.measured is not None
    assert best.predicted.value == pytest.approx(JOINT, abs=1e-3)
    assert best.measured.value == pytest.approx(best.predicted.value, abs=1e-6)
    assert defaults.measured.value == pytest.approx(defaults.predicted.value, abs=1e-6)
    assert defaults.measured.value < best.measured.value
    written = parse_document("result-1", (tmp_path / "result.json").read_bytes())
    assert [each["measured"]["value"] for each in written["comparison"]] == [
        best.measured.value,
        defaults.measured.value,
    ]
    recorded = result.outcome.required()
    assert [i.hyperparameters for i in result.recording.plan.instances] == [
        i.hyperparameters for i in recorded.instances
    ]


def test_nothing_else_is_run_unless_asked(tmp_path: Path) -> None:
    assert run(puck_task(), tmp_path, backend="analytic", find_plan=find_sliding).comparison == ()
    assert "Optimised hyperparameters and defaults" not in (tmp_path / "report.html").read_text()


def test_terminal_and_page_show_a_failed_run_of_the_defaults(command: Command, tmp_path: Path) -> None:
    (tmp_path / "domain.py").write_text(DOMAIN)
    (tmp_path / "slide.yaml").write_text(TASK)
    words = ("run", tmp_path / "slide.yaml", "--domain", tmp_path / "domain.py", "-o", tmp_path / "run", "--compare")
    done = command(*words, "--backend", "analytic", "--evaluations", "400")
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    shown = lines[next(i for i, line in enumerate(lines) if "Predicted and measured value" in line) :]
    (best,) = (line.split() for line in shown if line.startswith("optimised "))
    assert float(best[1]) == pytest.approx(float(best[2]), abs=1e-3)
    (defaults,) = (line for line in shown if line.startswith("defaults "))
    assert "violates conditions by" in defaults
    assert defaults.rstrip().endswith("a failed run")
    assert [line for line in lines if len(line) > 80 and str(tmp_path) not in line] == []
    assert "a failed run" in (tmp_path / "run" / "report.html").read_text()
    assert json.loads((tmp_path / "run" / "result.json").read_text())["comparison"][1]["measured"] is None
