"""The tables in the documentation name everything that exists, and nothing else."""

import re
from collections.abc import Iterator

from contracts.imports import KNOWN, ROOT

from hybrid_tamp.errors import HybridTampError, NoPlan


def packages() -> set[str]:
    """Return the packages and modules directly in hybrid_tamp/, as the layout in docs/architecture.md writes them."""
    inside = {name.split(".")[1] for name in KNOWN if name.startswith("hybrid_tamp.")}
    folders = {name for name in inside if (ROOT / "hybrid_tamp" / name).is_dir()}
    return {f"{name}/" for name in folders} | {f"{name}.py" for name in (inside - folders) | {"__init__"}}


def test_the_layout_names_every_package() -> None:
    text = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    _, block, _ = text.split("```", 2)
    assert set(re.findall(r"^  (\w+(?:/|\.py)) ", block, re.MULTILINE)) == packages()


def exit_statuses(error: type[HybridTampError]) -> Iterator[int]:
    """Yield the exit statuses of a class of errors and of its subclasses."""
    if issubclass(error, NoPlan):
        yield from (NoPlan("", proven=proven, kind="").exit_status for proven in (True, False))
    else:
        yield error.exit_status
    for each in error.__subclasses__():
        yield from exit_statuses(each)


def test_the_table_of_exit_statuses_is_complete() -> None:
    _, table = (ROOT / "README.md").read_text(encoding="utf-8").split("| exit status | meaning |\n")
    rows, _, _ = table.partition("\n\n")
    assert {int(status) for status in re.findall(r"^\| (\d+) ", rows, re.MULTILINE)} == {
        0,
        *exit_statuses(HybridTampError),
    }
