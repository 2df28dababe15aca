"""Tests of replanning: if no hyperparameters satisfy a plan, the task is planned again."""

from dataclasses import replace

import pytest

import hybrid_tamp
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.task import Task
from hybrid_tamp.report.documents import document


def load(name: str, **settings: object) -> Task:
    task = hybrid_tamp.load_task(f"problems/{name}.yaml")
    return task.replaced(midlevel=replace(task.midlevel, evaluations=60), **settings)


def test_what_cannot_be_carried_out_is_planned_anew() -> None:
    outcome = hybrid_tamp.plan(load("roll_second_round"), optimise=True)
    (exclusion,) = outcome.excluded
    assert (exclusion.instance.block, exclusion.instance.roles["region"]) == ("ROLLING", "near")
    assert exclusion.shortfall.atom.text == "inside(drum, near)"
    assert exclusion.shortfall.margin == pytest.approx(-0.001, abs=1e-4)
    plan = outcome.required()
    assert [i.targets["region"] for i in plan.instances if i.block == "ROLLING"] == ["far"]
    refinement = document(outcome)["refinement"]
    assert [each["atom"] for each in refinement["rounds"]] == ["inside(drum, near)"]


def test_with_none_left_block_atom_and_margin_are_told() -> None:
    outcome = hybrid_tamp.plan(load("roll_past_region"), optimise=True)
    assert outcome.plan is None
    assert outcome.error is not None
    assert outcome.error.exit_status == 11
    assert "hand=hand, object=drum, region=near: inside(drum, near) fails by at least 0.001 m" in str(outcome.error)
    assert outcome.status == "unknown"
    assert outcome.explanation is not None
    (reason,) = outcome.explanation.reasons
    assert (reason.block, reason.atom) == ("ROLLING", Atom("inside", ("drum", "near")))
    assert reason.margin == pytest.approx(-0.001, abs=1e-4)


def test_the_limit_of_refinements_is_kept() -> None:
    task = load("roll_second_round")
    outcome = hybrid_tamp.plan(task.replaced(limits=replace(task.limits, refinements=0)), optimise=True)
    assert outcome.plan is None
    assert "limit of 0 refinements is reached" in str(outcome.error)
