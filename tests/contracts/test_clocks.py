"""The modules that read the clock. Only the deadline depends on the clock, so the clock never decides a result."""

import ast
from pathlib import Path

from contracts.imports import ROOT, source_files

CLOCKS = ("monotonic", "perf_counter", "process_time", "time", "monotonic_ns", "perf_counter_ns", "time_ns")

DEADLINES = {"hybrid_tamp/model/deadline.py"}
"""Modules that compare the time with a deadline."""
BEGINNINGS = {
    "hybrid_tamp/cli/app.py",
    "hybrid_tamp/verbs/loading.py",
    "hybrid_tamp/verbs/replay.py",
}
"""Modules that store the time at which a command begins."""
DURATIONS = {
    "hybrid_tamp/cli/run.py",
    "hybrid_tamp/midlevel/physics_refinement.py",
    "hybrid_tamp/midlevel/refinement.py",
    "hybrid_tamp/planning/plan.py",
    "hybrid_tamp/symbolic/engines/planner_process.py",
    "hybrid_tamp/symbolic/find_plan.py",
    "hybrid_tamp/symbolic/strategies/search.py",
    "hybrid_tamp/verbs/imitate.py",
    "hybrid_tamp/verbs/run.py",
}
"""Modules that measure durations for the user."""
PROCESSES = {"hybrid_tamp/symbolic/engines/worker_process.py"}
"""Modules that wait for the planner process until its limit."""


def reads_clock(path: Path) -> bool:
    """Return whether a module calls a function of `time` that reads a clock."""
    return any(
        isinstance(node, ast.Attribute)
        and node.attr in CLOCKS
        and isinstance(node.value, ast.Name)
        and node.value.id == "time"
        for node in ast.walk(ast.parse(path.read_text()))
    )


def test_few_modules_read_the_clock() -> None:
    found = {path.relative_to(ROOT).as_posix() for path in source_files() if reads_clock(path)}
    assert found == DEADLINES | BEGINNINGS | DURATIONS | PROCESSES
