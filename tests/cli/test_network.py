"""Drawings that the verb `network` writes, and the files that it refuses."""

import json
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path

import pytest

from hybrid_tamp.errors import InputError
from hybrid_tamp.verbs.network import network

Command = Callable[..., "subprocess.CompletedProcess[str]"]
ROLL = "problems/roll_cylinder.yaml"


def test_a_task_is_drawn_with_its_plan_and_always_in_the_same_way(tmp_path: Path) -> None:
    first, second = tmp_path / "one.svg", tmp_path / "two.svg"
    for file in (first, second):
        network(ROLL, file=file, reduced=True, plan=True)
    assert first.read_bytes() == second.read_bytes()


def test_the_command_writes_a_drawing_and_names_its_file(command: Command, tmp_path: Path) -> None:
    file = tmp_path / "network.mmd"
    done = command("network", "roll_cylinder", "-o", file, "--reduced", "--plan", "--json")
    assert done.returncode == 0, done.stderr
    document = json.loads(done.stdout)
    assert document["file"] == str(file)
    assert [block["name"] for block in document["blocks"]] == ["REACHING:behind", "ROLLING", "RESTING"]
    text = file.read_text(encoding="utf-8")
    assert '["ROLLING"]' in text
    assert "TIPPING" not in text
    assert '-->|"drum"|' in text


def test_a_reduced_network_has_the_blocks_that_the_task_needs() -> None:
    blocks = [block.name for block in network("roll_cylinder", reduced=True).blocks]
    assert blocks == ["REACHING:behind", "ROLLING", "RESTING"]
    assert len(network("roll_cylinder").blocks) == 10


def test_a_tool_without_which_no_block_achieves_the_goal_is_in_the_reduced_network() -> None:
    assert "GRASPING" in {block.name for block in network("tool_among_distractors", reduced=True).blocks}


def test_only_a_task_can_be_reduced_or_planned(tmp_path: Path) -> None:
    for flags in ({"reduced": True}, {"plan": True, "file": tmp_path / "a.svg"}):
        with pytest.raises(InputError, match="give a task instead of the domain"):
            network("rolling_tumbling", **flags)  # type: ignore[arg-type]


def test_a_plan_needs_a_file(command: Command) -> None:
    done = command("network", "roll_cylinder", "--plan")
    assert done.returncode == 30
    assert done.stderr == "--plan and --force must be used together with --output\n"


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("a.pdf", r"must end in \.svg, \.png, \.dot \(Graphviz\) or \.mmd \(Mermaid\); got \.pdf"),
        ("a", "got no suffix"),
        ("none/a.svg", "must be in an existing folder; got .*none, which does not exist"),
        ("file/a.svg", "which is a file"),
        ("folder.svg", "must be a file; got a folder"),
    ],
)
def test_files_that_cannot_be_written_are_refused_with_the_reason(name: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    (tmp_path / "folder.svg").mkdir()
    with pytest.raises(InputError, match=message):
        network("rolling_tumbling", file=tmp_path / name)


def test_an_existing_file_is_kept_without_force(command: Command, tmp_path: Path) -> None:
    file = tmp_path / "a.dot"
    file.write_text("mine")
    words = ("network", "rolling_tumbling", "-o", file)
    done = command(*words)
    assert done.returncode == 30
    assert done.stderr.startswith(f"{file}: the file for the drawing must not exist yet; got an existing file; --force")
    assert file.read_text() == "mine"
    assert command(*words, "--force").returncode == 0
    assert file.read_text().startswith("digraph")


def test_an_unwritable_folder_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(**_: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(tempfile, "mkstemp", refuse)  # Root may write everywhere, so the folder's mode has no effect.
    with pytest.raises(InputError, match="cannot write to the output folder"):
        network("rolling_tumbling", file=tmp_path / "a.dot")


def test_a_task_without_a_plan_is_not_drawn(command: Command, tmp_path: Path) -> None:
    file = tmp_path / "a.svg"
    done = command("network", "tumble_one_hand", "-o", file, "--plan")
    assert done.returncode == 10
    assert not file.exists()
