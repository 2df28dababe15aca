"""The commands `explain` and `affordances`."""

import json
import subprocess
from collections.abc import Callable
from importlib.resources import files
from typing import Any

import pytest
from jsonschema import Draft202012Validator

Command = Callable[..., "subprocess.CompletedProcess[str]"]


def valid(document: str, stem: str) -> dict[str, Any]:
    data: dict[str, Any] = json.loads(document)
    schema = json.loads(files("hybrid_tamp.report.schemas").joinpath(f"{stem}.json").read_text(encoding="utf-8"))
    Draft202012Validator(schema).validate(data)
    return data


def test_explain_says_what_is_missing_and_what_would_do(command: Command) -> None:
    done = command("explain", "roll_cylinder_off_axis", "--json", "--trials", "1", "--most", "1")
    assert done.returncode == 10, done.stderr
    answer = valid(done.stdout, "explain-1")
    assert answer["status"] == "unsolvable"
    (suggestion,) = answer["explanation"]["suggestions"]
    assert suggestion["solvable"] is True
    assert suggestion["names"][:2] == ["goal", "radius"]


def test_explain_says_why_each_token_is_in_the_plan(command: Command) -> None:
    done = command("explain", "roll_cylinder", "--json")
    assert done.returncode == 0, done.stderr
    answer = valid(done.stdout, "explain-1")
    assert answer["explanation"] is None
    assert {entry["token"]: entry["used"] for entry in answer["tokens"]} == {"hand": True, "drum": True, "goal": True}
    told = " ".join(command("explain", "roll_cylinder").stdout.replace("\u2502", " ").split())
    assert "slot hand of ROLLING-1, which achieves inside(drum, goal) for the goal" in told


@pytest.mark.parametrize("view", ["environment", "agent", "observer", "team"])
def test_every_view_is_a_valid_document(command: Command, view: str) -> None:
    done = command("affordances", "tumble_two_robots", "--view", view, "--json")
    assert done.returncode == 0, done.stderr
    answer = valid(done.stdout, "affordances-1")
    assert answer["view"] == view
    assert bool(answer["affordances"]) == (view in ("environment", "team"))


def test_what_if_there_were_one_more_hand(command: Command) -> None:
    words = ("affordances", "tumble_one_hand", "--view", "agent", "--what-if", "+STATIC END-EFFECTOR")
    (answer,) = valid(command(*words, "--json").stdout, "affordances-1")["what_if"]
    assert {entry["block"] for entry in answer["gained"]} >= {"TIPPING:opposite", "TIPPING:lower"}
    assert answer["lost"] == []
    assert "+STATIC END-EFFECTOR: affordances gained" in command(*words).stdout
    lost = ("affordances", "tumble_two_hands", "--view", "agent", "--what-if", "-hand-2", "--json")
    assert len(valid(command(*lost).stdout, "affordances-1")["what_if"][0]["lost"]) == 4


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (
            ("--view", "agent", "--agent", "C"),
            "--agent: must be an agent of the task tumble_two_robots; got 'C'; available: A, B",
        ),
        (("--view", "bird"), "'bird' is not one of 'environment', 'agent', 'observer', 'team'"),
        (("--what-if", "+STATIC END-EFECTOR"), "did you mean 'STATIC END-EFFECTOR'?"),
    ],
)
def test_wrong_questions(command: Command, words: tuple[str, ...], said: str) -> None:
    done = command("affordances", "tumble_two_robots", *words, "--json")
    assert done.returncode == 30
    assert said in done.stderr
    assert json.loads(done.stdout)["schema"] == "hybrid-tamp/error/1"
