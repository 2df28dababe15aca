"""Tables, the curve and the progress bar of an optimisation, from data made by hand."""

from dataclasses import replace
from io import BytesIO, StringIO

import numpy as np
import pytest
from PIL import Image
from rich.console import Console
from scenes import rolling_task

from hybrid_tamp.model.outcome import Exclusion, PlannerFigures, PlanOutcome
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.planned_network import PlannedNetwork
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.refined import Milestone, Performance, RefinedPlan, Shortfall, Tuned, Value
from hybrid_tamp.report.convergence import convergence_picture
from hybrid_tamp.report.documents import Json, document
from hybrid_tamp.report.progress import progress_bar
from hybrid_tamp.report.refinement_tables import KEPT, refinement_tables

GRASP = Tuned(
    "GRASPING-1", "grasp_location", "m", -0.1234, 0.3, 0.1, 0.123456, "optimised", (("GRASPING-1", "contact"),), 0.1
)
HISTORY = (Milestone(48, 0.5, float("nan")), Milestone(96, 0.0, 1.0), Milestone(144, 0.0, 2.0))


MISSED = Value(0.75, 3.0)


def entry(defaults: Value = MISSED, optimiser: str = "cma", objective: str = "performance") -> Json:
    task = rolling_task()
    task = task.replaced(midlevel=replace(task.midlevel, objective=objective))
    tuned = GRASP if optimiser else Tuned(*"ab", "m", 0.0, 1.0, 0.5, 0.5, "kept")
    refined = RefinedPlan(
        plan=TaskPlan((), 0.0),
        hyperparameters=(tuned,),
        performance=(Performance("GRASPING-1", "contact", "1", 1.0, 1.0, 0.75),),
        best=Value(0.0, 2.0),
        defaults=defaults,
        apart=Value(0.0, 1.5),
        shortfall=None,
        expected={},
        optimiser=optimiser,
        evaluations=144,
        seconds=0.25,
        stopped="evaluations",
        history=HISTORY if optimiser else (),
    )
    failing = BlockInstance("ROLLING-1", "ROLLING", {"hand": "h"}, 0.0, 1.0)
    excluded = Exclusion(failing, Shortfall("ROLLING-1", Atom("inside", ("d", "g")), "m", -0.001))
    outcome = PlanOutcome(
        task,
        PlannerFigures("p", 0.1),
        PlannedNetwork.of(task, task),
        plan=refined.plan,
        refinement=refined,
        excluded=(excluded,),
    )
    found: Json = document(outcome)["refinement"]
    return found


def shown(of: Json) -> list[str]:
    console = Console(file=StringIO(), width=80)
    console.print(refinement_tables(of))
    assert isinstance(console.file, StringIO)
    return [line.rstrip() for line in console.file.getvalue().splitlines()]


def test_the_tables_say_all_in_80_columns() -> None:
    lines = shown(entry())
    assert "given up: ROLLING with hand=h, because inside(d, g) fails by 0.001 m" in lines
    (row,) = (line.split() for line in lines if "grasp_location" in line)
    assert row == ["grasp_location", "[m]", "0.1235", "0.1", "0.1", "-0.123", "to", "0.3", "optimised", "1"]
    assert any(line.split() == ["each", "action", "on", "its", "own", "1.5", "+0.5"] for line in lines)
    assert any(line.split() == ["the", "defaults", "violates", "conditions", "by", "0.75", "scales"] for line in lines)


@pytest.mark.parametrize(("objective", "word"), [("performance", "weighted sum"), ("distance", "minus the distance")])
def test_the_tables_say_what_the_value_of_a_plan_is(objective: str, word: str) -> None:
    (line,) = (line for line in shown(entry(objective=objective)) if line.startswith("value: "))
    assert word in line


def test_what_is_kept_is_one_line() -> None:
    lines = shown(entry(optimiser=""))
    assert lines.count(KEPT) == 1
    assert not any("bounds" in line for line in lines)
    assert convergence_picture(entry(optimiser="")) is None


def test_values_that_are_not_finite_are_null() -> None:
    found = entry(defaults=Value(float("inf"), float("nan")))
    assert found["defaults"] == {"violation": None, "value": None}
    assert any(line.split() == ["the", "defaults", "not", "finite"] for line in shown(found))
    assert convergence_picture(found) is not None


def colours(picture: bytes | None) -> set[tuple[int, ...]]:
    assert picture is not None
    with Image.open(BytesIO(picture)) as image:
        return set(map(tuple, np.unique(np.asarray(image.convert("RGB")).reshape(-1, 3), axis=0).tolist()))


def test_the_curve_marks_where_conditions_are_missed() -> None:
    blue, red = (31, 95, 168), (190, 40, 35)
    assert colours(convergence_picture(entry())) >= {blue, red}
    lawful = colours(convergence_picture(entry(defaults=Value(0.0, 0.5))))
    assert blue in lawful
    assert red not in lawful


def test_the_same_optimisation_gives_the_same_picture() -> None:
    assert convergence_picture(entry()) == convergence_picture(entry())


def test_a_file_gets_no_progress(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    with progress_bar() as tell:
        tell(0.5, "optimising")
    assert capsys.readouterr() == ("", "")
