"""Example of reading a recording. The trajectory of a drum is read as numpy arrays.

Run the example with ``python examples/reading_a_recording.py``. It writes the files of the run to ``out-recording``.
"""

import sys
from pathlib import Path

import numpy as np

import hybrid_tamp


def main(folder: Path) -> dict[str, float]:
    """Run a bundled task, read the recording, and print and return measures of the movement."""
    hybrid_tamp.run("roll_cylinder", folder, backend="analytic")
    recording = hybrid_tamp.load_recording(folder / "recording.npz")
    states = recording.trajectory
    position = states["drum", "position"]  # (t, 3) [m]
    velocity = states["drum", "velocity"]  # (t, 3) [m/s]
    force = recording.commanded("hand", "force")  # (t - 1, 3) [N]
    rolling = next(instance for instance in recording.instances if instance.block == "ROLLING")
    while_rolling = (recording.times >= rolling.start) & (recording.times <= rolling.end)
    figures = {
        "path length [m]": float(np.linalg.norm(np.diff(position, axis=0), axis=-1).sum()),
        "largest speed [m/s]": float(np.linalg.norm(velocity, axis=-1).max()),
        "largest speed before rolling [m/s]": float(
            np.linalg.norm(velocity[recording.times < rolling.start], axis=-1).max()
        ),
        "share of the time spent rolling": float(while_rolling.mean()),
        "largest force of the hand [N]": float(np.linalg.norm(force, axis=-1).max()),
    }
    for name, value in figures.items():
        print(f"{name:36} {value:.3f}")
    return figures


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "out-recording"))
