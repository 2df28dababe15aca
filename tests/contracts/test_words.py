"""Names and sentences use standard terms instead of the private words in `WORDS` (issue 12, point 13)."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

from contracts.imports import ROOT, module_of, source_files

WORDS = frozenset(
    {
        *("rounds", "rehearsal", "guesses", "accounts", "manners", "purposes", "trying", "filling"),
        *("parts", "usable", "looks", "blows", "judges", "inquiry"),
    }
)
PROSE = WORDS - {"trying", "filling", "parts", "usable", "looks", "judges"}
"""Words that must not occur in sentences either. The remaining words are plain English in sentences."""

COMPOUND = "a compound's or a mesh's parts: `parts` is a key of the task file"
KEPT: dict[tuple[str, str], str] = {
    ("parts", "attribute"): f"{COMPOUND}; also pathlib's attribute",
    ("parts", "parameter"): COMPOUND,
    ("parts_of", "definition"): COMPOUND,
    ("parts_of", "variable"): COMPOUND,
    ("convex_parts", "variable"): COMPOUND,
    ("MOST_PARTS", "variable"): COMPOUND,
}
"""Maps pairs of (name, kind of name) to the reason why the name may contain one of the words."""


def words_of(name: str) -> list[str]:
    """Return the words of an identifier, in lower case."""
    return [word.lower() for word in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+", name)]


def names(path: Path) -> Iterator[tuple[str, str]]:
    """Yield every name in a file with its kind: module, definition, parameter, attribute or variable."""
    for part in module_of(path).split("."):
        yield part, "module"
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            yield node.name, "definition"
        if isinstance(node, ast.ClassDef):
            fields = [each.target for each in node.body if isinstance(each, ast.AnnAssign)]
            yield from ((each.id, "attribute") for each in fields if isinstance(each, ast.Name))
        elif isinstance(node, ast.arg):
            yield node.arg, "parameter"
        elif isinstance(node, ast.keyword) and node.arg:
            yield node.arg, "attribute"
        elif isinstance(node, ast.Attribute):
            yield node.attr, "attribute"
        elif isinstance(node, ast.alias):
            yield (node.asname or node.name).rpartition(".")[2], "variable"


def variables(path: Path) -> Iterator[str]:
    """Yield the variables that a file binds, except the fields of its classes."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    fields = {
        id(each.target)
        for node in ast.walk(tree)
        if isinstance(node, ast.ClassDef)
        for each in node.body
        if isinstance(each, ast.AnnAssign)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store) and id(node) not in fields:
            yield node.id


def hits() -> Iterator[tuple[str, str]]:
    """Yield pairs of (word, place) for each of the words in a name."""
    for path in source_files():
        found = [*names(path), *((name, "variable") for name in variables(path))]
        for name, what in found:
            for word in WORDS.intersection(words_of(name)):
                if (name, what) not in KEPT:
                    yield word, f"{path.relative_to(ROOT)}: {what} {name}"


def test_no_name_has_a_word_of_our_own() -> None:
    assert [f"{where} ({word})" for word, where in hits()] == []


def texts() -> list[Path]:
    """Return the files whose sentences are checked: code, pages for users, and templates."""
    pages = [path for path in (ROOT / "docs").glob("*.md") if path.name != "test-ids.md"]
    return [*source_files(), *pages, ROOT / "README.md", ROOT / "CONTRIBUTING.md", *ROOT.glob("hybrid_tamp/**/*.html")]


KEYS = {
    "hybrid_tamp/report/keys.py": ("rounds",),
    "hybrid_tamp/report/refinement_tables.py": ("rounds",),
    "hybrid_tamp/report/page.html": ("rounds",),
}
"""Maps each file to the documented JSON keys in this file that are among the words."""


def test_no_sentence_has_a_word_of_our_own() -> None:
    wrong = []
    for path in texts():
        place = str(path.relative_to(ROOT))
        kept = KEYS.get(place, ())
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            found = PROSE.intersection(re.findall(r"[a-z]+", line.lower())) - {
                word for word in kept if re.search(rf"[\"'.]{word}\b", line)
            }
            wrong += [f"{place}:{number}: {word}" for word in found]
    assert wrong == []
