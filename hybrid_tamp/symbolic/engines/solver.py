"""Solver of planning problems in the planner process.

The reply to a request is a dictionary for JSON. Its ``status`` is one of

* ``solved``: the validator of unified_planning accepted the engine's ``actions``.
* ``refused``: the validator of unified_planning did not accept the engine's ``actions``.
* ``unsolvable``: the engine proved that there is no plan.
* ``not_found``: the engine ended with neither a plan nor a proof.
* ``crashed``: the engine failed.
* ``limit``: the engine reached a limit of its own. The key ``limit`` is ``time`` or ``memory``.
* ``unknown``: the engine does not exist. The ``available`` engines are listed.
* ``unsupported``: the engine does not support the problem, even after compilation.
"""

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib import import_module
from types import ModuleType
from typing import Any

from hybrid_tamp.symbolic.engines.plain import PlainProblem, without_impossible
from hybrid_tamp.symbolic.engines.registry import ENGINES, Engine
from hybrid_tamp.symbolic.engines.unified import unify
from hybrid_tamp.symbolic.pddl.operators import PlanningProblem

Reply = dict[str, Any]

_LOG_LINES = 15  # Number of lines of an engine's log in a message.

# Maps each compilation of unified_planning, in the order of use, to the problem features that it removes.
_REMOVERS = {
    "QUANTIFIERS_REMOVING": ("EXISTENTIAL_CONDITIONS", "UNIVERSAL_CONDITIONS", "FORALL_EFFECTS"),
    "CONDITIONAL_EFFECTS_REMOVING": ("CONDITIONAL_EFFECTS",),
    "DISJUNCTIVE_CONDITIONS_REMOVING": ("DISJUNCTIVE_CONDITIONS",),
    "NEGATIVE_CONDITIONS_REMOVING": ("NEGATIVE_CONDITIONS",),
}


class Solver:
    """Solves planning problems with the engines of unified_planning."""

    def __init__(self) -> None:
        # By default, unified_planning imports every installed engine. The solver imports only the engine of the
        # request. This is faster, and a broken engine does not affect the others.
        with _configspace_put_off():
            from unified_planning.engines import factory

            known = factory.DEFAULT_ENGINES
            own = [name for name, (module, _) in known.items() if module.startswith("unified_planning.")]
            self._installable = {name: known.pop(name) for name in sorted(known.keys() - own)}
            from unified_planning.environment import get_environment

            self._factory = get_environment().factory

    def reply(self, source: PlanningProblem, name: str) -> Reply:
        """Solve a problem with an engine and return the reply."""
        entry = _entry(name)
        unified_name = entry.name or name
        try:
            self._load(unified_name)
        except LookupError as error:
            return {"status": "unknown", "message": str(error), "available": self._available()}
        possible = without_impossible(source)
        plain = None if entry.faithful else PlainProblem(possible)
        problem = unify(plain.problem if plain else possible, sparse=entry.sparse)
        with self._factory.OneshotPlanner(name=unified_name) as planner:
            for attribute, value in entry.settings.items():
                setattr(planner, attribute, value)
            given, compiled = simplify_for(planner, problem.problem)
            missing = sorted(given.kind.features - planner.supported_kind().features)
            if missing and not planner.supports(given.kind):
                return {"status": "unsupported", "message": ", ".join(missing)}
            result = planner.solve(given)
        if result.plan is None:
            return _without_plan(name, result)
        actions = problem.read_plan(original_plan(result.plan, compiled))
        if plain:
            actions = tuple(map(plain.original, actions))
        # The problem is rebuilt because engines change its explicit initial values.
        fault = unify(source).fault(actions)
        status, fewest = "refused" if fault else "solved", entry.judge_length(_log(result))
        return {"status": status, "actions": actions, "message": fault, "fewest": fewest}

    def _load(self, name: str) -> None:
        """Import an engine and register it with unified_planning. Raise LookupError if no such planner exists."""
        if name in self._installable:
            with _configspace_put_off():
                self._factory.add_engine(name, *self._installable[name])
        elif ":" in name:
            module, _, member = name.partition(":")
            if not hasattr(getattr(import_module(module), member, None), "is_oneshot_planner"):
                raise LookupError(f"the module {module} has no planning engine {member}")
            self._factory.add_engine(name, module, member)
        if name not in self._factory.engines or not self._finds_plans(name):
            raise LookupError(f"unified_planning has no planner {name}")

    def _finds_plans(self, name: str) -> bool:
        return bool(self._factory.engine(name).is_oneshot_planner())

    def _available(self) -> list[str]:
        loaded = [name for name in self._factory.engines if ":" not in name and self._finds_plans(name)]
        return list(dict.fromkeys([*ENGINES, *loaded]))


def _entry(name: str) -> Engine:
    """Return the entry of an engine in `ENGINES`, or the default properties if the engine has no entry."""
    return ENGINES.get(name, Engine(""))


def _log(result: Any) -> str:
    return "\n".join(entry.message.strip() for entry in result.log_messages or ())


def _without_plan(name: str, result: Any) -> Reply:
    """Return the reply for an engine's result without a plan."""
    status = result.status.name
    log = _log(result)
    end = f"{name} ended with {status}"
    if status == "TIMEOUT":
        return {"status": "limit", "limit": "time", "message": end}
    if status == "MEMOUT" or "OutOfMemoryError" in log:
        return {"status": "limit", "limit": "memory", "message": end}
    if not status.startswith("UNSOLVABLE"):
        return {"status": "crashed", "message": "\n".join([end, *log.splitlines()[-_LOG_LINES:]])}
    if _entry(name).proves(status, log):
        return {"status": "unsolvable"}
    return {"status": "not_found", "message": end}


def simplify_for(engine: Any, problem: Any) -> tuple[Any, list[Any]]:
    """Use the compilers of unified_planning to remove the features that an engine does not support.

    Args:
        engine: Engine of unified_planning, or its class.
        problem: Problem of unified_planning.

    Returns:
        Pair of the simplified problem and the results of the compilers, first to last. Some features cannot be removed,
        so check ``engine.supports(problem.kind)`` afterwards.
    """
    from unified_planning.engines import CompilationKind

    results: list[Any] = []
    for name, removed in _REMOVERS.items():
        unwanted = problem.kind.features - engine.supported_kind().features
        if not engine.supports(problem.kind) and unwanted.intersection(removed):
            kind = CompilationKind[name]
            compiler = problem.environment.factory.Compiler(problem_kind=problem.kind, compilation_kind=kind)
            results.append(compiler.compile(problem, kind))
            problem = results[-1].problem
    return problem, results


def original_plan(plan: Any, results: Sequence[Any]) -> Any:
    """Convert a plan of the problem that `simplify_for` returned to a plan of the original problem."""
    for result in reversed(results):
        if result.plan_back_conversion is not None:
            plan = result.plan_back_conversion(plan)
        else:
            plan = plan.replace_action_instances(result.map_back_action_instance)
    return plan


class _ConfigurationSpace:
    """Stand-in for ``ConfigSpace.ConfigurationSpace``. A call imports ConfigSpace and returns the real object."""

    def __new__(cls, *arguments: Any, **named: Any) -> Any:
        return import_module("ConfigSpace").ConfigurationSpace(*arguments, **named)


@contextmanager
def _configspace_put_off() -> Iterator[None]:
    """Postpone the import of ConfigSpace and most of SciPy, which takes longer than all other imports."""
    # unified_planning and its engines import one name from ConfigSpace, for an annotation and for a method that is not
    # called here. Any other name is taken from the real module.
    stand_in = ModuleType("ConfigSpace")

    def from_real_module(name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        sys.modules.pop("ConfigSpace", None)
        return getattr(import_module("ConfigSpace"), name)

    vars(stand_in).update(ConfigurationSpace=_ConfigurationSpace, __getattr__=from_real_module)
    before = sys.modules.setdefault("ConfigSpace", stand_in)
    try:
        yield
    finally:
        if before is stand_in and sys.modules.get("ConfigSpace") is stand_in:
            del sys.modules["ConfigSpace"]
