"""Tests of every command, every exit status and every document of the command line."""

import json
import shutil
import subprocess
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from validation import val_accepts_files

from hybrid_tamp.cli import main

ROOT = Path(__file__).resolve().parents[2]
ROLL = ROOT / "problems" / "roll_cylinder.yaml"
OFF_AXIS = ROOT / "problems" / "roll_cylinder_off_axis.yaml"
Command = Callable[..., "subprocess.CompletedProcess[str]"]


def valid(document: str, stem: str) -> dict[str, Any]:
    """Return the JSON document, after a check against its published schema."""
    data: dict[str, Any] = json.loads(document)
    schema = json.loads(files("hybrid_tamp.report.schemas").joinpath(f"{stem}.json").read_text(encoding="utf-8"))
    Draft202012Validator.check_schema(schema)
    Draft202012Validator(schema).validate(data)
    return data


@pytest.fixture(scope="module")
def ran(command: Command, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, "subprocess.CompletedProcess[str]"]:
    folder = tmp_path_factory.mktemp("run") / "out"
    return folder, command("run", ROLL, "-o", folder, "--json", "--video", folder / "video.mp4")


def test_plan_prints_one_valid_document(command: Command) -> None:
    done = command("plan", ROLL, "--json")
    assert done.returncode == 0, done.stderr
    plan = valid(done.stdout, "plan-1")
    assert plan["status"] == "solved"
    assert plan["planner"]["name"] == "fast-downward"
    for step in plan["steps"]:
        where = [token for entry in step["blocks"] for token in entry["slots"].values()]
        assert sorted(where) == ["drum", "hand"]


def test_plan_shows_a_table_to_people(command: Command) -> None:
    done = command("plan", ROLL)
    assert done.returncode == 0
    assert "ROLLING-1: hand=hand, object=drum -> region=goal" in done.stdout


def test_a_region_off_the_rolling_axis_is_proven_out_of_reach(command: Command) -> None:
    done = command("plan", OFF_AXIS, "--json")
    assert done.returncode == 10
    plan = valid(done.stdout, "plan-1")
    assert plan["status"] == "unsolvable"
    (reason,) = plan["explanation"]["reasons"]
    assert reason["atom"] == "on_rolling_line(drum, goal)"
    assert reason["margin"] == pytest.approx(-0.078)
    told = command("plan", OFF_AXIS)
    assert told.returncode == 10
    assert "goal is not on the rolling line of drum" in " ".join(told.stderr.split())


def test_pddl_is_written_for_other_planners_and_val_accepts_the_plan(command: Command, tmp_path: Path) -> None:
    done = command("pddl", ROLL, "-o", tmp_path, "--json")
    assert done.returncode == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["domain.pddl", "problem.pddl"]
    plan = json.loads(command("plan", ROLL, "--json").stdout)
    (tmp_path / "plan.pddl").write_text("\n".join(plan["actions"]) + "\n")
    assert val_accepts_files(tmp_path)


@pytest.mark.parametrize("encoding", ["classical", "temporal"])
def test_pddl_is_written_in_either_encoding_with_a_plan(command: Command, tmp_path: Path, encoding: str) -> None:
    done = command("pddl", ROLL, "-o", tmp_path, "--encoding", encoding, "--solve", "--json")
    assert done.returncode == 0
    assert json.loads(done.stdout)["encoding"] == encoding
    assert (":durative-action" in (tmp_path / "domain.pddl").read_text()) == (encoding == "temporal")
    assert val_accepts_files(tmp_path)
    assert command("pddl", ROLL, "-o", tmp_path / "x", "--encoding", "spatial").returncode == 30


def test_plan_writes_its_files(command: Command, tmp_path: Path) -> None:
    assert command("plan", ROLL, "-o", tmp_path / "p").returncode == 0
    assert val_accepts_files(tmp_path / "p")
    assert (tmp_path / "p" / "task.yaml").read_text() == ROLL.read_text()


def test_run_reaches_the_goal_and_leaves_every_file(ran: tuple[Path, "subprocess.CompletedProcess[str]"]) -> None:
    folder, done = ran
    assert done.returncode == 0, done.stderr
    result = valid(done.stdout, "result-1")
    assert json.loads((folder / "result.json").read_text()) == result
    valid((folder / "plan.json").read_text(), "plan-1")
    assert result["success"]
    assert result["law"] == []
    assert result["metrics"]["ROLLING-1.final_distance [m]"] < 0.02
    assert 0.9 <= result["metrics"]["ROLLING-1.roll_ratio"] <= 1.1
    exits = [e for block in result["blocks"] for e in block["exit"]]
    assert exits
    assert all(e["holds"] and e["predicted"] is not None and e["measured"] >= 0 for e in exits)
    names = {path.name for path in folder.iterdir()}
    assert names >= {
        *("task.yaml", "plan.json", "domain.pddl", "problem.pddl", "plan.pddl", "result.json"),
        *("recording.npz", "events.jsonl", "video.mp4", "report.html"),
    }
    pictures = {name for name in names if name.endswith(".png")}
    assert pictures == {"movements.png", *(f"step-{n:02d}.png" for n in (1, 2, 3, 4))}
    (pair,) = result["clearance"]
    assert (pair["instance"], pair["moving"], pair["other"]) == ("REACHING-1", "hand", "drum")
    assert abs(pair["measured"] - pair["distance"]) < 0.005
    assert [json.loads(line)["event"] for line in (folder / "events.jsonl").read_text().splitlines()][-1] == "goal"


def test_replay_is_bit_identical(command: Command, ran: tuple[Path, object]) -> None:
    done = command("replay", ran[0], "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["identical"] is True


def test_a_changed_recording_is_told_apart(command: Command, ran: tuple[Path, object], tmp_path: Path) -> None:
    folder = tmp_path / "copy"
    shutil.copytree(ran[0], folder)
    with np.load(folder / "recording.npz") as archive:
        arrays = dict(archive)
    name = next(key for key in arrays if key == "states")
    arrays[name][300, 0] += 1e-12
    np.savez(folder / "recording.npz", **arrays)
    done = command("replay", folder)
    assert done.returncode == 40
    assert "first differs at" in done.stdout


@pytest.mark.parametrize("damage", ["truncated", "empty", "text", "missing", "no task"])
def test_a_broken_recording_is_reported(
    command: Command, ran: tuple[Path, object], tmp_path: Path, damage: str
) -> None:
    folder = tmp_path / "copy"
    shutil.copytree(ran[0], folder)
    file = folder / "recording.npz"
    if damage == "truncated":
        file.write_bytes(file.read_bytes()[:5000])
    elif damage == "empty":
        file.write_bytes(b"")
    elif damage == "text":
        file.write_text("not a recording")
    elif damage == "missing":
        file.unlink()
    else:
        (folder / "task.yaml").unlink()
    done = command("replay", folder)
    assert done.returncode == 30
    assert str(folder) in done.stderr
    assert "Traceback" not in done.stderr


def test_another_run_is_not_overwritten_without_force(
    command: Command, ran: tuple[Path, object], tmp_path: Path
) -> None:
    folder = tmp_path / "copy"
    shutil.copytree(ran[0], folder)
    (folder / "notes.txt").write_text("mine")
    done = command("plan", ROLL, "-o", folder)
    assert done.returncode == 30
    assert "--force" in done.stderr
    assert (folder / "result.json").exists()
    assert command("plan", ROLL, "-o", folder, "--force").returncode == 0
    assert not (folder / "result.json").exists()
    assert (folder / "notes.txt").read_text() == "mine"


def test_bundled_tasks_are_found_by_name_from_anywhere(command: Command, tmp_path: Path) -> None:
    assert command("check", "roll_cylinder", cwd=tmp_path).returncode == 0
    done = command("check", "roll_cilinder", cwd=tmp_path)
    assert done.returncode == 30
    assert "did you mean" in done.stderr


def test_limits_end_with_status_20(command: Command) -> None:
    done = command("plan", ROLL, "--time-limit", "0.01", "--json")
    assert done.returncode == 20
    assert valid(done.stdout, "plan-1")["status"] == "limit"
    done = command("plan", ROLL, "--memory-limit", "1", "--json")
    assert done.returncode == 20
    assert valid(done.stdout, "plan-1")["explanation"]["kind"] == "memory"


@pytest.mark.parametrize("verb", ["check", "plan", "pddl", "run"])
def test_wrong_input_ends_with_status_30_in_every_verb(command: Command, tmp_path: Path, verb: str) -> None:
    task = tmp_path / "task.yaml"
    task.write_text("domain: rolling_tumbling\ntokens: {}\ngoal: [inside: [drum, goal]]\n")
    extra = ["-o", tmp_path / "out"] if verb in ("pddl", "run") else []
    done = command(verb, task, *extra, "--json")
    assert done.returncode == 30
    document = json.loads(done.stdout)
    assert document["schema"] == "hybrid-tamp/error/1"
    assert any(issue["where"].startswith(f"{task}:") for issue in document["issues"])
    assert str(task) in done.stderr


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["plan", "roll_cylinder", "--planner", "fast-downwards"], "did you mean 'fast-downward'"),
        (["plan", "roll_cylinder", "--planner", "tamer"], "pip install up-tamer"),
        (["run", "roll_cylinder", "--backend", "bullet"], "Missing option"),
        (["plan"], "Missing argument"),
        (["fly"], "No such command"),
        (["plan", "roll_cylinder", "--time-limit", "-1"], "time-limit"),
    ],
)
def test_wrong_words_end_with_status_30(command: Command, words: list[str], said: str) -> None:
    done = command(*words)
    assert done.returncode == 30
    assert said.casefold() in done.stderr.casefold()


def test_unknown_backend(command: Command, tmp_path: Path) -> None:
    done = command("run", ROLL, "-o", tmp_path / "out", "--backend", "bullet")
    assert done.returncode == 30
    assert "pybullet" in done.stderr


def test_domains_and_schemas(capsys: pytest.CaptureFixture[str]) -> None:
    def printed(*words: str) -> str:
        assert main([*words]) == 0
        return capsys.readouterr().out

    listed = json.loads(printed("domains", "--json"))
    assert [domain["name"] for domain in listed["domains"]] == ["joint_lifting", "rolling_tumbling", "tool_use"]
    for document in ("task", "plan", "result"):
        Draft202012Validator.check_schema(json.loads(printed("schema", document)))
    assert printed("schema", "--reference") == (ROOT / "docs" / "taskfile.md").read_text()


def test_analytic_backend_runs_too(command: Command, tmp_path: Path) -> None:
    done = command("run", ROLL, "-o", tmp_path / "out", "--backend", "analytic", "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["backend"] == "analytic"


NASTY = {"hand": "2go-now?", "drum": "At Robot", "goal": "and"}


def test_names_that_hurt_pddl_come_back_as_written(command: Command, tmp_path: Path) -> None:
    text = ROLL.read_text()
    for old, new in NASTY.items():
        text = text.replace(f"  {old}:\n    classes", f'  "{new}":\n    classes')
    text = text.replace("robot: [hand]", 'robot: ["2go-now?"]').replace("[drum, goal]", '["At Robot", "and"]')
    text = text.replace("tokens:\n", 'tokens:\n  "at robot":\n    classes: [REGION]\n' + TWIN + "  ß:\n" + TWIN_CLASS)
    task = tmp_path / "ß task.yaml"
    task.write_text(text, encoding="utf-8")
    done = command("plan", task, "-o", tmp_path / "p", "--json")
    assert done.returncode == 0, done.stderr
    plan = valid(done.stdout, "plan-1")
    rolling = next(e for step in plan["steps"] for e in step["blocks"] if e["block"] == "ROLLING")
    assert rolling["slots"] == {"hand": "2go-now?", "object": "At Robot"}
    assert rolling["targets"] == {"region": "and"}
    assert val_accepts_files(tmp_path / "p")


TWIN = "    properties: {radius: 0.1}\n    pose: {position: [0, 0.7, 0]}\n"
TWIN_CLASS = "    classes: [REGION]\n" + TWIN


def test_a_domain_of_ones_own_is_named_on_the_command_line_only(command: Command, tmp_path: Path) -> None:
    mine = tmp_path / "mine.py"
    mine.write_text(
        "from dataclasses import replace\n"
        "from hybrid_tamp_domains.rolling_tumbling import DOMAIN as BASE\n"
        "DOMAIN = replace(BASE, name='mine')\n"
    )
    task = tmp_path / "task.yaml"
    task.write_text(ROLL.read_text().replace("domain: rolling_tumbling", f"domain: {mine}"))
    refused = command("plan", task)
    assert refused.returncode == 30
    assert "cannot refer to code" in refused.stderr
    done = command("plan", task, "--domain", mine, "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["domain"] == "mine"


IDLE = """
from dataclasses import replace
from hybrid_tamp.authoring import ReassignmentNetwork
from hybrid_tamp_domains.rolling_tumbling import DOMAIN as BASE

def idle(block):
    return "IDLE" if block == BASE.resting else block

edges = [[f"{idle(block)}.{slot}" for block, slot in edge] for edge in BASE.network.edges]
blocks = tuple(replace(block, name=idle(block.name)) for block in BASE.blocks)
DOMAIN = replace(BASE, name="mine", resting="IDLE", blocks=blocks, network=ReassignmentNetwork(edges))
"""


def test_what_rests_in_a_block_of_another_name_is_not_shown_as_busy(command: Command, tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text(IDLE)
    words = (ROLL, "--domain", tmp_path / "mine.py")
    done = command("plan", *words)
    assert done.returncode == 0, done.stderr
    assert "IDLE: drum" in done.stdout
    assert "IDLE-" not in done.stdout, "neither in the table nor on the timeline"
    folder = tmp_path / "out"
    assert command("run", *words, "-o", folder, "--backend", "analytic").returncode == 0
    page = (folder / "report.html").read_text()
    assert '<div class="pale">IDLE: drum' in page
    assert ">IDLE-" not in page, "no bar on the lanes"
    assert command("report", folder, "--domain", tmp_path / "mine.py").returncode == 0
    assert (folder / "report.html").read_text() == page


def test_nothing_is_lost_to_a_run_that_cannot_begin(ran: tuple[Path, object], tmp_path: Path) -> None:
    folder = tmp_path / "copy"
    shutil.copytree(ran[0], folder)
    before = sorted(path.name for path in folder.iterdir())
    for words in (
        ["--backend", "nope"],
        ["--planner", "nope"],
        ["--video", tmp_path / "x.gif"],
        ["--video", tmp_path / "none" / "x.mp4"],
        ["--gif", tmp_path / "x.mp4"],
        ["--gif", tmp_path / "none" / "x.gif"],
        ["--size", "1281x720"],
        ["--size", "large"],
    ):
        # In this process, because the start of another process takes most of the time.
        assert main(["run", str(ROLL), "-o", str(folder), "--force", *map(str, words)]) == 30
        assert sorted(path.name for path in folder.iterdir()) == before


def test_wrong_words_are_one_document_too(command: Command) -> None:
    done = command("plan", ROLL, "--json", "--bad")
    assert done.returncode == 30
    assert json.loads(done.stdout)["schema"] == "hybrid-tamp/error/1"


@pytest.mark.parametrize("words", [["check"], ["plan"]])
def test_a_planner_that_is_none_is_a_fault_of_the_file_with_its_place(
    command: Command, tmp_path: Path, words: list[str]
) -> None:
    wrong = tmp_path / "task.yaml"
    wrong.write_text(ROLL.read_text() + "planner: fast-dawnward\n")
    done = command(*words, wrong)
    assert done.returncode == 30
    assert f"{wrong}:{len(ROLL.read_text().splitlines()) + 1}:10: expected a planning engine" in done.stderr
    assert "did you mean 'fast-downward'?" in done.stderr
    if words == ["plan"]:
        assert command("plan", wrong, "--planner", "fast-downward").returncode == 0
