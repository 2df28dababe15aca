"""Hands that start outside their workspaces, and steps that would leave a workspace: the distance is stated."""

from pathlib import Path

import pytest
from texts import load_task_text

import hybrid_tamp
from hybrid_tamp.errors import InputError

PROBLEMS = Path(__file__).parents[2] / "problems"


def text_of(name: str, *changes: tuple[str, str]) -> str:
    text = (PROBLEMS / f"{name}.yaml").read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    return text


@pytest.mark.parametrize(
    ("name", "old", "new", "outside"),
    [
        ("roll_cylinder", "position: [0.25, -0.45, 0.30]", "position: [0.25, -1.05, 0.30]", 0.25),
        ("tumble_two_hands", "position: [-0.5, 0, 0.55]", "position: [-2.5, 0, 0.55]", 0.5),
        ("hammer_push", "position: [-0.30, -0.30, 0.30]", "position: [-0.30, -0.30, 1.4]", 0.2),
    ],
)
def test_a_hand_starts_outside(name: str, old: str, new: str, outside: float) -> None:
    with pytest.raises(InputError, match=f"within its workspace, but it is {outside:g} m outside"):
        load_task_text(text_of(name, (old, new)), name)


BLOCK = "position: [0.1, 0, 0.06]"
REGION = "pose: {position: [0.5, 0, 0]}"


@pytest.mark.parametrize(
    ("name", "changes", "denial", "outside"),
    [
        ("roll_cylinder", [("position: [0.7, 0, 0]", "position: [1.8, 0, 0]")], "cannot push drum to goal", 0.265),
        ("hammer_push", [(REGION, "pose: {position: [2.0, 0, 0]}")], "cannot push block to goal with hammer", 0.435),
        ("hammer_push", [(BLOCK, "position: [-0.97, 0, 0.06]")], "cannot push block to goal with hammer", 0.065),
        ("hammer_strike", [("position: [0.5, 0, 0.06]", "position: [4.0, 0, 0.06]")], "cannot strike block", 2.325),
        ("hammer_strike", [("position: [0.5, 0, 0.06]", "position: [0.5, 1.2, 0.06]")], "cannot strike block", 0.225),
        # The second step, after a push within the workspace:
        (
            "hammer_push_then_strike",
            [(REGION, "pose: {position: [1.9, 0, 0]}"), ("1.5, 0.8, 1.2]", "1.6, 0.8, 1.2]")],
            "cannot push block to goal",
            0.235,
        ),
    ],
)
def test_a_step_would_leave_the_workspace(
    name: str, changes: list[tuple[str, str]], denial: str, outside: float
) -> None:
    outcome = hybrid_tamp.plan(load_task_text(text_of(name, *changes), name))
    assert outcome.plan is None
    said = str(outcome.error)
    assert denial in said
    assert f"(off by {outside:g} m" in said
