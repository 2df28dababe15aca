"""Every name is imported from the module that defines the name. Only the public modules re-export names."""

import ast

from contracts.imports import ROOT, module_of, source_files

PUBLIC = frozenset({"hybrid_tamp", "hybrid_tamp.authoring", "hybrid_tamp.skills", "hybrid_tamp.testing"})


def imported(tree: ast.Module) -> set[str]:
    """Return the names that a module imports anywhere."""
    return {
        alias.asname or alias.name
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom | ast.Import)
        for alias in node.names
    }


def listed(tree: ast.Module) -> set[str]:
    """Return the names that a module re-exports, by `__all__` or by an import of the form `import x as x`."""
    found: set[str] = set()
    for node in tree.body:
        if isinstance(node, ast.Assign) and any(isinstance(x, ast.Name) and x.id == "__all__" for x in node.targets):
            found |= {each.value for each in ast.walk(node.value) if isinstance(each, ast.Constant)}  # type: ignore[misc]
        elif isinstance(node, ast.ImportFrom):
            found |= {alias.name for alias in node.names if alias.asname == alias.name}
    return found


def taken_from(trees: dict[str, ast.Module]) -> set[tuple[str, str]]:
    """Return the pairs of (module, name) in all imports of the form `from module import name`."""
    return {
        (node.module, alias.name)
        for tree in trees.values()
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and node.module
        for alias in node.names
    }


def reexports() -> set[str]:
    trees = {module_of(path): ast.parse(path.read_text(encoding="utf-8")) for path in source_files()}
    taken = taken_from(trees)
    found = set()
    for module, tree in trees.items():
        if module in PUBLIC:
            continue
        foreign = imported(tree)
        handed_on = {name for name in foreign if (module, name) in taken and f"{module}.{name}" not in trees}
        found |= {f"{module} {name}" for name in (foreign & listed(tree)) | handed_on}
    return found


def test_no_module_hands_on_names_of_another() -> None:
    assert reexports() == set()


def test_no_alias_of_an_old_name() -> None:
    """A module must not assign an imported name to a second name, because this keeps an old name alive."""
    wrong = []
    for path in source_files():
        tree = ast.parse(path.read_text(encoding="utf-8"))
        names = imported(tree)
        for node in tree.body:
            if isinstance(node, ast.Assign) and isinstance(node.value, ast.Name) and node.value.id in names:
                wrong.append(f"{path.relative_to(ROOT)}:{node.lineno}")
    assert wrong == []
