"""Tests of the domain. Run them with pytest."""

from pathlib import Path

import hybrid_tamp
from hybrid_tamp.testing import check_domain

TASK = Path(__file__).parent / "task.yaml"


def test_the_declarations_agree_with_rollouts() -> None:
    """Rollouts of every block agree with its declarations."""
    assert check_domain(hybrid_tamp.load_task(TASK), samples=2) == []


def test_the_crumbs_end_in_the_tray(tmp_path: Path) -> None:
    """The goal holds at the end of a run in physics."""
    assert hybrid_tamp.run(TASK, tmp_path).success
