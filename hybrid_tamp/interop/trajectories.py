"""The trajectories of a recording as a table. The columns are those that the verb ``imitate`` reads.

::

    time,hand.x,hand.y,hand.z,hand.qx,hand.qy,hand.qz,hand.qw,drum.x,...
"""

import csv
import io

import numpy as np

from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.table_columns import TIME, column_names
from hybrid_tamp.motion.arrays import FloatArray


def trajectory_table(recording: Recording) -> dict[str, FloatArray]:
    """Return the poses of all tokens except places, e.g. for ``pandas.DataFrame(trajectory_table(recording))``.

    The columns are ``time`` [s], and for each token ``token.x`` to ``token.z`` [m] and the quaternion ``token.qx`` to
    ``token.qw``. Varying properties with one component, e.g. ``hand.aperture``, have columns too. All values are in the
    world frame and in SI units. Use `Recording.trajectory` for velocities and places.

    Returns:
        Mapping from each column to its values at the instants of the recording, shape ``(t + 1,)``.
    """
    # By the law of assignment, every token except places is always in a slot.
    assigned = {token for instance in recording.instances for token in instance.slots.values()}
    table = {TIME: recording.times.copy()}
    for token, varying, size in recording.layout.entries:
        names = column_names(token, varying, size)
        if token in assigned and names:
            table.update(zip(names, recording.trajectory[token, varying].T.copy(), strict=True))
    return table


def trajectory_csv(recording: Recording) -> str:
    """Return `trajectory_table` as comma-separated text. The numbers have all digits, so that readers lose nothing."""
    table = trajectory_table(recording)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(table)
    writer.writerows(np.stack(list(table.values()), axis=-1).tolist())
    return text.getvalue()
