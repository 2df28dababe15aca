"""Example of an external planner: export a task as PDDL, solve the PDDL problem, and read the plan.

The external planner does not use hybrid_tamp. The library unified-planning reads the two PDDL files and starts Fast
Downward. Run the example with ``python examples/external_planner.py``.
"""

import sys
from pathlib import Path

from unified_planning.io import PDDLReader
from unified_planning.shortcuts import OneshotPlanner, get_environment

import hybrid_tamp


def solve(folder: Path) -> Path:
    """Solve ``domain.pddl`` and ``problem.pddl`` in a folder, and return the path of the plan, ``external.plan``."""
    get_environment().credits_stream = None
    problem = PDDLReader().parse_problem(str(folder / "domain.pddl"), str(folder / "problem.pddl"))
    with OneshotPlanner(name="fast-downward") as planner:
        actions = planner.solve(problem).plan.actions
    path = folder / "external.plan"
    lines = [f"({' '.join([each.action.name, *map(str, each.actual_parameters)])})\n" for each in actions]
    path.write_text("".join(lines), encoding="utf-8")
    return path


def main(folder: Path) -> hybrid_tamp.TaskPlan:
    """Export a task, solve the PDDL problem, read the plan and print it."""
    task = hybrid_tamp.load_task("tumble_two_hands")
    hybrid_tamp.pddl(task, folder)
    plan = hybrid_tamp.read_plan(task, solve(folder))
    print(plan)
    return plan


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "out-external"))
