"""The page is made from documents, whatever they hold."""

from pathlib import Path

import pytest

from hybrid_tamp.errors import InputError
from hybrid_tamp.report.folder import RunFolder
from hybrid_tamp.report.page import lanes, write_page
from hybrid_tamp.report.plan_entries import (
    ExplanationEntry,
    InstanceEntry,
    NetworkEntry,
    PlanDocument,
    PlannerEntry,
    ReasonEntry,
    StepEntry,
)


def instance(block: str, number: int, **slots: str) -> InstanceEntry:
    return InstanceEntry(
        block=block, mode=None, instance=f"{block}-{number}", slots=slots, targets={}, hyperparameters={}
    )


def document(*steps: StepEntry, explanation: ExplanationEntry | None = None) -> PlanDocument:
    return PlanDocument(
        task="<script>alert(1)</script>",
        domain="d",
        status="unknown" if explanation else "solved",
        planner=PlannerEntry(name="p", seconds=0.1),
        seed=0,
        makespan=steps[-1].end if steps else None,
        cost=0.0,
        actions=[],
        steps=list(steps),
        network=NetworkEntry(blocks=[], edges=[]),
        explanation=explanation,
    )


STEPS = (
    StepEntry(
        index=1, start=0.0, end=1.0, blocks=[instance("PUSHING", 1, hand="h"), instance("RESTING", 1, token="b")]
    ),
    StepEntry(index=2, start=1.0, end=2.0, blocks=[instance("PUSHING", 1, hand="h"), instance("PUSHING", 2, hand="b")]),
    StepEntry(
        index=3, start=2.0, end=4.0, blocks=[instance("RESTING", 2, token="h"), instance("PUSHING", 2, hand="b")]
    ),
)


def test_a_lane_has_one_bar_an_instance_and_none_where_a_token_rests() -> None:
    found = {
        token: [(bar["name"], bar["left"], bar["width"]) for bar in bars]
        for token, bars in lanes(document(*STEPS)).items()
    }
    assert found == {"h": [("PUSHING-1", 0.0, 50.0)], "b": [("PUSHING-2", 25.0, 75.0)]}


def test_a_plan_has_a_page_before_it_is_run(tmp_path: Path) -> None:
    folder = RunFolder.create(tmp_path)
    folder.write_json("plan.json", document(*STEPS).dump())
    text = write_page(folder).read_text(encoding="utf-8")
    assert "<script" not in text
    assert "&lt;script&gt;alert(1)" in text
    assert "Exit conditions" not in text


def test_the_page_says_why_there_is_no_plan(tmp_path: Path) -> None:
    reason = ReasonEntry(goal="inside(a, b)", block="B", kind="k", message="a < b & c")
    explanation = ExplanationEntry(kind="not_found", message="None was found.", reasons=[reason])
    folder = RunFolder.create(tmp_path)
    folder.write_json("plan.json", document(explanation=explanation).dump())
    text = write_page(folder).read_text(encoding="utf-8")
    assert "inside(a, b): a &lt; b &amp; c" in text
    assert "which tokens" not in text


def test_a_document_that_is_none_is_a_fault_with_its_place(tmp_path: Path) -> None:
    folder = RunFolder.create(tmp_path)
    folder.write_text("plan.json", "{")
    with pytest.raises(InputError, match=r"plan\.json: .*published JSON Schema"):
        write_page(folder)
    folder.write_json("plan.json", document(*STEPS).dump() | {"makespan": "long"})
    with pytest.raises(InputError, match="at makespan"):
        write_page(folder)
