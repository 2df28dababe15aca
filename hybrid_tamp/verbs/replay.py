"""The verb ``replay``: check whether the recorded commands reproduce the recorded states bit for bit."""

import time
from collections.abc import Callable
from pathlib import Path

from hybrid_tamp.execution import replay as replaying
from hybrid_tamp.execution.storage import load_recording
from hybrid_tamp.model.deadline import Deadline
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.run_result import ReplayResult
from hybrid_tamp.physics.protocol import open_backend
from hybrid_tamp.taskfile.loader import load_task


def replay(directory: Path | str, find_domain: Callable[[str], Domain] | None = None) -> ReplayResult:
    """Run the commands of a recording again and compare the states bit for bit.

    Args:
        directory: the folder of a run.
        find_domain: function that finds the domain by the name in the task file.

    Raises:
        InputError: the folder has no complete run; the message names the fault.
        LimitReached: the time limit of the task was reached.
    """
    began, folder = time.monotonic(), Path(directory)
    recording = load_recording(folder / "recording.npz")
    task = load_task(folder / "task.yaml", find_domain)
    with open_backend(recording.backend) as physics:
        return replaying.replay(task, recording, physics, Deadline.after(task.limits.time, began))
