"""Whoever does what an error message suggests succeeds."""

import re
import shlex
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from hybrid_tamp.taskfile.domains import find_task_file

Command = Callable[..., "subprocess.CompletedProcess[str]"]
ROLL = find_task_file("roll_cylinder").read_text(encoding="utf-8")


def suggestion(error: str) -> str:
    """Return the word that an error message suggests."""
    (word,) = re.findall(r"(?:[Dd]id you mean '|Possible options: )([\w-]+)", error)
    return str(word)


@pytest.mark.parametrize(
    ("words", "wrong"),
    [
        ("check roll_cylindre", "roll_cylindre"),
        ("chek roll_cylinder", "chek"),
        ("check roll_cylinder --domian rolling_tumbling", "--domian"),
        ("check roll_cylinder --domain rolling_tumblin", "rolling_tumblin"),
        ("plan roll_cylinder --planner fast-downwrd", "fast-downwrd"),
    ],
)
def test_the_suggested_word_is_accepted(command: Command, words: str, wrong: str) -> None:
    refused = command(*words.split())
    assert refused.returncode == 30
    better = (suggestion(refused.stderr) if each == wrong else each for each in words.split())
    done = command(*better)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("right", "wrong"), [("maximal_force", "maximal_fource"), ("tokens:", "token:"), ("ROLLABLE", "ROLABLE")]
)
def test_the_suggested_key_of_a_task_file_is_accepted(command: Command, tmp_path: Path, right: str, wrong: str) -> None:
    file = tmp_path / "task.yaml"
    file.write_text(ROLL.replace(right, wrong), encoding="utf-8")
    refused = command("check", file)
    assert refused.returncode == 30
    (guess, *_) = re.findall(r"did you mean '([^']+)'", refused.stderr)
    file.write_text(file.read_text(encoding="utf-8").replace(wrong.rstrip(":"), guess), encoding="utf-8")
    assert command("check", file).returncode == 0


def test_force_replaces_the_files_of_another_plan(command: Command, tmp_path: Path) -> None:
    words = ("plan", "roll_cylinder", "-o", tmp_path / "out")
    assert command(*words).returncode == 0
    refused = command(*words)
    assert refused.returncode == 30
    assert "--force" in refused.stderr
    assert command(*words, "--force").returncode == 0


def test_a_recording_is_made_as_the_message_says(command: Command, tmp_path: Path) -> None:
    refused = command("replay", tmp_path / "out")
    (line,) = re.findall(r"'hybrid-tamp (run TASK [^']+)'", refused.stderr)
    words = [*shlex.split(line.replace("TASK", "roll_cylinder")), "--backend", "analytic"]
    assert command(*words).returncode == 0
    assert command("replay", tmp_path / "out").returncode == 0


def test_a_wrong_option_leads_to_the_help_of_its_verb(command: Command) -> None:
    refused = command("run", "roll_cylinder")
    (words,) = re.findall(r"see 'hybrid-tamp ([^']+)'", refused.stderr)
    assert "--output" in command(*words.split()).stdout


def test_an_unknown_task_leads_to_the_list_of_tasks(command: Command) -> None:
    (verb,) = re.findall(r"'hybrid-tamp (\w+)' lists", command("plan", "my_task").stderr)
    assert "roll_cylinder" in command(verb).stdout


def test_a_suggested_change_makes_the_task_solvable(command: Command, tmp_path: Path) -> None:
    text = find_task_file("roll_cylinder_off_axis").read_text(encoding="utf-8")
    file = tmp_path / "task.yaml"
    file.write_text(text, encoding="utf-8")
    refused = command("plan", file)
    (wanted,) = re.findall(r"with radius of goal set to ([\d.]+) m", refused.stderr.replace("\n", " "))
    file.write_text(text.replace("radius: 0.02", f"radius: {wanted}"), encoding="utf-8")
    assert command("plan", file).returncode == 0
