"""The planner process. To save time, the command line starts the process before importing a verb."""

from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess


def start_planner() -> PlannerProcess:
    """Return a planner process for `plan` and `run`. The process starts when its context is entered."""
    return PlannerProcess()
