"""Tables of tasks with many tokens name only the tokens that matter."""

import io

from rich.console import Console

from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.report.tables import RESTING, name_some, timeline


def test_further_names_are_counted() -> None:
    assert name_some(["a", "b"], 2) == "a, b"
    assert name_some(["a", "b", "c", "d"], 2) == "a, b and 2 more"


def draw_timeline(count: int) -> str:
    """Return the timeline of a plan with one token that moves and `count` tokens that rest."""
    names = [f"crate-{number}" for number in range(count)]
    resting = [BlockInstance(f"RESTING-{name}", "RESTING", {"token": name}, 0.0, 2.0) for name in names]
    plan = TaskPlan((BlockInstance("ROLLING-1", "ROLLING", {"object": "drum"}, 0.0, 2.0), *resting), 2.0)
    console = Console(file=io.StringIO(), width=100)
    console.print(timeline(plan, ["drum", *names], "RESTING"))
    assert isinstance(console.file, io.StringIO)
    return console.file.getvalue()


def test_the_timeline_of_many_tokens_has_no_rows_for_those_that_always_rest() -> None:
    few, many = draw_timeline(RESTING - 1), draw_timeline(RESTING)
    assert few.count("crate-") == RESTING - 1
    assert many.count("crate-") == 0
    assert "drum" in many
