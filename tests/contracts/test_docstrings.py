"""Every public name has a docstring, with the shapes of arrays."""

import ast
import inspect
import sys
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

import hybrid_tamp
from hybrid_tamp import authoring, skills, testing

PUBLIC = {module.__name__: module for module in (hybrid_tamp, authoring, skills, testing)}


def names_of(module: ModuleType) -> list[str]:
    if module is hybrid_tamp:
        return list(hybrid_tamp.__all__)
    return [name for name, value in vars(module).items() if not name.startswith("_") and not inspect.ismodule(value)]


def documented_constants() -> set[str]:
    """Return the names of the module constants that a docstring follows, anywhere in the framework."""
    found: set[str] = set()
    for path in Path(hybrid_tamp.__file__).parent.rglob("*.py"):
        body = ast.parse(path.read_text(encoding="utf-8")).body
        for one, other in pairwise(body):
            if isinstance(other, ast.Expr) and isinstance(other.value, ast.Constant):
                targets = one.targets if isinstance(one, ast.Assign) else [getattr(one, "target", None)]
                found.update(target.id for target in targets if isinstance(target, ast.Name))
    return found


def undocumented(module: ModuleType) -> Iterator[str]:
    constants = documented_constants()
    for name in names_of(module):
        value: Any = getattr(module, name)
        if inspect.isclass(value) or inspect.isroutine(value) or hasattr(value, "cache_clear"):
            said = inspect.getdoc(value) or ""
            if not said:
                yield f"{name} has no docstring"
            elif inspect.isfunction(value) and "ndarray" in str(value.__annotations__) and "``(" not in said:
                yield f"the docstring of {name} does not give the shapes of its arrays"
        elif name not in constants and not getattr(value, "description", ""):
            yield f"the constant {name} has no docstring"


@pytest.mark.parametrize("name", sorted(PUBLIC))
def test_every_public_name_has_a_docstring(name: str) -> None:
    assert list(undocumented(sys.modules[name])) == []
