"""Tests of documents that are derived from results: renamed keys, values as text, and published schemas."""

import json
from importlib.resources import files
from math import inf, nan

import pytest
from jsonschema import Draft202012Validator
from pydantic import ValidationError
from scenes import rolling_task

from hybrid_tamp.model.explanation import Explanation, Reason
from hybrid_tamp.model.outcome import PlannedNetwork, PlannerFigures, PlanningFailure, PlanOutcome
from hybrid_tamp.model.plan import BlockInstance, PlannedAction, TaskPlan
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.refined import Milestone, RefinedPlan, Value
from hybrid_tamp.report.documents import Json, document, json_schemas, parse_document

TASK = rolling_task()
NETWORK = PlannedNetwork.of(TASK, TASK)
INSTANCE = BlockInstance("TIPPING:lower-1", "TIPPING:lower", {"object": "drum 0"}, 0.0, 2.0)
PLAN = TaskPlan((INSTANCE,), 2.0, (PlannedAction("begin-tipping", ("drum-0", "hand-0")),))
REFINED = RefinedPlan(
    plan=PLAN,
    hyperparameters=(),
    performance=(),
    best=Value(0.0, 1.0),
    defaults=Value(inf, nan),
    apart=None,
    shortfall=None,
    expected={},
    optimiser="cma",
    evaluations=1,
    seconds=0.1,
    stopped="converged",
    history=(Milestone(1, 0.0, nan),),
)
SOLVED = PlanOutcome(TASK, PlannerFigures("p", 0.5), NETWORK, plan=PLAN, refinement=REFINED)
FAILED = PlanOutcome(
    TASK,
    PlannerFigures("p", 0.5),
    NETWORK,
    failure=PlanningFailure("unsolvable"),
    explanation=Explanation(
        "unsolvable", "None.", (Reason(TASK.goal, "B", "not_feasible", "m", Atom("at", ("a", "b"), positive=False)),)
    ),
)


def valid(outcome: PlanOutcome) -> Json:
    """Return the document of an outcome, read again from JSON, after a check against the published schema."""
    text = json.dumps(document(outcome), allow_nan=False)
    schema = files("hybrid_tamp.report.schemas").joinpath("plan-1.json").read_text(encoding="utf-8")
    Draft202012Validator(json.loads(schema)).validate(json.loads(text))
    assert parse_document("plan-1", text.encode()) == json.loads(text)
    return parse_document("plan-1", text.encode())


def test_keys_are_renamed_and_values_become_text() -> None:
    found = valid(SOLVED)
    assert found["schema"] == "hybrid-tamp/plan/1"
    assert (found["task"], found["domain"], found["status"]) == (TASK.name, TASK.domain.name, "solved")
    assert (found["actions"], found["cost"]) == (["(begin-tipping drum-0 hand-0)"], 1.0)
    ((entry,),) = (step["blocks"] for step in found["steps"])
    assert (entry["block"], entry["mode"], entry["instance"]) == ("TIPPING", "lower", "TIPPING:lower-1")
    assert all(len(edge) == 2 and "." in edge[0] for edge in found["network"]["edges"])


def test_numbers_that_are_not_finite_are_null() -> None:
    found = valid(SOLVED)["refinement"]
    assert found["defaults"] == {"violation": None, "value": None}
    assert found["history"] == [{"evaluations": 1, "violation": 0.0, "value": None}]


def test_an_explanation_has_its_atoms_as_text() -> None:
    found = valid(FAILED)
    assert (found["status"], found["makespan"], found["steps"], found["refinement"]) == ("unsolvable", None, [], None)
    (reason,) = found["explanation"]["reasons"]
    assert (reason["atom"], reason["lacks"], reason["goal"]) == ("not at(a, b)", "", TASK.goal[0].text)


def test_keys_that_may_be_left_out_have_their_defaults_and_others_are_refused() -> None:
    found = document(FAILED)
    del found["refinement"], found["planner"]["stages"], found["schema"]
    read = parse_document("plan-1", json.dumps(found).encode())
    assert (read["refinement"], read["planner"]["stages"], read["schema"]) == (None, {}, "hybrid-tamp/plan/1")
    with pytest.raises(ValidationError, match="another"):
        parse_document("plan-1", json.dumps({**found, "another": 1}).encode())
    del found["actions"]
    with pytest.raises(ValidationError, match="actions"):
        parse_document("plan-1", json.dumps(found).encode())


@pytest.mark.parametrize("stem", sorted(json_schemas()))
def test_every_schema_is_sound_and_describes_its_keys(stem: str) -> None:
    schema = json_schemas()[stem]
    Draft202012Validator.check_schema(schema)
    assert schema["properties"]["schema"]["const"] == f"hybrid-tamp/{stem.replace('-', '/')}"
    assert schema["additionalProperties"] is False
