"""A run whose recording cannot be checked does not count as a success."""

import os
from pathlib import Path

import pytest

import hybrid_tamp


def test_a_run_whose_check_aborts_has_failed_for_this_reason(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A function that aborts takes the place of the independent check."""
    monkeypatch.setattr("hybrid_tamp.verbs.judging.check_recording", lambda *_: os.abort())
    result = hybrid_tamp.run("roll_cylinder", tmp_path / "out", backend="analytic")
    assert not result.success
    assert result.recording.failure is not None
    assert result.recording.failure.reason == (
        "the check of the recording: a library ended its process (signal SIGABRT)"
    )
