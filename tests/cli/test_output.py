"""Tests of a standard output that cannot be written: no reader, a full disk, or a closed file."""

import subprocess
import sys
from importlib import metadata
from pathlib import Path

import pytest

ROLL = Path(__file__).resolve().parents[2] / "problems" / "roll_cylinder.yaml"
SHELL = f"'{sys.executable}' -m hybrid_tamp.cli"


def shell(line: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(["bash", "-c", line], capture_output=True, text=True, check=False, timeout=60)


@pytest.mark.parametrize("verb", [f"plan {ROLL}", "schema"])
def test_a_reader_that_leaves_is_no_fault(verb: str) -> None:
    done = shell(f"set -o pipefail; {SHELL} {verb} | (exit 0)")
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("verb", [f"check {ROLL}", "schema"])
def test_a_full_disk_is_said_in_a_sentence(verb: str) -> None:
    done = shell(f"{SHELL} {verb} > /dev/full")
    assert done.returncode == 1
    assert done.stderr == "cannot write to standard output: No space left on device\n"


def test_without_an_output_the_status_still_tells() -> None:
    assert shell(f"{SHELL} check {ROLL} >&-").returncode == 0


def test_the_version_and_the_help() -> None:
    assert shell(f"{SHELL} --version").stdout.split() == ["hybrid-tamp", metadata.version("hybrid-tamp")]
    assert shell(SHELL).stdout == shell(f"{SHELL} --help").stdout
