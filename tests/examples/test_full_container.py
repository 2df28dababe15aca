"""A body may fall onto whatever already lies in its container."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from contracts.scripts import load_script

import hybrid_tamp
from hybrid_tamp.errors import DomainError
from hybrid_tamp.model.contacts import ContactRules
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.predicate import ANY, Literal
from hybrid_tamp.model.task import Task
from hybrid_tamp.testing import check_domain

SLOTS = {"hand": "hand", "object": "walnut"}
EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "sweeping" / "task.yaml"


@pytest.fixture(scope="module")
def stacked(tmp_path_factory: pytest.TempPathFactory) -> Task:
    """Return a task in which a heavy walnut falls onto the hazelnut, which already lies in the tray."""
    text = EXAMPLE.read_text("utf-8")
    text = text.replace("mass: 0.1", "mass: 1.0").replace("[0.2, -0.12, 0.32]", "[0.5, 0.1, 0.04]")
    folder = tmp_path_factory.mktemp("sweeping")
    (folder / "task.yaml").write_text(text, "utf-8")
    (folder / "domain.py").write_text((EXAMPLE.parent / "domain.py").read_text("utf-8"), "utf-8")
    return hybrid_tamp.load_task(folder / "task.yaml")


@pytest.fixture(scope="module")
def folder(stacked: Task, tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("run")
    hybrid_tamp.run(stacked, made)
    return made


def test_a_body_falls_onto_another_body_in_the_tray(folder: Path) -> None:
    recording = hybrid_tamp.load_recording(folder / "recording.npz")
    assert recording.failure is None
    hits = [each for each in recording.contacts if set(each.tokens) == {"walnut", "hazelnut"} and each.allowed]
    assert max(each.force for each in hits) > 20.0


def test_the_judge_agrees_and_tells_the_tray_from_its_surroundings(folder: Path) -> None:
    judge = load_script("judge")
    assert not list(judge.find_contacts(judge.Run(folder)))
    run = judge.Run(folder)
    run.states[:, run.columns["hazelnut", "position"]] += [0.5, 0.0, 0.0]
    assert any("walnut" in fault for fault in judge.find_contacts(run))


def test_the_check_of_the_domain_agrees(stacked: Task) -> None:
    assert not [each for each in check_domain(stacked, samples=1) if each.kind == "contact"]


def test_a_body_outside_the_tray_may_not_be_touched(stacked: Task) -> None:
    instances = [
        BlockInstance("SWEEPING-1", "SWEEPING", SLOTS, 0.0, 1.0, {"table": "table", "tray": "tray"}),
        BlockInstance("RESTING-1", "RESTING", {"token": "hazelnut"}, 0.0, 1.0),
    ]
    rules = ContactRules(stacked.domain.block_by_name, instances, stacked.fixed_bodies, stacked.token_by_name)
    beside = stacked.state.replace({("hazelnut", "position"): np.array([0.2, -0.12, 0.32])})
    assert rules.allow("hazelnut", "walnut", stacked.state)
    assert rules.allow("walnut", "hazelnut", stacked.state)
    assert not rules.allow("walnut", "hazelnut", beside)
    assert not rules.allow("hand", "hazelnut", stacked.state)


def test_a_condition_needs_one_wildcard_for_a_token(stacked: Task) -> None:
    block = stacked.domain.block_by_name["SWEEPING"]
    ((_, condition),) = [pair for pair in block.allowed_contacts if not isinstance(pair[1], str)]
    assert isinstance(condition, Literal)
    assert condition.arguments == (ANY, "tray")
    for wrong in (condition.predicate("object", "tray"), condition.predicate(ANY, ANY), ~condition):
        contacts = (("hand", "object"), ("object", wrong))
        blocks = [replace(each, allowed_contacts=contacts) if each is block else each for each in stacked.domain.blocks]
        with pytest.raises(DomainError, match=r"SWEEPING\.allowed_contacts: .*one wildcard"):
            replace(stacked.domain, blocks=tuple(blocks))
