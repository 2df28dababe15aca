"""A plan that several modules run."""

import pytest

import hybrid_tamp
from hybrid_tamp import Task, TaskPlan


@pytest.fixture(scope="session")
def planned() -> tuple[Task, TaskPlan]:
    """Return a bundled task and its plan."""
    task = hybrid_tamp.load_task("roll_cylinder")
    return task, hybrid_tamp.plan(task).required()
