"""The generated files equal the output of the code. Only `scripts/regenerate` writes them."""

from pathlib import Path

import pytest
from contracts.scripts import load_script

from hybrid_tamp.taskfile.loader import load_task

ROOT = Path(__file__).resolve().parents[2]


REGENERATE = load_script("regenerate")
PDDL: dict[str, tuple[Path, str]] = REGENERATE.generate_pddl()
OTHERS: dict[Path, str] = REGENERATE.generate_others()
REMEDY = "run scripts/regenerate and read the difference"


@pytest.mark.parametrize("name", PDDL)
def test_pddl_is_up_to_date(name: str) -> None:
    path, text = PDDL[name]
    assert path.read_text(encoding="utf-8") == text, REMEDY


@pytest.mark.parametrize("path", OTHERS, ids=lambda path: str(path.relative_to(ROOT)))
def test_generated_file_is_up_to_date(path: Path) -> None:
    assert path.read_text(encoding="utf-8") == OTHERS[path], REMEDY


def test_every_problem_has_a_golden_pair() -> None:
    tasks = [load_task(path) for path in (ROOT / "problems").glob("*.yaml")]
    stems = {task.name for task in tasks if task.definite}
    golden = ROOT / "tests" / "golden"
    assert {path.parent.name for path in golden.glob("*/problem.pddl")} == stems
    assert {f"{stem}/domain.pddl" for stem in stems} <= PDDL.keys()


def test_every_golden_file_is_generated_and_its_text_stands_once() -> None:
    kept = set((ROOT / "tests" / "golden").rglob("*.pddl"))
    assert kept == {path for path, _ in PDDL.values()}
    assert len({path.read_bytes() for path in kept}) == len(kept)


def test_the_domain_file_does_not_depend_on_the_tokens() -> None:
    from scenes import rolling_task

    from hybrid_tamp.symbolic.encoding.problem import compile_task
    from hybrid_tamp.symbolic.pddl.text import domain_text

    one = domain_text(compile_task(rolling_task()).problem.domain)
    many = domain_text(
        compile_task(rolling_task(hands=5, drums=[(0, 0), (0, 1)], regions=[(1, 0), (1, 1)])).problem.domain
    )
    assert one == many
