"""The planner's process, to be started before a verb is imported: it starts up while Python imports the rest."""

from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess


def start_planner() -> PlannerProcess:
    """Return a planner's process for `plan` and `run`; it starts as its context is entered."""
    return PlannerProcess()
