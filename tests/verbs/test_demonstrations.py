"""Tests of faults in demonstrations and primitive files. Messages state the place, and the exit status is 30."""

import json
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import hybrid_tamp
from hybrid_tamp.errors import InputError
from hybrid_tamp.taskfile.demonstrations import read_demonstration
from hybrid_tamp.taskfile.primitives import read_primitive

LINES = ["time [s], x [m], y [m], z [m]", *(f"0.{n}, {n}.5, 0, -1e-2" for n in range(6))]


def changed(number: int, line: str) -> list[str]:
    """Replace one line, counted from 1."""
    return [line if n == number else old for n, old in enumerate(LINES, start=1)]


def test_a_table_is_read(tmp_path: Path) -> None:
    (tmp_path / "d.csv").write_text("\r\n".join([*LINES, "", ""]))
    shown = read_demonstration(tmp_path / "d.csv")
    np.testing.assert_array_equal(shown.time, np.arange(6) / 10)
    np.testing.assert_array_equal(shown.positions[3], [3.5, 0.0, -0.01])
    assert shown.orientations is None


@pytest.mark.parametrize(
    ("lines", "place", "words"),
    [
        (LINES[:5], "5:1", ("at least 5 samples", "got 4 samples")),
        (LINES[:1], "1:1", ("at least 5 samples", "got 0 samples")),
        ([], "1:1", ("name the columns time, x, y, z", "an empty file")),
        (LINES[1:], "1:1", ("must name the columns", "0.0,0.5")),
        (changed(1, "time, x, z, y"), "1:1", ("must name the columns", "time,x,z,y")),
        (changed(1, "t,x,y,z,qx,qy,qz,qw"), "1:1", ("must name the columns",)),
        (changed(4, "0.2, 2.5, 0"), "4:11", ("every line must have 4 columns", "got 3 columns")),
        (changed(4, "0.2, 2.5, 0, 1, 2"), "4:17", ("every line must have 4 columns", "got 5 columns")),
        (changed(4, "0.2, 2.5 m, 0, 1"), "4:6", ("a number", "got '2.5 m'")),
        (changed(4, "0.2, 2.5, , 1"), "4:11", ("a number", "got nothing")),
        (changed(4, "0.2, 2.5, nan, 1"), "4:11", ("finite", "got nan")),
        (changed(4, "0.2, 2.5, 0, -inf"), "4:14", ("finite", "got -inf")),
        (changed(4, "0.2, 2.5, 0, 1e300"), "4:14", ("and 1e+06", "got 1e300")),
        (changed(4, "0.1, 2.5, 0, 1"), "4:1", ("time must increase", "got 0.1 s after 0.1 s")),
        (changed(4, "-3, 2.5, 0, 1"), "4:1", ("time must increase", "got -3 s after 0.1 s")),
    ],
)
def test_faults_of_a_table(tmp_path: Path, lines: list[str], place: str, words: tuple[str, ...]) -> None:
    file = tmp_path / "d.csv"
    file.write_text("\n".join(lines))
    with pytest.raises(InputError) as refused:
        read_demonstration(file)
    (issue,) = refused.value.issues
    assert issue.where == f"{file}:{place}"
    assert all(word in str(issue) for word in words), str(issue)


def test_every_fault_is_told_at_once(tmp_path: Path) -> None:
    (tmp_path / "d.csv").write_text("\n".join([*LINES, "0.7, x, 0, 0", "0.8, 0, nan, 0", "0.9"]))
    with pytest.raises(InputError) as refused:
        read_demonstration(tmp_path / "d.csv")
    assert [issue.where.split("d.csv:")[1] for issue in refused.value.issues] == ["8:6", "9:9", "10:1"]


def test_a_quaternion_has_length_one(tmp_path: Path) -> None:
    rows = [f"{n}, 0, 0, 0, 0, 0, 0, {1.0 if n != 3 else 0.5}" for n in range(6)]
    (tmp_path / "d.csv").write_text("\n".join(["time,x,y,z,qx,qy,qz,qw", *rows]))
    with pytest.raises(InputError, match=r"d.csv:5:1: qx, qy, qz, qw must be a unit quaternion; got length 0.5"):
        read_demonstration(tmp_path / "d.csv")


@pytest.mark.parametrize("name", ["none.csv", "."])
def test_no_table(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match=r"a demonstration; got (no file of this name|a folder)"):
        read_demonstration(tmp_path / name)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('"alpha": 25.0', '"alpha": "25"', ("alpha", "must be a number", "'25'")),
        ('"beta": 6.25', '"beta": NaN', ("beta", "must be a number")),
        ('"rms": 0.0', '"rms": 1e999', ("rms", "must be a finite number")),
        ('"dimensions": 3', '"dimensions": 2', ("dimensions", "must be 1 or 3")),
        ('"soft_start": false', '"soft": false', ("unknown key in the primitive file", "'soft'")),
        ('"soft_start": false', '"soft_start": false, "soft_start": true', ("a key must occur only once",)),
        ("primitive/1", "primitive/2", ("schema", "hybrid-tamp/primitive/1")),
        ("[\n  [", "[\n  [0.0, ", ("one number per dimension (3)", "got 4")),
        ("{", "", ("p.json:",)),
        ('"block": "REACHING",', "", ("missing key 'block' in the primitive file",)),
    ],
)
def test_faults_of_a_primitive_file(tmp_path: Path, old: str, new: str, words: tuple[str, ...]) -> None:
    from hybrid_tamp.motion.dmp import DMP
    from hybrid_tamp.taskfile.primitives import PrimitiveFile

    file = tmp_path / "p.json"
    hybrid_tamp.save_primitive(PrimitiveFile.of(DMP(np.zeros((2, 3))), "REACHING", ["x"], 0.0, "m"), file)
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new, 1))
    with pytest.raises(InputError) as refused:
        read_primitive(file)
    assert all(issue.where.startswith(f"{file}:") for issue in refused.value.issues)
    assert any(all(word in str(issue) for word in words) for issue in refused.value.issues), str(refused.value)


def test_what_cannot_be_learnt_exits_30(
    command: Callable[..., "subprocess.CompletedProcess[str]"], tmp_path: Path
) -> None:
    (tmp_path / "d.csv").write_text("\n".join(changed(4, "0.2, nan, 0, 1")))
    done = command("learn", "REACHING:behind", tmp_path / "d.csv", "-o", tmp_path / "p.json", "--json")
    assert done.returncode == 30
    assert json.loads(done.stdout)["issues"][0]["where"] == f"{tmp_path}/d.csv:4:6"
    assert not (tmp_path / "p.json").exists()


@pytest.mark.parametrize(
    ("block", "words"),
    [
        ("ROLLING", "the block must have a motor primitive"),
        ("REECHING", "did you mean 'REACHING'"),
        ("REACHING", "specify which mode to use; available: .*REACHING:behind, REACHING:beside, REACHING:away"),
    ],
)
def test_blocks_that_cannot_be_taught(tmp_path: Path, block: str, words: str) -> None:
    (tmp_path / "d.csv").write_text("\n".join(LINES))
    with pytest.raises(InputError, match=words):
        hybrid_tamp.learn(block, [tmp_path / "d.csv"])


def test_other_wrong_arguments(tmp_path: Path) -> None:
    (tmp_path / "d.csv").write_text("\n".join(LINES))
    with pytest.raises(InputError, match="at least one demonstration"):
        hybrid_tamp.learn("REACHING:behind", [])
    with pytest.raises(InputError, match="one weight"):
        hybrid_tamp.learn("REACHING:behind", [tmp_path / "d.csv"], weights=0)
    with pytest.raises(InputError, match="no recording of a run"):
        hybrid_tamp.learn("REACHING:behind", [tmp_path])
    learnt = hybrid_tamp.learn("REACHING:behind", [tmp_path / "d.csv"])
    with pytest.raises(InputError, match="force=True replaces"):
        hybrid_tamp.save_primitive(learnt, tmp_path / "d.csv")
    with pytest.raises(InputError, match="cannot write to the output folder"):
        hybrid_tamp.save_primitive(learnt, tmp_path / "none" / "p.json")
