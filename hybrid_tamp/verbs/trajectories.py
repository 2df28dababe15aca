"""Save the trajectories of a run as a table, which other programs and the verb ``imitate`` read."""

from pathlib import Path

from hybrid_tamp.execution.storage import load_recording
from hybrid_tamp.interop.trajectories import trajectory_csv
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.report.folder import write_new_file


def save_trajectories(source: Recording | Path | str, path: Path | str, *, force: bool = False) -> None:
    """Write the trajectories of a recording as comma-separated values (see `trajectory_table` for the columns).

    Args:
        source: a recording, or the folder of a run.
        path: the file to write.
        force: whether to replace an existing file.

    Raises:
        InputError: the folder has no recording, the file exists and `force` is false, or the file cannot be written.
    """
    recording = source if isinstance(source, Recording) else load_recording(Path(source) / "recording.npz")
    write_new_file(Path(path), trajectory_csv(recording), "the trajectories", force=force)
