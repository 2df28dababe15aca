"""Modules and functions are short."""

import ast

from contracts.imports import ROOT, source_files
from contracts.scripts import load_script

LONGEST_MODULE = 250
LONGEST_FUNCTION = 40
"""Maximum number of lines of a function, without the docstring and blank lines."""


def test_no_module_over_250_lines() -> None:
    lengths = {path.relative_to(ROOT): len(path.read_text(encoding="utf-8").splitlines()) for path in source_files()}
    assert {str(path): lines for path, lines in lengths.items() if lines > LONGEST_MODULE} == {}


def functions() -> dict[str, int]:
    """Return the length of every function, by file and name."""
    length = load_script("metrics").length
    found = {}
    for path in source_files():
        place = str(path.relative_to(ROOT))
        text = path.read_text(encoding="utf-8")
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                found[f"{place}:{node.name}"] = length(node, text.splitlines())
    return found


def test_no_function_over_40_lines() -> None:
    assert {name: lines for name, lines in functions().items() if lines > LONGEST_FUNCTION} == {}


LONGEST_VERB = 150


def test_a_verb_is_at_most_150_lines() -> None:
    verbs = (ROOT / "hybrid_tamp" / "verbs").glob("*.py")
    long = {path.name for path in verbs if len(path.read_text(encoding="utf-8").splitlines()) > LONGEST_VERB}
    assert long == set()
