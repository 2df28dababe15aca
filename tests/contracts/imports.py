"""All imports of the project: at the top, under TYPE_CHECKING, in functions, and by `import_module`."""

import ast
from collections.abc import Iterator
from pathlib import Path

import hybrid_tamp

ROOT = Path(hybrid_tamp.__file__).parent.parent


def source_files() -> Iterator[Path]:
    """Yield the Python files of the framework and of the bundled domains."""
    for folder in ("hybrid_tamp", "domains"):
        yield from sorted((ROOT / folder).rglob("*.py"))


def module_of(path: Path) -> str:
    """Return the dotted name of a source file."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


KNOWN = frozenset(module_of(path) for path in source_files())


def imports_of(path: Path) -> Iterator[str]:
    """Yield the modules that a file imports. If a submodule is imported by name, yield the name of the submodule."""
    package = module_of(path) if path.name == "__init__.py" else module_of(path).rpartition(".")[0]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = package.split(".")[: len(package.split(".")) - node.level + 1] if node.level else []
            base = ".".join([*above, *([node.module] if node.module else [])])
            for alias in node.names:
                exact = f"{base}.{alias.name}"
                yield exact if exact in KNOWN else base
        elif isinstance(node, ast.Call) and _is_import_module(node.func):
            yield from _named(node)


def _is_import_module(called: ast.expr) -> bool:
    name = called.attr if isinstance(called, ast.Attribute) else called.id if isinstance(called, ast.Name) else ""
    return name in ("import_module", "__import__")


def _named(node: ast.Call) -> Iterator[str]:
    if node.args and isinstance(node.args[0], ast.Constant) and isinstance(node.args[0].value, str):
        yield node.args[0].value


def library_imports(path: Path) -> frozenset[str]:
    """Return the top-level packages of other projects that a file imports."""
    return frozenset(name.partition(".")[0] for name in imports_of(path)) - {"hybrid_tamp", "hybrid_tamp_domains"}
