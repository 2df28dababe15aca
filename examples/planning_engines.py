"""Example of engines of unified_planning that solve a task in Python, without PDDL files.

Run the example with ``python examples/planning_engines.py``. The engines are Fast Downward and pyperplan.
"""

from unified_planning.shortcuts import OneshotPlanner

import hybrid_tamp

ENGINES = {
    # Without this option, Fast Downward looks for invariants for about 20 s before it plans this task.
    "fast-downward": {"fast_downward_translate_options": ["--invariant-generation-max-candidates", "200"]},
    "pyperplan": {},
}
"""Engines with their parameters."""


def main() -> dict[str, hybrid_tamp.TaskPlan]:
    """Solve a task with each engine, and print and return the plans."""
    task = hybrid_tamp.load_task("hammer_strike")
    problem = hybrid_tamp.to_unified_planning(task)
    plans = {}
    for engine, parameters in ENGINES.items():
        with OneshotPlanner(name=engine, params=parameters) as planner:
            found = planner.solve(problem).plan
        plans[engine] = hybrid_tamp.from_unified_planning(task, found)
        print(f"{engine}: {len(found.actions)} actions\n{plans[engine]}")
    return plans


if __name__ == "__main__":
    main()
