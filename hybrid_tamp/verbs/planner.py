"""The planner's process. The command line starts it before it imports a verb, to save time."""

from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess


def start_planner() -> PlannerProcess:
    """Return a planner's process for `plan` and `run`; it starts when its context is entered."""
    return PlannerProcess()
