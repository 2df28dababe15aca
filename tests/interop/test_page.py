"""The code of docs/interop.md works."""

import re
import shlex
import subprocess
from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "interop.md").read_text(encoding="utf-8")


# The blocks run in the order of the page, because the commands need the files of the Python code.
def test_the_code_of_the_page_works(
    command: Callable[..., "subprocess.CompletedProcess[str]"], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    scope: dict[str, object] = {}
    kinds = set()
    for kind, block in re.findall(r"```(python|sh)\n(.*?)```", PAGE, re.DOTALL):
        kinds.add(kind)
        if kind == "python":
            exec(compile(block, "interop.md", "exec"), scope)
            continue
        for line in block.splitlines():
            # The example of imitation shows that another agent can imitate an exported table.
            done = command(*shlex.split(line)[1:], cwd=tmp_path)
            assert done.returncode == 0, (line, done.stderr)
    assert kinds == {"python", "sh"}
    assert (tmp_path / "table.csv").read_bytes() == (tmp_path / "roll.csv").read_bytes()
    assert list(pd.read_csv(tmp_path / "table.csv")) == list(scope["table"])  # type: ignore[call-overload]
    assert scope["picture"].shape[2] == 3  # type: ignore[attr-defined]


def test_every_file_that_the_page_links_to_is_there() -> None:
    for target in re.findall(r"\]\(([^)#]+)\)", PAGE):
        assert target.startswith("http") or (ROOT / "docs" / target).exists(), target
