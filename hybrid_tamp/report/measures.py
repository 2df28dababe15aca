"""Measures of a run in every domain: forces between instances, and planned and measured durations."""

from collections.abc import Mapping

from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.recording import Recording

CONTACT = "contact_between_instances [N]"
PLANNED = "planned_duration [s]"
MEASURED = "measured_duration [s]"


def run_measures(plan: TaskPlan, recording: Recording) -> Mapping[str, float]:
    """Return the measures of a run of a plan.

    `CONTACT` is the largest normal force between tokens of different instances, except the floor [N]. It is absent if
    no two tokens touched or the backend does not measure contacts. `PLANNED` is the makespan of the plan, and
    `MEASURED` the duration of the run [s].
    """
    found = {PLANNED: plan.makespan, MEASURED: recording.duration}
    if recording.contacts:
        found[CONTACT] = max((c.force for c in recording.contacts if c.between_instances), default=0.0)
    return found
