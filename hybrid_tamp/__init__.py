"""hybrid_tamp: task and motion planning with affordances as resources.

Users import every public name from here: the verbs, what they take and the results that they return. Each name is
loaded when it is first used, so that ``import hybrid_tamp`` stays cheap. Authors of domains import from
`hybrid_tamp.authoring`.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from hybrid_tamp.errors import (
        DomainError,
        ExecutionFailed,
        HybridTampError,
        InputError,
        Issue,
        LawBroken,
        LimitReached,
        NoPlan,
    )
    from hybrid_tamp.execution.storage import load_recording
    from hybrid_tamp.model.affordances import AffordanceResult
    from hybrid_tamp.model.conditions import Violation
    from hybrid_tamp.model.domain import Domain
    from hybrid_tamp.model.explanation import Explanation, TaskExplanation
    from hybrid_tamp.model.imitation import ImitationResult
    from hybrid_tamp.model.law import check_law
    from hybrid_tamp.model.membership import MembershipResult
    from hybrid_tamp.model.outcome import PlanOutcome
    from hybrid_tamp.model.plan import BlockInstance, TaskPlan
    from hybrid_tamp.model.predicate import Atom
    from hybrid_tamp.model.recording import Recording
    from hybrid_tamp.model.replay_result import ReplayResult
    from hybrid_tamp.model.run_result import RunResult
    from hybrid_tamp.model.state import State
    from hybrid_tamp.model.task import Limits, MidLevel, Range, Task
    from hybrid_tamp.model.token import Token
    from hybrid_tamp.symbolic.plan_text import read_plan
    from hybrid_tamp.taskfile.loader import load_task
    from hybrid_tamp.taskfile.making import make_task
    from hybrid_tamp.taskfile.saving import save_task
    from hybrid_tamp.testing import check_domain
    from hybrid_tamp.verbs.affordances import affordances
    from hybrid_tamp.verbs.explain import explain
    from hybrid_tamp.verbs.imitate import imitate, read_shown
    from hybrid_tamp.verbs.learn import learn, save_primitive
    from hybrid_tamp.verbs.loading import Settings
    from hybrid_tamp.verbs.pddl import pddl
    from hybrid_tamp.verbs.plan import plan
    from hybrid_tamp.verbs.probe import probe, save_members
    from hybrid_tamp.verbs.replay import replay
    from hybrid_tamp.verbs.run import run

_HOMES = {
    "errors": (
        "DomainError",
        "ExecutionFailed",
        "HybridTampError",
        "InputError",
        "Issue",
        "LawBroken",
        "LimitReached",
        "NoPlan",
    ),
    "execution.storage": ("load_recording",),
    "model.affordances": ("AffordanceResult",),
    "model.conditions": ("Violation",),
    "model.domain": ("Domain",),
    "model.explanation": ("Explanation", "TaskExplanation"),
    "model.imitation": ("ImitationResult",),
    "model.law": ("check_law",),
    "model.membership": ("MembershipResult",),
    "model.outcome": ("PlanOutcome",),
    "model.plan": ("BlockInstance", "TaskPlan"),
    "model.predicate": ("Atom",),
    "model.recording": ("Recording",),
    "model.replay_result": ("ReplayResult",),
    "model.run_result": ("RunResult",),
    "model.state": ("State",),
    "model.task": ("Limits", "MidLevel", "Range", "Task"),
    "model.token": ("Token",),
    "symbolic.plan_text": ("read_plan",),
    "taskfile.loader": ("load_task",),
    "taskfile.making": ("make_task",),
    "taskfile.saving": ("save_task",),
    "testing": ("check_domain",),
    "verbs.affordances": ("affordances",),
    "verbs.explain": ("explain",),
    "verbs.imitate": ("imitate", "read_shown"),
    "verbs.learn": ("learn", "save_primitive"),
    "verbs.loading": ("Settings",),
    "verbs.pddl": ("pddl",),
    "verbs.plan": ("plan",),
    "verbs.probe": ("probe", "save_members"),
    "verbs.replay": ("replay",),
    "verbs.run": ("run",),
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}

__version__ = "0.1.0"
__all__ = [
    "AffordanceResult",
    "Atom",
    "BlockInstance",
    "Domain",
    "DomainError",
    "ExecutionFailed",
    "Explanation",
    "HybridTampError",
    "ImitationResult",
    "InputError",
    "Issue",
    "LawBroken",
    "LimitReached",
    "Limits",
    "MembershipResult",
    "MidLevel",
    "NoPlan",
    "PlanOutcome",
    "Range",
    "Recording",
    "ReplayResult",
    "RunResult",
    "Settings",
    "State",
    "Task",
    "TaskExplanation",
    "TaskPlan",
    "Token",
    "Violation",
    "affordances",
    "check_domain",
    "check_law",
    "explain",
    "imitate",
    "learn",
    "load_recording",
    "load_task",
    "make_task",
    "pddl",
    "plan",
    "probe",
    "read_plan",
    "read_shown",
    "replay",
    "run",
    "save_members",
    "save_primitive",
    "save_task",
]


def __getattr__(name: str) -> Any:
    """Load a public name from its home module at its first use (PEP 562)."""
    if name not in _HOME_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME_OF[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
