"""Measures of a run that every domain has: what touched what should not, and planned against measured durations."""

from collections.abc import Mapping

from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.recording import Recording

CONTACT = "contact_between_instances [N]"
PLANNED = "planned_duration [s]"
MEASURED = "measured_duration [s]"


def run_measures(plan: TaskPlan, recording: Recording) -> Mapping[str, float]:
    """Return the measures of a run of a plan.

    `CONTACT`: largest normal force between tokens of different instances, the floor excepted [N]; left out where no
    two tokens touched at all, or the backend does not measure it. `PLANNED` and `MEASURED`: how long the plan was
    scheduled to take, and how long the run took [s].
    """
    found = {PLANNED: plan.makespan, MEASURED: recording.duration}
    if recording.contacts:
        found[CONTACT] = max((c.force for c in recording.contacts if c.between_instances), default=0.0)
    return found
