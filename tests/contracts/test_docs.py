"""The tables in the documentation are complete and contain nothing that does not exist."""

import re
from collections.abc import Iterator
from pathlib import Path

from contracts.imports import KNOWN, ROOT

import hybrid_tamp
from hybrid_tamp.errors import HybridTampError, NoPlan
from hybrid_tamp.taskfile.domains import available_domains, find_domain


def packages() -> set[str]:
    """Return the packages and modules directly in hybrid_tamp/, written as in the layout in docs/architecture.md."""
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
    _, table = (ROOT / "docs" / "guide.md").read_text(encoding="utf-8").split("| exit status | meaning |\n")
    rows, _, _ = table.partition("\n\n")
    assert {int(status) for status in re.findall(r"^\| (\d+) ", rows, re.MULTILINE)} == {
        0,
        *exit_statuses(HybridTampError),
    }


def test_the_table_of_feasibility_facts_has_the_kinds_of_the_bundled_domains() -> None:
    text = (ROOT / "docs" / "domains.md").read_text(encoding="utf-8")
    _, table = text.split("| predicate | domain | kind | what it states |\n")
    told = {
        (name, domain): kind
        for names, domains, kind in re.findall(r"^\| (`[^|]+) \| (`[^|]+) \| ([^|]+) \|", table, re.MULTILINE)
        for name in re.findall(r"\w+", names)
        for domain in re.findall(r"\w+", domains)
    }
    declared = {
        (predicate.name, name): predicate
        for name in available_domains()
        for predicate in find_domain(name).static_predicates
        if predicate.rows is None
    }
    assert set(told) == set(declared)
    for key, predicate in declared.items():
        assert ("competence" in told[key]) == predicate.competence, key
        factor = f"safety factor {predicate.safety.factor:g}" if predicate.safety else "safety factor"
        assert (factor in told[key]) == (predicate.safety is not None), key


def test_the_first_domain_of_the_page_is_the_example_and_plans(tmp_path: Path) -> None:
    text = (ROOT / "docs" / "domains.md").read_text(encoding="utf-8")
    section = text.split("\n## A first domain\n", 1)[1].split("\n## ", 1)[0]
    code = "\n".join(block.rstrip("\n") + "\n" for block in re.findall(r"```python\n(.*?)```", section, re.DOTALL))
    example = ROOT / "examples" / "sweeping"
    written = (example / "domain.py").read_text(encoding="utf-8")
    assert code.split() == written.split()
    assert len(written.splitlines()) <= 80
    (tmp_path / "domain.py").write_text(written, encoding="utf-8")
    (tmp_path / "task.yaml").write_text((example / "task.yaml").read_text(encoding="utf-8"), encoding="utf-8")
    plan = hybrid_tamp.plan(tmp_path / "task.yaml").required()
    assert sum(instance.block == "SWEEPING" for instance in plan.instances) == 2
