"""Task planner and mid-level planner in turns: what no hyperparameters can carry out is planned anew."""

from dataclasses import replace

import pytest

import hybrid_tamp
from hybrid_tamp.model.task import Task
from hybrid_tamp.verbs import pipeline


def load(name: str, **settings: object) -> Task:
    task = hybrid_tamp.load_task(f"problems/{name}.yaml")
    return task.replaced(midlevel=replace(task.midlevel, evaluations=60), **settings)


def test_what_cannot_be_carried_out_is_planned_anew() -> None:
    rounds = pipeline.refine(load("roll_second_round"))
    (given_up,) = rounds.given_up
    assert (given_up.instance.block, given_up.instance.roles["region"]) == ("ROLLING", "near")
    assert given_up.shortfall.atom.text == "inside(drum, near)"
    assert given_up.shortfall.margin == pytest.approx(-0.001, abs=1e-4)
    plan = rounds.outcome.required()
    assert [i.targets["region"] for i in plan.instances if i.block == "ROLLING"] == ["far"]
    entry = rounds.outcome.document.refinement
    assert entry is not None
    assert [each.atom for each in entry.rounds] == ["inside(drum, near)"]


def test_with_none_left_block_atom_and_margin_are_told() -> None:
    rounds = pipeline.refine(load("roll_past_region"))
    outcome = rounds.outcome
    assert outcome.plan is None
    assert outcome.error is not None
    assert outcome.error.exit_status == 11
    assert "ROLLING with hand=hand, object=drum, region=near: inside(drum, near) fails by 0.001 m" in str(outcome.error)
    assert outcome.document.status == "unknown"
    assert outcome.document.explanation is not None
    (reason,) = outcome.document.explanation.reasons
    assert (reason.block, reason.atom) == ("ROLLING", "inside(drum, near)")
    assert reason.margin == pytest.approx(-0.001, abs=1e-4)


def test_the_limit_of_refinements_is_kept() -> None:
    task = load("roll_second_round")
    rounds = pipeline.refine(task.replaced(limits=replace(task.limits, refinements=0)))
    assert rounds.outcome.plan is None
    assert "the limit of 0 refinements is reached" in str(rounds.outcome.error)
