"""`explain` reports everything that `plan` reports: reasons, suggestions, probes, exclusions and refusals."""

from pathlib import Path
from typing import Any

import pytest
from bank import by_hand
from questions.test_unreachable import tool_task

import hybrid_tamp
from hybrid_tamp.model.explanation import Explanation, Reason, TaskExplanation
from hybrid_tamp.model.outcome import PlanOutcome
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.planning.plan import Reduction

ROOT = Path(__file__).resolve().parents[2]


def compare(source: Any, **more: Any) -> tuple[Explanation, TaskExplanation]:
    """Return the explanations of `explain` and `plan`, after checking that the first contains the second."""
    optimise = more.pop("optimise", False)
    planned = hybrid_tamp.plan(source, optimise=optimise)
    told = hybrid_tamp.explain(source, optimise=optimise, **more)
    assert isinstance(planned, PlanOutcome)
    assert planned.explanation is not None
    assert told.explanation is not None
    assert told.status == planned.status
    assert (told.explanation.kind, told.explanation.message) == (planned.explanation.kind, planned.explanation.message)
    assert set(told.explanation.reasons) >= set(planned.explanation.reasons)
    whats = [each.change.what for each in told.explanation.suggestions]
    assert set(whats) >= {each.change.what for each in planned.explanation.suggestions}
    assert len(whats) == len(set(whats))
    assert told.excluded == tuple(each.text for each in planned.excluded)
    return planned.explanation, told


@pytest.mark.parametrize("name", ["workshop: blunt cutters", "workshop: one hand, two goals"])
def test_reasons_and_suggestions(name: str) -> None:
    planned, told = compare(by_hand()[name](), trials=12, most=3)
    assert planned.suggestions
    assert told.explanation is not None
    assert len(told.explanation.suggestions) >= len(planned.suggestions)


def test_an_atom_of_the_initial_state() -> None:
    planned, _ = compare(tool_task(-0.5), trials=7)
    assert [reason.kind for reason in planned.reasons] == ["unreachable"]


def test_a_token_to_probe() -> None:
    planned, _ = compare(ROOT / "problems" / "tumble_unknown_box.yaml")
    assert all(reason.probe is not None and reason.kind == "class_unknown" for reason in planned.reasons)


def test_bindings_that_the_forward_models_exclude(toys: Any) -> None:
    def still(binding: Any, start: Any, parameters: Any) -> Any:
        return lambda elapsed, state: {("pusher", "force"): -40.0 * state["pusher", "velocity"]}

    planned, told = compare(toys.one_move_task(policy=still, hyperparameters=()), optimise=True)
    assert planned.kind == "not_refined"
    assert len(told.excluded) == 1
    assert "MOVING with pusher=pusher, spot=spot: near(pusher, spot) fails by at least 0.39 m" in told.excluded[0]


def test_a_plan_that_the_law_refuses(monkeypatch: pytest.MonkeyPatch, toys: Any) -> None:
    def restore(self: Reduction, plan: TaskPlan) -> TaskPlan:
        return TaskPlan(plan.instances[:-1], plan.makespan)

    world = toys.world.pusher().spot().thing("post", toys.box(0.05, 0.1, 0.4), {"mass": 20.0}, position=(5, 0, 0.4))
    monkeypatch.setattr(Reduction, "restore", restore)
    planned, _ = compare(world.task(*toys.one_move_task().goal))
    assert planned.kind == "plan_refused"
    assert "law " in planned.message


def test_two_explanations_are_merged_without_duplicates() -> None:
    one, other = (Reason((), "", "no_block", text) for text in ("one", "other"))
    both = Explanation("unsolvable", "m", (one,)).extended(Explanation("unsolvable", "m", (other, one)))
    assert both.reasons == (one, other)
