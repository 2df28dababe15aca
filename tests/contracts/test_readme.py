"""The commands of the README and of the guide work and exit as the pages state. All links lead somewhere."""

import re
import shlex
import subprocess
from collections.abc import Callable, Iterable
from itertools import pairwise
from pathlib import Path

import pytest
from ruamel.yaml import YAML

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
GUIDE = (ROOT / "docs" / "guide.md").read_text(encoding="utf-8")
PAGES = [*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")]


def commands(page: str) -> list[str]:
    """Return the lines of a page's shell commands."""
    blocks = re.findall(r"```sh\n(.*?)```", page, re.DOTALL)
    return [line for block in blocks for line in block.splitlines() if line]


VERBS = [line for line in commands(README) + commands(GUIDE) if line.startswith("hybrid-tamp ")]


SHOWN = dict(re.findall(r"\n(hybrid-tamp [^\n]*)\n```\n\n```\n(.*?)```", README, re.DOTALL))
"""Maps the command above each block of output to the output."""


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


def outputs(line: str) -> list[str]:
    """Return the files and folders that a command writes."""
    words = shlex.split(line, comments=True)
    flags = ("-o", "--video", "--gif", "--csv", "--write")
    return [word for flag, word in pairwise(words) if flag in flags]


def in_groups(lines: Iterable[str]) -> list[list[str]]:
    """Return groups of commands. A command that reads what another command writes is in the group of that command."""
    groups: list[list[str]] = []
    for line in lines:
        read = {*shlex.split(line, comments=True)} - {*outputs(line)}
        for group in groups:
            if any(word in read for earlier in group for word in outputs(earlier)):
                group.append(line)
                break
        else:
            groups.append([line])
    return groups


# Separate groups can run on separate cores.
@pytest.mark.parametrize("group", in_groups(VERBS), ids=lambda group: group[0].partition("#")[0].strip())
def test_every_command_of_the_readme_works(
    command: Callable[..., "subprocess.CompletedProcess[str]"], group: list[str], tmp_path: Path
) -> None:
    for line in group:
        done = command(*shlex.split(line, comments=True)[1:], cwd=tmp_path)
        assert done.returncode == exits(line), (line, done.stderr)
        for name in outputs(line):
            assert (tmp_path / name).exists(), line
            if name.endswith((".mp4", ".gif")):
                assert (tmp_path / name).stat().st_size > 10_000, line
        if line in SHOWN:
            # Terminals differ in width.
            assert done.stdout.split() == SHOWN[line].split()


def test_the_readme_shows_what_a_command_prints() -> None:
    assert len(VERBS) >= 8
    assert SHOWN.keys() <= {*VERBS}
    assert len(SHOWN) == 1


def test_the_task_of_the_readme_is_an_extract_of_its_file() -> None:
    ((name, text),) = re.findall(r"\]\((problems/[\w.]+)\)[^`]*```yaml\n(.*?)```", README, re.DOTALL)
    assert 4 <= len(text.splitlines()) <= 10
    shown, whole = YAML(typ="safe").load(text), YAML(typ="safe").load(ROOT / name)
    assert set(whole["tokens"]) - set(shown["tokens"]) == {"hand"}
    turned = shown["tokens"]["drum"]["pose"]["rpy"]
    assert turned == pytest.approx(whole["tokens"]["drum"]["pose"]["rpy"], abs=1e-4)
    turned[:] = whole["tokens"]["drum"]["pose"]["rpy"]
    assert shown["tokens"].items() <= whole["tokens"].items()
    assert (shown["domain"], shown["goal"]) == (whole["domain"], whole["goal"])


def test_the_python_example_works(tmp_path: Path) -> None:
    (example,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    scope: dict[str, object] = {}
    assert len(example.splitlines()) <= 10
    exec(compile(example.replace("out-python", str(tmp_path / "out-python")), "README", "exec"), scope)
    assert len(scope["outcome"].steps) == 4  # type: ignore[attr-defined]
    assert scope["result"].success  # type: ignore[attr-defined]
    assert (tmp_path / "out-python" / "recording.npz").exists()


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
