"""The folders keep their places: verbs know the nouns and the maths, and nothing of each other."""

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import networkx as nx
import pytest

import hybrid_tamp

ROOT = Path(hybrid_tamp.__file__).parent
VERBS = ("taskfile", "symbolic", "midlevel", "physics", "report")
ALLOWED = {
    "model": {"model", "errors"},
    "motion": {"motion", "errors"},
    **{verb: {verb, "model", "motion", "errors"} for verb in VERBS},
    "affordances": {"affordances", "model", "motion", "errors", *VERBS},
}


def modules() -> Iterator[tuple[str, ast.Module]]:
    for path in sorted(ROOT.rglob("*.py")):
        yield path.relative_to(ROOT.parent).as_posix(), ast.parse(path.read_text(encoding="utf-8"))


def imports(tree: ast.Module, *, at_run_time_only: bool = False) -> Iterator[tuple[str, bool]]:
    """Yield (module, whether it is imported when the module itself is)."""
    typing_only = {
        inner
        for node in ast.walk(tree)
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test)
        for inner in ast.walk(node)
    }
    functions = [n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef | ast.AsyncFunctionDef)]
    inside = {inner for function in functions for inner in ast.walk(function)}
    for node in ast.walk(tree):
        if at_run_time_only and node in typing_only:
            continue
        if isinstance(node, ast.Import):
            yield from ((alias.name, node not in inside) for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield (node.module, node not in inside)


def folder(module: str) -> str:
    parts = module.split(".")
    return parts[1] if len(parts) > 1 else ""


def test_each_folder_imports_only_what_it_may() -> None:
    wrong = []
    for name, tree in modules():
        place = name.split("/")[1].removesuffix(".py")
        for module, _ in imports(tree):
            if place in ALLOWED and module.startswith("hybrid_tamp.") and folder(module) not in ALLOWED[place]:
                wrong.append(f"{name} imports {module}")
    assert not wrong


def test_no_import_circle() -> None:
    graph: nx.DiGraph[str] = nx.DiGraph()
    for name, tree in modules():
        mine = name.removesuffix(".py").replace("/", ".").removesuffix(".__init__")
        for module, on_import in imports(tree, at_run_time_only=True):
            if on_import and module.startswith("hybrid_tamp") and module != mine:
                graph.add_edge(mine, module)
    assert list(nx.simple_cycles(graph)) == []


def test_heavy_libraries_have_one_home() -> None:
    libraries = ("unified_planning", "pybullet", "cmaes", "matplotlib", "jinja2")
    homes: dict[str, set[str]] = {library: set() for library in libraries}
    for name, tree in modules():
        for module, _ in imports(tree):
            root = module.split(".")[0]
            if root in homes:
                homes[root].add(name)
    assert all(name.startswith("hybrid_tamp/symbolic/") for name in homes["unified_planning"])
    assert homes["pybullet"] == {"hybrid_tamp/physics/engine.py"}
    assert homes["cmaes"] == {"hybrid_tamp/midlevel/cma.py"}
    assert homes["matplotlib"] == {"hybrid_tamp/report/convergence.py"}
    assert homes["jinja2"] == {"hybrid_tamp/report/page.py"}


@pytest.mark.parametrize(
    "words",
    [
        ["--help"],
        ["network", "rolling_tumbling"],
        ["check", "problems/roll_cylinder.yaml"],
        ["plan", "problems/no_such_task.yaml"],
        ["domains"],
    ],
)
def test_quick_verbs_import_neither_planner_nor_physics(words: list[str]) -> None:
    program = (
        "import sys\n"
        "from hybrid_tamp.cli import main\n"
        f"status = main({words!r})\n"
        "names = ('unified_planning', 'pybullet', 'scipy', 'cmaes', 'matplotlib', 'jinja2')\n"
        "heavy = [m for m in names if m in sys.modules]\n"
        "print('heavy', heavy)\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=ROOT.parent)
    assert done.stdout.splitlines()[-1] == "heavy []"


def test_public_names_are_exact() -> None:
    assert hybrid_tamp.__all__ == sorted(hybrid_tamp.__all__, key=lambda name: name)
    assert set(hybrid_tamp._HOME_OF) == set(hybrid_tamp.__all__)
    for name in hybrid_tamp.__all__:
        assert getattr(hybrid_tamp, name) is not None
    with pytest.raises(AttributeError, match="no_such_name"):
        hybrid_tamp.__getattr__("no_such_name")


def test_no_module_prints_or_swallows() -> None:
    wrong = []
    for name, tree in modules():
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "print":
                wrong.append(f"{name}:{node.lineno} prints")
            if isinstance(node, ast.ExceptHandler) and node.type is None:
                wrong.append(f"{name}:{node.lineno} catches everything")
    assert not wrong
