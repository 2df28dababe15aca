"""hybrid_tamp: task and motion planning with affordances as resources.

The package exports the verbs, e.g. `plan` and `run`, and the classes of the verbs' arguments and results. Each name is
imported only when the name is first used, so ``import hybrid_tamp`` is fast. Authors of domains import from
`hybrid_tamp.authoring`.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from hybrid_tamp.errors import DomainError as DomainError
    from hybrid_tamp.errors import ExecutionFailed as ExecutionFailed
    from hybrid_tamp.errors import HybridTampError as HybridTampError
    from hybrid_tamp.errors import InputError as InputError
    from hybrid_tamp.errors import Issue as Issue
    from hybrid_tamp.errors import LawBroken as LawBroken
    from hybrid_tamp.errors import LimitReached as LimitReached
    from hybrid_tamp.errors import NoPlan as NoPlan
    from hybrid_tamp.execution.storage import load_recording as load_recording
    from hybrid_tamp.interop.environment import make_environment as make_environment
    from hybrid_tamp.interop.problems import from_unified_planning as from_unified_planning
    from hybrid_tamp.interop.problems import to_unified_planning as to_unified_planning
    from hybrid_tamp.interop.trajectories import trajectory_table as trajectory_table
    from hybrid_tamp.model.affordances import AffordanceResult as AffordanceResult
    from hybrid_tamp.model.conditions import Violation as Violation
    from hybrid_tamp.model.domain import Domain as Domain
    from hybrid_tamp.model.explanation import Explanation as Explanation
    from hybrid_tamp.model.explanation import TaskExplanation as TaskExplanation
    from hybrid_tamp.model.imitation import ImitationResult as ImitationResult
    from hybrid_tamp.model.law import check_law as check_law
    from hybrid_tamp.model.membership import MembershipResult as MembershipResult
    from hybrid_tamp.model.outcome import PlanOutcome as PlanOutcome
    from hybrid_tamp.model.plan import BlockInstance as BlockInstance
    from hybrid_tamp.model.plan import TaskPlan as TaskPlan
    from hybrid_tamp.model.predicate import Atom as Atom
    from hybrid_tamp.model.recording import Recording as Recording
    from hybrid_tamp.model.run_result import ReplayResult as ReplayResult
    from hybrid_tamp.model.run_result import RunResult as RunResult
    from hybrid_tamp.model.state import State as State
    from hybrid_tamp.model.task import Limits as Limits
    from hybrid_tamp.model.task import MidLevel as MidLevel
    from hybrid_tamp.model.task import Range as Range
    from hybrid_tamp.model.task import Task as Task
    from hybrid_tamp.model.token import Token as Token
    from hybrid_tamp.symbolic.plan_text import read_plan as read_plan
    from hybrid_tamp.taskfile.loader import load_task as load_task
    from hybrid_tamp.taskfile.making import make_task as make_task
    from hybrid_tamp.taskfile.saving import save_task as save_task
    from hybrid_tamp.testing import check_domain as check_domain
    from hybrid_tamp.verbs.affordances import affordances as affordances
    from hybrid_tamp.verbs.explain import explain as explain
    from hybrid_tamp.verbs.imitate import imitate as imitate
    from hybrid_tamp.verbs.imitate import read_shown as read_shown
    from hybrid_tamp.verbs.learn import learn as learn
    from hybrid_tamp.verbs.learn import save_primitive as save_primitive
    from hybrid_tamp.verbs.loading import Settings as Settings
    from hybrid_tamp.verbs.new import new as new
    from hybrid_tamp.verbs.pddl import pddl as pddl
    from hybrid_tamp.verbs.plan import plan as plan
    from hybrid_tamp.verbs.probe import probe as probe
    from hybrid_tamp.verbs.probe import save_members as save_members
    from hybrid_tamp.verbs.replay import replay as replay
    from hybrid_tamp.verbs.run import run as run
    from hybrid_tamp.verbs.scene import add_scene as add_scene
    from hybrid_tamp.verbs.trajectories import save_trajectories as save_trajectories

_NAMES = {
    "errors": "DomainError ExecutionFailed HybridTampError InputError Issue LawBroken LimitReached NoPlan",
    "execution.storage": "load_recording",
    "interop.environment": "make_environment",
    "interop.problems": "from_unified_planning to_unified_planning",
    "interop.trajectories": "trajectory_table",
    "model.affordances": "AffordanceResult",
    "model.conditions": "Violation",
    "model.domain": "Domain",
    "model.explanation": "Explanation TaskExplanation",
    "model.imitation": "ImitationResult",
    "model.law": "check_law",
    "model.membership": "MembershipResult",
    "model.outcome": "PlanOutcome",
    "model.plan": "BlockInstance TaskPlan",
    "model.predicate": "Atom",
    "model.recording": "Recording",
    "model.run_result": "ReplayResult RunResult",
    "model.state": "State",
    "model.task": "Limits MidLevel Range Task",
    "model.token": "Token",
    "symbolic.plan_text": "read_plan",
    "taskfile.loader": "load_task",
    "taskfile.making": "make_task",
    "taskfile.saving": "save_task",
    "testing": "check_domain",
    "verbs.affordances": "affordances",
    "verbs.explain": "explain",
    "verbs.imitate": "imitate read_shown",
    "verbs.learn": "learn save_primitive",
    "verbs.loading": "Settings",
    "verbs.new": "new",
    "verbs.pddl": "pddl",
    "verbs.plan": "plan",
    "verbs.probe": "probe save_members",
    "verbs.replay": "replay",
    "verbs.run": "run",
    "verbs.scene": "add_scene",
    "verbs.trajectories": "save_trajectories",
}
"""Maps each module to a string of its public names."""
_HOME_OF = {name: home for home, names in _NAMES.items() for name in names.split()}

__version__ = "0.1.0"
__all__ = sorted(_HOME_OF)


def __getattr__(name: str) -> Any:
    """Import the module of a public name and return the named object (PEP 562)."""
    if name not in _HOME_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME_OF[name]}"), name)


def __dir__() -> list[str]:
    return __all__
