"""Tests of the command ``check-domain``: its messages, its document and its exit statuses."""

import json
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
Command = Callable[..., "subprocess.CompletedProcess[str]"]
TASK = """\
domain: carts
tokens:
  red:
    classes: [CART]
    properties: {mass: 4, maximal_force: 40}
    shape: {kind: box, half_extents: [0.2, 0.1, 0.1]}
    pose: {position: [0, 0, 0.1]}
  near:
    classes: [DOCK]
    properties: {radius: 0.05}
    pose: {position: [2, 0, 0]}
  far:
    classes: [DOCK]
    properties: {radius: 0.05}
    pose: {position: [3, 1, 0]}
goal:
  - docked: [red, near]
"""
QUICK = ("--samples", "1", "--no-physics")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with the example of a domain and a task file."""
    (tmp_path / "domain.py").write_text((ROOT / "examples" / "domain.py").read_text(encoding="utf-8"), encoding="utf-8")
    (tmp_path / "task.yaml").write_text(TASK, encoding="utf-8")
    (tmp_path / "other.yaml").write_text("domain: other\n", encoding="utf-8")
    return tmp_path


def change(folder: Path, old: str, new: str) -> None:
    text = (folder / "domain.py").read_text(encoding="utf-8")
    assert old in text
    (folder / "domain.py").write_text(text.replace(old, new), encoding="utf-8")


def test_a_correct_domain_is_checked_with_the_task_beside_it(command: Command, folder: Path) -> None:
    done = command("check-domain", folder / "domain.py", "--samples", "1")
    assert done.returncode == 0, done.stderr
    assert done.stdout == "carts: no mistakes in 2 blocks, checked with the task task\n"


def test_mistakes_are_listed_with_block_role_figure_and_remedy(command: Command, folder: Path) -> None:
    change(folder, 'writes={"cart": ("position", "velocity")}', 'writes={"cart": ("position",)}')
    done = command("check-domain", folder / "domain.py", *QUICK)
    assert done.returncode == 30, done.stderr
    words = " ".join(done.stdout.split())
    for said in (
        "Mistakes in carts",
        "writes",
        "DRIVING",
        "cart",
        "the velocity of red changes by",
        "add the property",
    ):
        assert said in words or said.replace(" ", "") in words.replace(" ", "").replace("│", ""), done.stdout
    done = command("check-domain", folder / "domain.py", *QUICK, "--json")
    assert done.returncode == 30
    document = json.loads(done.stdout)
    assert (document["schema"], document["status"]) == ("hybrid-tamp/check-domain/1", "mistakes")
    assert document["tasks"] == ["task"]
    (mistake,) = [each for each in document["mistakes"] if each["kind"] == "writes"]
    assert (mistake["block"], mistake["role"], mistake["task"]) == ("DRIVING", "cart", "task")
    assert mistake["binding"]["cart"] == "red"
    assert mistake["measured"].startswith("the velocity of red changes by ")
    assert mistake["remedy"] == "add the property to 'writes', or leave the property unchanged"


def test_contradictory_declarations_are_wrong_input(command: Command, folder: Path) -> None:
    change(folder, '"duration", "s", 0.5, 20.0', '"duration", "s", 20.0, 0.5')
    done = command("check-domain", folder / "domain.py", *QUICK)
    assert done.returncode == 30
    assert "DRIVING.duration: the lower bound must not exceed the upper bound; got [20.0, 0.5] s" in done.stderr


def test_another_task_can_be_named(command: Command, folder: Path, tmp_path: Path) -> None:
    elsewhere = tmp_path / "elsewhere.yml"
    (folder / "task.yaml").rename(elsewhere)
    done = command("check-domain", folder / "domain.py", *QUICK)
    assert done.returncode == 30
    assert "the check needs a task of the domain carts; got no task" in done.stderr
    done = command("check-domain", folder / "domain.py", *QUICK, "--task", elsewhere, "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["tasks"] == ["elsewhere"]


@pytest.mark.parametrize("words", [("nothing.py",), ("no_such_domain",), ("tool_use", "--task", "no_such_task")])
def test_wrong_names_are_wrong_input(command: Command, words: tuple[str, ...]) -> None:
    done = command("check-domain", *words)
    assert done.returncode == 30
    assert done.stderr
