"""The commands of the README and of the guide work and exit as the pages state. All links lead somewhere."""

import re
import shlex
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
GUIDE = (ROOT / "docs" / "guide.md").read_text(encoding="utf-8")
PAGES = [*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")]


def commands(page: str) -> list[str]:
    """Return the lines of a page's shell commands."""
    blocks = re.findall(r"```sh\n(.*?)```", page, re.DOTALL)
    return [line for block in blocks for line in block.splitlines() if line]


VERBS = [line for line in commands(README) + commands(GUIDE) if line.startswith("hybrid-tamp ")]


def exits(line: str) -> int:
    """Return the exit status that the line's comment announces."""
    found = re.search(r"# exits (\d+)", line)
    return int(found.group(1)) if found else 0


def test_the_readme_has_its_two_commands() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert {"make run", "make test"} <= set(commands(README))
    assert "hybrid-tamp run problems/roll_cylinder.yaml -o out --video out/video.mp4" in makefile
    assert "scripts/check" in makefile
    assert "scripts/test" in makefile


def test_the_gate_is_the_readmes_own_test_command() -> None:
    assert "make test" in (ROOT / ".ci" / "run").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("readme")


# The commands run in the order of the README, because `replay` needs the folder of `run`.
def test_every_command_of_the_readme_works(
    command: Callable[..., "subprocess.CompletedProcess[str]"], folder: Path
) -> None:
    assert len(VERBS) >= 8
    for line in VERBS:
        done = command(*shlex.split(line, comments=True)[1:], cwd=folder)
        assert done.returncode == exits(line), (line, done.stderr)
    assert (folder / "out" / "video.mp4").stat().st_size > 10_000


def test_the_python_example_works(folder: Path) -> None:
    (example,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    scope: dict[str, object] = {}
    assert len(example.splitlines()) <= 10
    exec(compile(example.replace("out-python", str(folder / "out-python")), "README", "exec"), scope)
    assert len(scope["outcome"].steps) == 4  # type: ignore[attr-defined]
    assert scope["result"].success  # type: ignore[attr-defined]
    assert (folder / "out-python" / "recording.npz").exists()


def test_the_readme_is_short() -> None:
    assert len(README.split()) <= 900


def anchors(page: Path) -> set[str]:
    """Return the anchors of a page's headings, as the common hosting services make them."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_link_leads_to_a_file_and_to_a_heading(page: Path) -> None:
    for target in re.findall(r"\]\(([^)]+)\)", page.read_text(encoding="utf-8")):
        if target.startswith("https://"):
            continue
        name, _, anchor = target.partition("#")
        file = (page.parent / name).resolve() if name else page
        assert file.exists(), target
        assert not anchor or anchor in anchors(file), target
