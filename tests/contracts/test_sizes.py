"""No module and no function is so long that it cannot be read at a sitting."""

import ast

from contracts.imports import ROOT, source_files

LONGEST_MODULE = 250
LONGEST_FUNCTION = 40
"""Lines of code, from `def`, without the docstring and blank lines."""

LONG_FUNCTIONS = frozenset(
    {
        "domains/rolling_tumbling/tipping.py:_tipping",
        "domains/tool_use/carrying.py:_carrying",
    }
)
"""Functions that are too long. The list may only shrink."""


def test_no_module_over_250_lines() -> None:
    lengths = {path.relative_to(ROOT): len(path.read_text(encoding="utf-8").splitlines()) for path in source_files()}
    assert {str(path): lines for path, lines in lengths.items() if lines > LONGEST_MODULE} == {}


def length(function: ast.FunctionDef | ast.AsyncFunctionDef, lines: list[str]) -> int:
    numbers = set(range(function.lineno, (function.end_lineno or 0) + 1))
    if ast.get_docstring(function) is not None:
        numbers -= set(range(function.body[0].lineno, (function.body[0].end_lineno or 0) + 1))
    return sum(1 for number in numbers if lines[number - 1].strip())


def functions() -> dict[str, int]:
    """Return the length of every function, by file and name."""
    found = {}
    for path in source_files():
        place = str(path.relative_to(ROOT))
        text = path.read_text(encoding="utf-8")
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                found[f"{place}:{node.name}"] = length(node, text.splitlines())
    return found


def test_no_function_over_40_lines() -> None:
    assert {name for name, lines in functions().items() if lines > LONGEST_FUNCTION} <= LONG_FUNCTIONS


LONGEST_VERB = 150


def test_a_verb_is_at_most_150_lines() -> None:
    verbs = (ROOT / "hybrid_tamp" / "verbs").glob("*.py")
    long = {path.name for path in verbs if len(path.read_text(encoding="utf-8").splitlines()) > LONGEST_VERB}
    assert long == set()
