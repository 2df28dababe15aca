"""Output and files of the command line when it optimises hyperparameters, in the domain of pucks."""

import json
import os
import pty
import subprocess
import sys
from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path

import pytest
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
Command = Callable[..., "subprocess.CompletedProcess[str]"]
DOMAIN = f"""
import sys
sys.path.insert(0, {str(ROOT / "tests")!r})
from dataclasses import replace
import numpy as np
from hybrid_tamp.model.predicate import Parameter, Predicate
from midlevel.pucks import FIRST, SECOND, Puck, puck_task

def _across(state, puck):
    return np.abs(state[puck, "place"][..., 1]) - 0.1

ACROSS = Predicate("across", (Parameter("puck", Puck),), _across, reads={{"puck": ("place",)}})
SECOND = replace(SECOND, exit=(*SECOND.exit, ACROSS("puck")))
base = puck_task().domain
new = {{"FIRST": replace(FIRST, keeps=(ACROSS,)), "SECOND": SECOND}}
blocks = tuple(new.get(block.name, block) for block in base.blocks)
DOMAIN = replace(base, predicates=(*base.predicates, ACROSS), blocks=blocks)
"""
TASK = """
domain: pucks
tokens:
  puck <b>:
    classes: [PUCK]
    pose: {position: [0, 0, 0]}
goal:
  - across: ["puck <b>"]
"""


@pytest.fixture(scope="module")
def words(tmp_path_factory: pytest.TempPathFactory) -> list[str | Path]:
    folder = tmp_path_factory.mktemp("pucks")
    (folder / "domain.py").write_text(DOMAIN)
    (folder / "slide.yaml").write_text(TASK)
    return [folder / "slide.yaml", "--domain", folder / "domain.py"]


@pytest.fixture(scope="module")
def ran(
    command: Command, words: list[str | Path], tmp_path_factory: pytest.TempPathFactory
) -> tuple[Path, "subprocess.CompletedProcess[str]"]:
    folder = tmp_path_factory.mktemp("run")
    return folder, command("run", *words, "-o", folder, "--backend", "analytic", "--evaluations", "400")


def test_a_run_shows_what_was_optimised(ran: tuple[Path, "subprocess.CompletedProcess[str]"]) -> None:
    folder, done = ran
    assert done.returncode == 0, done.stderr
    assert done.stderr == "", "progress is for terminals"
    lines = done.stdout.splitlines()
    assert max(len(line) for line in lines if str(folder.parent) not in line) <= 80
    (along,) = (line.split() for line in lines if "SECOND-1.along" in line)
    assert along[-2] == along[-1], "predicted and measured"
    (own,) = (line.split() for line in lines if line.startswith("  b [m]"))
    assert own[-3:] == ["1", "optimised", "3"], "the upper bound, the status, and the measure that it moves"
    (together,) = (float(line.split()[-1]) for line in lines if line.startswith("all actions together"))
    apart = next(line.split() for line in lines if line.startswith("each action on its own"))
    assert together == pytest.approx(-0.18, abs=0.01)
    assert float(apart[-1]) == pytest.approx(together - float(apart[-2]), abs=1e-3)
    assert any("violates conditions by" in line for line in lines if line.startswith("the defaults"))


class Page(HTMLParser):
    """The files that a browser would fetch from a page, and the tags that it would open."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.names: list[str] = []
        self.tags: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.names += [value for name, value in attrs if name in ("src", "href") and value is not None]


def test_a_run_leaves_a_page_whose_files_are_beside_it(ran: tuple[Path, object]) -> None:
    folder, _ = ran
    text = (folder / "report.html").read_text(encoding="utf-8")
    page = Page(text)
    assert set(page.names) >= {"step-01.png", "convergence.png", "result.json"}
    assert all((folder / name).is_file() for name in page.names)
    assert {"script", "b"}.isdisjoint(page.tags), "names are escaped"
    for wanted in ("puck &lt;b&gt;", "FIRST-1.start", "The recording obeys the law", "violates conditions by"):
        assert wanted in text
    with Image.open(folder / "convergence.png") as picture:
        assert picture.width > picture.height > 300


def test_the_page_is_written_again_from_the_documents(command: Command, ran: tuple[Path, object]) -> None:
    folder, _ = ran
    before = (folder / "report.html").read_text()
    (folder / "report.html").unlink()
    done = command("report", folder, "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["file"] == str(folder / "report.html")
    assert (folder / "report.html").read_text() == before


def test_a_folder_without_documents_has_no_page(command: Command, tmp_path: Path) -> None:
    done = command("report", tmp_path)
    assert done.returncode == 30
    assert str(tmp_path / "plan.json") in done.stderr
    (tmp_path / "plan.json").write_text('{"schema": "hybrid-tamp/plan/2"}')
    done = command("report", tmp_path)
    assert done.returncode == 30
    assert "published JSON Schema" in done.stderr
    assert not (tmp_path / "report.html").exists()


def test_a_plan_is_optimised_without_a_run(command: Command, words: list[str | Path]) -> None:
    done = command("plan", *words, "--optimise", "--optimiser", "grid", "--evaluations", "300", "--json")
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)["refinement"]
    assert found["optimiser"] == "grid"
    assert found["evaluations"] <= 320
    assert found["best"]["violation"] == 0
    assert json.loads(command("plan", *words, "--json").stdout)["refinement"] is None


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--evaluations", "9"], "--optimise"),
        (["--optimise", "--evaluations", "0"], "evaluations"),
        (["--optimise", "--optimiser", "simplex"], "optimiser"),
        (["--optimise", "--refine", "twice"], "refine"),
    ],
)
def test_wrong_settings_end_with_status_30(
    command: Command, words: list[str | Path], options: list[str], said: str
) -> None:
    done = command("plan", *words, *options)
    assert done.returncode == 30
    assert said in done.stderr


def test_a_domain_that_computes_nothing_is_a_wrong_input(
    command: Command, words: list[str | Path], tmp_path: Path
) -> None:
    (tmp_path / "nan.py").write_text(
        DOMAIN
        + "from hybrid_tamp.model.measure import Measure\n"
        + "def nothing(b, before, after, h):\n    return after[b['puck'], 'place'][..., 0] * np.nan\n"
        + "nothing = Measure('nothing', 'm', 1.0, end=nothing)\n"
        + "DOMAIN = DOMAIN.with_blocks([replace(SECOND, performance=(nothing,))])\n"
    )
    done = command("plan", words[0], "--domain", tmp_path / "nan.py", "--optimise", "--json")
    assert done.returncode == 30
    document = json.loads(done.stdout)
    assert document["error"] == "NotFinite"
    assert document["issues"][0]["where"] == "SECOND-1"
    assert "block SECOND has the first non-finite result" in done.stderr


def test_progress_shows_the_best_value_on_a_terminal(words: list[str | Path]) -> None:
    ours, terminal = pty.openpty()
    line = [sys.executable, "-m", "hybrid_tamp.cli", "plan", *map(str, words), "--optimise", "--evaluations", "400"]
    with subprocess.Popen(line, stdout=subprocess.PIPE, stderr=terminal, text=True, cwd=ROOT) as process:
        os.close(terminal)
        shown = b""
        while chunk := _read(ours):
            shown += chunk
        printed, _ = process.communicate(timeout=120)
    os.close(ours)
    assert process.returncode == 0
    assert b"optimising: value" in shown
    assert "optimising" not in printed


def _read(terminal: int) -> bytes:
    try:
        return os.read(terminal, 4096)
    except OSError:  # the other end is closed
        return b""


def test_the_network_of_a_task_and_of_a_domain(command: Command, words: list[str | Path]) -> None:
    found = json.loads(command("network", *words, "--json").stdout)
    assert found["schema"] == "hybrid-tamp/network/1"
    assert ["FIRST.puck", "SECOND.puck"] in found["edges"]
    assert len(found["edges"]) == 3
    assert {"name": "FIRST", "slots": {"puck": "PUCK"}} in found["blocks"]
    shown = command("network", "rolling_tumbling").stdout
    assert "38 edges" in shown
    assert "RESTING.token, ROLLING.hand" in shown
    assert command("network", "roll_cilinder").returncode == 30
