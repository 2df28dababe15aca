"""The domain's own measures of a finished run."""

from collections.abc import Iterator, Mapping

import numpy as np

from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task


def metrics(task: Task, recording: Recording) -> Mapping[str, float]:
    """Return the measures."""
    return {}
