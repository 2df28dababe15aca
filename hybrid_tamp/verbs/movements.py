"""Drawing of the movements of a plan, with the closest pair of bodies in each movement."""

from dataclasses import replace
from pathlib import Path

from hybrid_tamp.errors import LimitReached
from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.outcome import PlanningFailure, PlanOutcome
from hybrid_tamp.planning.closest_pairs import sweep_plan
from hybrid_tamp.report.folder import RunFolder
from hybrid_tamp.report.swept.file import write_picture

MOVEMENTS = "movements.png"
"""Name of the picture in the folder of a run."""


def draw_plan(outcome: PlanOutcome, file: Path, deadline: Deadline = NEVER) -> PlanOutcome:
    """Draw the movements of a plan, or those of a plan that was refused because it hits a body.

    Args:
        outcome: outcome of planning.
        file: file for the picture.
        deadline: deadline of the command.

    Returns:
        The outcome with the closest pairs. If the deadline passes, the outcome is a failure without a picture.

    Raises:
        InputError: the file cannot be written.
        NotFinite: the rollout of the plan failed.
    """
    try:
        swept = sweep_plan(outcome, deadline)
    except LimitReached as limit:
        return replace(outcome, failure=outcome.failure or PlanningFailure.of(limit))
    write_picture(swept, file)
    if outcome.plan is None:
        return outcome
    return replace(outcome, closest_pairs=tuple(path.closest for path in swept.paths if path.closest is not None))


def draw_into(folder: RunFolder, outcome: PlanOutcome, deadline: Deadline = NEVER) -> None:
    """Draw the movements of a plan into the folder of a run, unless there are no movements or a limit was reached.

    Raises:
        InputError: the folder is not writable.
        LimitReached: the deadline passes.
    """
    if outcome.status == "limit":
        return
    swept = sweep_plan(outcome, deadline)
    if swept.paths:
        write_picture(swept, folder.path / MOVEMENTS)
