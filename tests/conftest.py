"""Settings and fixtures for all tests."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import settings
from toys import Toys

# A slow example on a busy machine is not a failure. All runs test the same examples.
settings.register_profile("project", deadline=None, derandomize=True)
settings.load_profile("project")

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture(scope="session")
def command() -> Callable[..., "subprocess.CompletedProcess[str]"]:
    """Run the command line as a separate process, by default in the repository's root."""

    def run(*words: str | Path, cwd: Path = ROOT) -> "subprocess.CompletedProcess[str]":
        return subprocess.run(
            [sys.executable, "-m", "hybrid_tamp.cli", *map(str, words)],
            capture_output=True,
            text=True,
            check=False,
            cwd=cwd,
            timeout=300,
        )

    return run


@pytest.fixture
def toys() -> Toys:
    """Return a small world of pushers, spots and things."""
    return Toys()
