import json
from pathlib import Path

import pytest

from hybrid_tamp.errors import InputError
from hybrid_tamp.report.folder import RunFolder


def test_files_appear_whole_or_not_at_all(tmp_path: Path) -> None:
    folder = RunFolder.create(tmp_path / "a" / "b")
    folder.write_json("result.json", {"ß": 1.5})
    assert json.loads((folder.path / "result.json").read_text(encoding="utf-8")) == {"ß": 1.5}
    with pytest.raises(ValueError, match="JSON"):
        folder.write_json("plan.json", {"margin": float("nan")})
    assert [path.name for path in folder.path.iterdir()] == ["result.json"]


def test_another_run_is_kept_unless_forced(tmp_path: Path) -> None:
    RunFolder.create(tmp_path).write_text("events.jsonl", "")
    (tmp_path / "step-01.png").touch()
    (tmp_path / "mine.txt").touch()
    with pytest.raises(InputError, match="force=True"):
        RunFolder.create(tmp_path)
    folder = RunFolder.create(tmp_path, force=True)
    assert len(list(tmp_path.iterdir())) == 3, "nothing is lost before something takes its place"
    folder.clear()
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


def test_a_file_is_no_folder(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.touch()
    with pytest.raises(InputError, match="must be a folder"):
        RunFolder.create(file)
    with pytest.raises(InputError, match="cannot create the folder"):
        RunFolder.create(file / "below")
