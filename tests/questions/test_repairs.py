"""Suggested single changes equal those of a brute-force search, and the reasons match the changes."""

from collections.abc import Callable
from dataclasses import replace

import pytest
from bank import by_hand, problem, without_edge
from brute_force import all_single_repairs, solvable
from clocks import hurried
from explanation_judge import faults
from scenes import rolling_task
from workshop import at, cut, workshop_task

import hybrid_tamp
from hybrid_tamp.errors import LimitReached
from hybrid_tamp.model.deadline import Deadline
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.task import Task
from hybrid_tamp.questions.changes import apply_change, with_edges
from hybrid_tamp.questions.explain.candidates import propose_changes
from hybrid_tamp.questions.explain.no_plan import explain, explain_outcome, explain_wholly
from hybrid_tamp.questions.explain.property_changes import find_property_changes
from hybrid_tamp.questions.explain.trial_plans import TrialPlanner
from hybrid_tamp.symbolic.strategies.search import SearchResult

CARRIED = ("CARRYING", "part")
SOME = (
    "workshop: one hand carries",
    "workshop: no cutter",
    "workshop: no way to CARRYING",
)


@pytest.mark.parametrize("name", SOME)
def test_explanations_are_what_brute_force_finds(name: str) -> None:
    task = by_hand()[name]()
    every = all_single_repairs(task)
    assert every
    assert not list(faults(task, explain_wholly(task, 60, most=2), every))


def test_where_two_things_are_wrong_no_single_change_is_suggested() -> None:
    task = workshop_task((at(),), hands=(50.0,), loads=(20.0,))
    found = explain_wholly(task, 60, most=1)
    assert (found.suggestions, found.complete) == ((), True)
    assert {reason.kind for reason in found.reasons} == {"too_few_tokens"}


@pytest.mark.parametrize("trials", [1, 2, 60])
def test_a_count_of_planned_tasks_limits_the_search(trials: int) -> None:
    task = without_edge(workshop_task((at(),), edges=()), ("CARRYING.first", "RESTING.token"))
    asked: list[Task] = []
    plan = TrialPlanner._plan

    def count(self: TrialPlanner, each: Task) -> SearchResult:
        asked.append(each)
        return plan(self, each)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(TrialPlanner, "_plan", count)
        found = explain_wholly(task, trials, most=9)
    assert len(asked) <= trials
    assert found.complete == (trials == 60)
    assert found.stopped is None


def test_no_clock_decides_which_changes_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    task = without_edge(workshop_task((cut(),)), ("RESTING.token", "SETTING.tool"))
    idle = explain_wholly(task, 3, most=3)
    hurried(monkeypatch, jump=3600.0)
    assert explain_wholly(task, 3, most=3) == idle


def test_what_is_known_when_the_time_is_over_is_told() -> None:
    task = without_edge(workshop_task((cut(),)), ("RESTING.token", "SETTING.tool"))
    outcome = hybrid_tamp.plan(task)
    late = explain_outcome(replace(outcome, explanation=None), 6, 1, Deadline.after(0.0))
    assert late.status == "limit"
    assert late.explanation is not None
    assert late.explanation.reasons
    with pytest.raises(
        LimitReached, match=r"time limit of 0 s.* ended the search .*planner has proven that no plan exists"
    ):
        late.required()


def test_what_only_a_change_shows_is_a_reason_too() -> None:
    task = without_edge(workshop_task((at(),), edges=()), ("CARRYING.first", "RESTING.token"))
    assert [reason.kind for reason in explain(task, proven=True)] == ["together"]
    found = explain_wholly(task, 60, most=1)
    assert "together" not in {reason.kind for reason in found.reasons}
    assert [(each.change.kind, *each.change.names) for each in found.suggestions] == [("token", "CUTTER")]
    (reason,) = found.reasons
    assert (reason.kind, reason.lacks) == ("no_token", task.domain.class_by_name["CUTTER"])


def test_reasons_are_a_smallest_set() -> None:
    """No edge leads to CUTTING either, but this edge alone, without an edge to SETTING, gives no plan."""
    task = without_edge(workshop_task((cut(),)), ("RESTING.token", "SETTING.tool"))
    assert {reason.lacks for reason in explain(task, proven=True)} == {("CUTTING", "tool")}
    found = explain_wholly(task, 60, most=3)
    assert [each.change.names for each in found.suggestions] == [("RESTING.token", "SETTING.tool")]
    assert [reason.lacks for reason in found.reasons] == [("SETTING", "tool")]


def test_what_only_several_changes_mend_is_mended_by_all_of_them_and_by_no_fewer() -> None:
    """Part 0 is too heavy for the station, part 1 too hard for the cutter."""
    task = workshop_task((at(0), cut(1)), parts=((60.0, 3.0), (90.0, 4.0)), loads=(50.0,), edges=(2.0,))
    found = explain_wholly(task, 60, most=3)
    assert (found.suggestions, found.complete) == ((), True)
    assert [reason.atom.predicate for reason in found.reasons if reason.atom] == ["sound", "sharp"]
    changes = tuple(change.what for change in found.together)
    assert changes == (
        "load of station 0 set to 60 N instead of 50 N",
        "edge of cutter 0 set to 4 instead of 2",
    )


def test_where_only_deletes_exclude_a_plan_changes_are_planned_many_together(monkeypatch: pytest.MonkeyPatch) -> None:
    task = without_edge(workshop_task((at(),), edges=()), ("CARRYING.first", "RESTING.token"))
    tried: list[Task] = []
    plan = TrialPlanner._plan
    monkeypatch.setattr(TrialPlanner, "_plan", lambda self, each: (tried.append(each), plan(self, each))[1])
    found = explain_wholly(task, 60, most=9)
    assert found.complete
    assert {each.change.kind for each in found.suggestions} == {"token", "edge"}
    alone = [each for each in tried if len(each.domain.network.edges) <= len(task.domain.network.edges) + 1]
    together = [each for each in tried if each not in alone]
    assert together


def test_no_edge_leads_there_and_the_reason_says_from_where() -> None:
    task = workshop_task((at(),))
    into = ("RESTING.token", "CUTTING.part")
    away = without_edge(with_edges(task, [(CARRIED, CARRIED)]), *((source, "CARRYING.part") for source in into))
    (reason,) = explain(away)
    assert (reason.kind, reason.block, reason.lacks) == ("no_edge", "CARRYING", ("CARRYING", "part"))
    assert "the only slots within reach are CUTTING.part, RESTING.token" in reason.message


@pytest.mark.parametrize(
    ("task", "atom", "wanted"),
    [
        (
            lambda: workshop_task((at(),), hands=(50.0, 20.0)),
            Atom("bears", ("hand 1", "part 0")),
            "force of hand 1 set to 30 N",
        ),
        (
            lambda: workshop_task((cut(),), edges=(2.0,)),
            Atom("sharp", ("cutter 0", "part 0")),
            "edge of cutter 0 set to 3",
        ),
        (
            lambda: rolling_task(regions=[(3.0, 0.0)]),
            Atom("within_workspace", ("hand 0", "drum 0", "region 0")),
            "workspace_upper, x of hand 0",
        ),
    ],
)
def test_the_least_property_that_makes_a_fact_hold(task: Callable[[], Task], atom: Atom, wanted: str) -> None:
    changes = {change.what: change for change in find_property_changes(task(), atom)}
    (found,) = [change for what, change in changes.items() if what.startswith(wanted)]
    assert task().margin(atom) < 0 <= apply_change(task(), found).margin(atom)
    assert apply_change(task(), found).margin(atom) < 0.05
    assert solvable(apply_change(task(), found))


def test_every_candidate_is_one_change_and_comes_once() -> None:
    task = workshop_task((at(),), hands=(50.0,))
    found = [(change.kind, change.names) for change in propose_changes(task, explain(task))]
    assert len(set(found)) == len(found)
    assert found[0] == ("token", ("hand 0",))
    assert {kind for kind, _ in found} == {"token", "edge"}


def test_a_plan_document_suggests_what_to_change() -> None:
    explanation = hybrid_tamp.plan(problem("tumble_one_hand"), trials=60).explanation
    assert explanation is not None
    (suggestion,) = explanation.suggestions
    assert (suggestion.change.kind, suggestion.change.names) == ("token", ("hand-1",))
    assert "one more token like hand-1" in suggestion.change.what
    assert suggestion.length > 10
