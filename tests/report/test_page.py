"""The page of a run can be made from all documents, with any content."""

from pathlib import Path

import pytest
from scenes import rolling_task

from hybrid_tamp.errors import InputError
from hybrid_tamp.model.closest_pair import ClosestPair
from hybrid_tamp.model.explanation import Explanation, Reason
from hybrid_tamp.model.outcome import PlannerFigures, PlanningFailure, PlanOutcome
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.planned_network import PlannedNetwork
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.report.documents import Json, document
from hybrid_tamp.report.folder import RunFolder
from hybrid_tamp.report.page import lanes, write_page
from hybrid_tamp.report.tables import clearance_text


def instance(block: str, number: int, start: float, end: float, **slots: str) -> BlockInstance:
    return BlockInstance(f"{block}-{number}", block, slots, start, end)


PAIRS = (
    ClosestPair("PUSHING-1", "h", "shelf", 0.0704, 1.0, ((0.0, 0.0, 0.0), (0.0704, 0.0, 0.0))),
    ClosestPair("PUSHING-2", "b", "<wall>", 0.0204, 0.5, ((0.0, 0.0, 0.0), (0.0204, 0.0, 0.0))),
)


def plan_document(
    *instances: BlockInstance, explanation: Explanation | None = None, pairs: tuple[ClosestPair, ...] = ()
) -> Json:
    task = rolling_task().replaced(name="<script>alert(1)</script>")
    outcome = PlanOutcome(
        task,
        PlannerFigures("p", 0.1),
        PlannedNetwork.of(task, task),
        plan=TaskPlan(instances, max(each.end for each in instances)) if instances else None,
        failure=None if instances else PlanningFailure("not_found"),
        explanation=explanation,
        closest_pairs=pairs,
    )
    return document(outcome)


def instances(resting: str = "RESTING") -> list[BlockInstance]:
    return [
        instance("PUSHING", 1, 0.0, 2.0, hand="h"),
        instance(resting, 1, 0.0, 1.0, token="b"),
        instance("PUSHING", 2, 1.0, 4.0, hand="b"),
        instance(resting, 2, 2.0, 4.0, token="h"),
    ]


@pytest.mark.parametrize("resting", ["RESTING", "IDLE"])
def test_a_lane_has_one_bar_an_instance_and_none_where_a_token_rests(resting: str) -> None:
    found = {
        token: [(bar["name"], bar["left"], bar["width"]) for bar in bars]
        for token, bars in lanes(plan_document(*instances(resting)), resting).items()
    }
    assert found == {"h": [("PUSHING-1", 0.0, 50.0)], "b": [("PUSHING-2", 25.0, 75.0)]}


def test_a_plan_has_a_page_before_it_is_run(tmp_path: Path) -> None:
    folder = RunFolder.create(tmp_path)
    folder.write_json("plan.json", plan_document(*instances()))
    text = write_page(folder, "RESTING").read_text(encoding="utf-8")
    assert "<script" not in text
    assert "&lt;script&gt;alert(1)" in text
    assert "Exit conditions" not in text


def test_the_page_says_why_there_is_no_plan(tmp_path: Path) -> None:
    reason = Reason((Atom("inside", ("a", "b")),), "B", "no_token", "a < b & c")
    explanation = Explanation("not_found", "None was found.", (reason,))
    folder = RunFolder.create(tmp_path)
    folder.write_json("plan.json", plan_document(explanation=explanation))
    text = write_page(folder, "RESTING").read_text(encoding="utf-8")
    assert "inside(a, b): a &lt; b &amp; c" in text
    assert "which tokens" not in text


def test_a_document_that_is_none_is_a_fault_with_its_place(tmp_path: Path) -> None:
    folder = RunFolder.create(tmp_path)
    folder.write_text("plan.json", "{")
    with pytest.raises(InputError, match=r"plan\.json: .*published JSON Schema"):
        write_page(folder, "RESTING")
    folder.write_json("plan.json", plan_document(*instances()) | {"makespan": "long"})
    with pytest.raises(InputError, match="at makespan"):
        write_page(folder, "RESTING")


def test_the_page_shows_the_movements_and_their_closest_pairs(tmp_path: Path) -> None:
    folder = RunFolder.create(tmp_path)
    folder.write_json("plan.json", plan_document(*instances()))
    assert "<h2>Movements</h2>" not in write_page(folder, "RESTING").read_text(encoding="utf-8")
    folder.write_json("plan.json", plan_document(*instances(), pairs=PAIRS))
    folder.write_bytes("movements.png", b"")
    text = write_page(folder, "RESTING").read_text(encoding="utf-8")
    assert '<img src="movements.png"' in text
    assert '<td>PUSHING-2</td><td>b</td><td>&lt;wall&gt;</td><td class="n">20</td></tr>' in text


def test_one_line_states_the_closest_approach_of_a_plan_and_of_a_run() -> None:
    planned = plan_document(*instances(), pairs=PAIRS)["clearance"]
    assert clearance_text([]) == ""
    assert clearance_text(planned) == "closest approach: b and <wall> in PUSHING-2, 20 mm"
    measured = [{**each, "measured": 0.0226} for each in planned]
    assert clearance_text(measured) == "closest approach: b and <wall> in PUSHING-2, 20 mm, 23 mm in the run"
