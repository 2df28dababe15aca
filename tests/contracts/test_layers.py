"""The allowed imports of each package. The tests cover all imports, also inside functions."""

import ast
import subprocess
import sys

import networkx as nx
import pytest
from contracts.imports import KNOWN, ROOT, imports_of, library_imports, module_of, source_files

import hybrid_tamp

BASE = ("model", "geometry", "motion")
"""Each of these packages may import the packages after it. Every other package may import all of these packages."""

TABLE: dict[str, tuple[str, ...]] = {
    "cli": ("batch", "verbs", "report"),
    "batch": ("verbs", "report", "workers"),
    "verbs": (
        "interop",
        "report",
        "questions",
        "planning",
        "execution",
        "symbolic",
        "paths",
        "midlevel",
        "feasibility",
        "physics",
        "taskfile",
        "collision",
        "workers",
        "testing",
    ),
    "interop": ("symbolic", "execution", "physics"),
    "report": ("physics.pictures", "robots"),
    "questions": ("planning", "symbolic", "paths", "execution", "feasibility", "physics.protocol", "workers"),
    "planning": (
        "symbolic",
        "paths",
        "midlevel",
        "execution",
        "feasibility",
        "collision",
        "physics.protocol",
        "workers",
    ),
    "testing": ("collision", "execution", "physics.protocol"),
    "execution": ("collision", "physics.protocol"),
    "symbolic": ("feasibility",),
    "paths": ("collision", "robots"),
    "midlevel": ("collision",),
    "feasibility": ("collision", "robots"),
    "physics": ("collision", "robots"),
    "taskfile": ("collision", "robots"),
    "collision": ("robots",),
    "robots": (),
    "authoring": (),
    "skills": (),
    "workers": (),
}
"""Maps each package or module to its allowed imports besides `errors`, itself and `BASE`."""

LIBRARIES = {
    "unified_planning": ("symbolic.engines", "interop"),
    "pybullet": ("physics.bullet",),
    "cmaes": ("midlevel.cma",),
    "matplotlib": ("report",),
    "jinja2": ("report",),
    "fcl": ("collision",),
    "ompl": ("paths",),
    "joblib": ("workers",),
    "gymnasium": ("interop",),
}
"""Maps each library to the packages that may import it."""

PUBLIC = ("hybrid_tamp", "hybrid_tamp.authoring", "hybrid_tamp.skills", "hybrid_tamp.testing")
"""Modules of the framework that bundled domains may import."""

VIOLATIONS = frozenset((ROOT / "tests/contracts/violations.txt").read_text().splitlines())
"""Importer and imported module, one pair per line. The list may only shrink."""

CIRCLES = frozenset((ROOT / "tests/contracts/circles.txt").read_text().splitlines())
"""Groups of modules that import each other, one group per line. The list may only shrink."""


def within(module: str, package: str) -> bool:
    return module == package or module.startswith(f"{package}.")


def allowed(importer: str, imported: str) -> bool:
    place = importer.partition(".")[0]
    if imported == "errors" or within(imported, place):
        return True
    if place in BASE:
        return any(within(imported, lower) for lower in BASE[BASE.index(place) + 1 :])
    return any(within(imported, other) for other in (*BASE, *TABLE.get(place, ())))


def violations() -> set[tuple[str, str]]:
    found = set()
    for path in source_files():
        mine = module_of(path)
        for module in imports_of(path):
            if mine.partition(".")[0] == "domains":
                wrong = within(module, "hybrid_tamp") and module not in PUBLIC
            elif mine in ("hybrid_tamp", "hybrid_tamp.errors"):
                # The package itself contains the public names of every stage, and loads them at first use.
                wrong = mine == "hybrid_tamp.errors" and within(module, "hybrid_tamp")
            else:
                one, other = mine.removeprefix("hybrid_tamp."), module.removeprefix("hybrid_tamp.")
                wrong = module == "hybrid_tamp" or (within(module, "hybrid_tamp") and not allowed(one, other))
            if wrong:
                found.add((mine, module))
    return found


def test_each_package_imports_only_what_the_table_allows() -> None:
    assert {" ".join(pair) for pair in violations()} == set(VIOLATIONS)


def test_the_table_knows_every_package() -> None:
    packages = {name.split(".")[1] for name in KNOWN if name.startswith("hybrid_tamp.")}
    assert packages <= {*TABLE, *BASE, "errors"}


def circles() -> set[str]:
    graph: nx.DiGraph[str] = nx.DiGraph()
    for path in source_files():
        mine = module_of(path)
        if mine != "hybrid_tamp":
            graph.add_edges_from((mine, module) for module in imports_of(path) if module in KNOWN and module != mine)
    return {" ".join(sorted(names)) for names in nx.strongly_connected_components(graph) if len(names) > 1}


def test_no_import_circle() -> None:
    assert circles() == set(CIRCLES)


def test_libraries_have_one_home() -> None:
    wrong = [
        f"{module_of(path)} imports {library}"
        for path in source_files()
        for library in sorted(library_imports(path) & LIBRARIES.keys())
        if not any(within(module_of(path), f"hybrid_tamp.{home}") for home in LIBRARIES[library])
    ]
    assert wrong == []


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
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=ROOT)
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
    for path in source_files():
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "print":
                wrong.append(f"{path}:{node.lineno} prints")
            if isinstance(node, ast.ExceptHandler) and node.type is None:
                wrong.append(f"{path}:{node.lineno} catches everything")
    assert not wrong
