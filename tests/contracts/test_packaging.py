"""The list of packages is complete. A package that is not in the list would work only in a checkout."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SOURCES = {
    "hybrid_tamp": "hybrid_tamp",
    "domains": "hybrid_tamp_domains",
    "examples": "hybrid_tamp_examples",
    "problems": "hybrid_tamp_problems",
}


def test_every_folder_of_modules_is_a_package_of_the_wheel() -> None:
    # The file is read as text, because Python 3.10 has no parser for TOML.
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    listed = re.findall(r'"(.+?)"', text.split("\npackages = [", 1)[1].split("]", 1)[0])
    here = {
        ".".join((SOURCES[source], *path.parent.relative_to(ROOT / source).parts))
        for source in SOURCES
        for path in (ROOT / source).rglob("*.py")
    }
    assert set(listed) == here
