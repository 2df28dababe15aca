"""Measures that every domain has: the contact force between instances, and the planned and measured durations."""

from collections.abc import Mapping

from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.recording import Recording

CONTACT = "contact_between_instances [N]"
PLANNED = "planned_duration [s]"
MEASURED = "measured_duration [s]"


def run_measures(plan: TaskPlan, recording: Recording) -> Mapping[str, float]:
    """Return the measures of a run of a plan.

    - `CONTACT`: largest normal force between tokens of different instances [N]. Floor contacts are ignored. The
      measure is absent if no such tokens touched or the backend does not measure contacts.
    - `PLANNED`: makespan of the plan [s].
    - `MEASURED`: duration of the run [s].
    """
    found = {PLANNED: plan.makespan, MEASURED: recording.duration}
    if recording.contacts:
        found[CONTACT] = max((c.force for c in recording.contacts if c.between_instances), default=0.0)
    return found
