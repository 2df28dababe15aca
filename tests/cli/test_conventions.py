"""Help texts, completion, lists, terminals of different widths, and progress."""

import json
import os
import pty
import re
import shlex
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
import typer

from hybrid_tamp.cli.app import app
from hybrid_tamp.model.listings import InstalledEngine
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.symbolic.engines.registry import known_engines
from hybrid_tamp.taskfile.domains import bundled_tasks
from hybrid_tamp.verbs import compare_planners
from hybrid_tamp.verbs.loading import Settings

Command = Callable[..., "subprocess.CompletedProcess[str]"]
CLI = [sys.executable, "-m", "hybrid_tamp.cli"]
GROUP = typer.main.get_command(app)
VERBS = sorted(GROUP.commands)  # type: ignore[attr-defined]


def printed(*words: str, **environment: str) -> str:
    """Return the standard output of the command line with further environment variables."""
    done = subprocess.run([*CLI, *words], capture_output=True, text=True, env={**os.environ, **environment}, check=True)
    return done.stdout


@pytest.mark.parametrize("verb", VERBS)
def test_every_help_text_has_an_example_that_the_verb_accepts(verb: str) -> None:
    command = GROUP.commands[verb]  # type: ignore[attr-defined]
    (example,) = re.findall(r"^Example: hybrid-tamp (.*)$", command.help, re.MULTILINE)
    first, *words = shlex.split(example.partition(" > ")[0])
    assert first == verb
    command.make_context(verb, words)


@pytest.mark.parametrize("verb", VERBS)
def test_the_list_of_verbs_shortens_no_description(verb: str) -> None:
    assert not GROUP.commands[verb].get_short_help_str(62).endswith("...")  # type: ignore[attr-defined]


def test_both_flags_print_the_help() -> None:
    assert printed("plan", "-h") == printed("plan", "--help")
    assert "[default: pybullet]" in printed("run", "-h", COLUMNS="200")
    assert "--planner NAME" in printed("run", "-h")
    assert "[default: (from the task file)]" in printed("run", "-h", COLUMNS="200")


@pytest.mark.parametrize(
    ("typed", "completed"),
    [
        ("hybrid-tamp pl", ["plan", "planners"]),
        ("hybrid-tamp plan tumble_t", [name for name in bundled_tasks() if name.startswith("tumble_t")]),
        ("hybrid-tamp plan --planner fast", [name for name in known_engines() if name.startswith("fast")]),
    ],
)
def test_the_shell_completes_verbs_tasks_and_planners(typed: str, completed: list[str]) -> None:
    place = str(len(typed.split()) - 1)
    answer = printed(_HYBRID_TAMP_COMPLETE="complete_bash", COMP_WORDS=typed, COMP_CWORD=place)
    assert answer.split() == completed


def test_tasks_lists_every_bundled_task_with_its_domain() -> None:
    listed = json.loads(printed("tasks", "--json"))["tasks"]
    assert [each["name"] for each in listed] == list(bundled_tasks())
    (roll,) = (each for each in listed if each["name"] == "roll_cylinder")
    assert roll["domain"] == "rolling_tumbling"
    assert roll["description"] == "One hand rolls a cylinder into a goal region."
    assert Path(roll["path"]).is_file()


def test_planners_says_which_engines_are_installed() -> None:
    listed = {each["name"]: each for each in json.loads(printed("planners", "--json"))["planners"]}
    assert tuple(listed) == known_engines()
    assert listed["symk-opt"]["length"] == "proven fewest"
    assert listed["fast-downward"]["version"]
    assert all(bool(each["version"]) != bool(each["remedy"]) for each in listed.values())


def test_the_planners_are_compared(monkeypatch: pytest.MonkeyPatch) -> None:
    listed = [InstalledEngine(name, "1", "", "first found", True) for name in ("fast-downward", "pyperplan-opt")]
    monkeypatch.setattr(
        compare_planners, "list_engines", lambda: [*listed, InstalledEngine("lpg", None, "", "first found", False)]
    )
    with PlannerProcess() as process:
        first, second = compare_planners.compare_planners("roll_cylinder", process)
        (refused, _) = compare_planners.compare_planners("roll_cylinder_off_axis", process, Settings())
    assert (first.planner, first.status, first.actions) == ("fast-downward", "solved", 5)
    assert (second.planner, second.actions, second.message) == ("pyperplan-opt", 5, "proven fewest")
    assert (refused.status, refused.actions, refused.message) == ("unsolvable", None, "")


@pytest.mark.parametrize("words", [["tasks"], ["planners"], ["domains"], ["network", "rolling_tumbling"]])
def test_tables_fit_the_terminal_and_break_no_word(words: list[str]) -> None:
    narrow, wide = printed(*words, COLUMNS="80"), printed(*words, COLUMNS="160")
    assert max(map(len, narrow.splitlines())) <= 80
    assert max(len(line.rstrip()) for line in wide.splitlines()) > 80
    assert set(re.findall(r"[\w*.:-]+", wide)) - set(re.findall(r"[\w*.:-]+", narrow)) == set()


def test_without_a_terminal_there_are_no_colours_and_no_progress(command: Command) -> None:
    done = command("plan", "roll_cylinder")
    assert "\x1b" not in done.stdout + done.stderr
    assert "planning" not in done.stderr


def test_a_terminal_shows_the_activity() -> None:
    ours, theirs = pty.openpty()
    done = subprocess.run([*CLI, "plan", "roll_cylinder"], stdout=subprocess.PIPE, stderr=theirs, check=True)
    os.close(theirs)
    assert b"planning" in os.read(ours, 10_000)
    assert b"planning" not in done.stdout
    os.close(ours)


def test_verbose_shows_the_stages_and_their_times(command: Command) -> None:
    lines = command("-v", "plan", "roll_cylinder").stderr.splitlines()
    assert re.fullmatch(r" *\d+ ms  read the task roll_cylinder: 3 tokens of the domain rolling_tumbling", lines[0])
    assert re.match(r" *\d+ ms  fast-downward planned roll_cylinder in [\d.]+ s: 5 actions, 5.96 s \(", lines[1])


def test_an_unsolvable_run_names_its_page_and_the_best_suggestion(command: Command, tmp_path: Path) -> None:
    done = command("run", "tumble_one_hand", "-o", tmp_path / "out")
    assert done.returncode == 10
    assert "There is a plan of 17 actions with one more token like hand-1" in done.stderr
    page = tmp_path / "out" / "report.html"
    assert done.stderr.endswith(f"The page {page} shows the reasons.\n")
    assert page.is_file()
