"""hybrid_tamp: task and motion planning with affordances as resources.

The public names are imported from here; each is loaded when it is first asked for, so that
``import hybrid_tamp`` stays cheap.
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
    from hybrid_tamp.model.affordance import (
        TOKEN,
        AffordanceClass,
        BasicAction,
        CapabilityClass,
        ObjectClass,
        PlaceClass,
        VaryingProperty,
        quantity,
    )
    from hybrid_tamp.model.block import Block, Duration, Movement, Slot, Target
    from hybrid_tamp.model.conditions import Violation
    from hybrid_tamp.model.control import Commands
    from hybrid_tamp.model.domain import Domain
    from hybrid_tamp.model.law import check_law
    from hybrid_tamp.model.network import ReassignmentNetwork
    from hybrid_tamp.model.parameters import Hyperparameter
    from hybrid_tamp.model.plan import BlockInstance, TaskPlan
    from hybrid_tamp.model.predicate import ANY, Atom, Binding, Literal, Parameter, Predicate, SymbolSort
    from hybrid_tamp.model.recording import Recording
    from hybrid_tamp.model.state import State
    from hybrid_tamp.model.task import Limits, MidLevel, Range, Task
    from hybrid_tamp.model.token import Token
    from hybrid_tamp.taskfile.loader import load_task
    from hybrid_tamp.taskfile.making import make_task
    from hybrid_tamp.taskfile.saving import save_task
    from hybrid_tamp.testing import check_domain
    from hybrid_tamp.verbs.learn import learn, save_primitive
    from hybrid_tamp.verbs.plan import plan
    from hybrid_tamp.verbs.probe import probe
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
    "verbs.learn": ("learn", "save_primitive"),
    "model.affordance": (
        "TOKEN",
        "AffordanceClass",
        "BasicAction",
        "CapabilityClass",
        "ObjectClass",
        "PlaceClass",
        "VaryingProperty",
        "quantity",
    ),
    "model.block": ("Binding", "Block", "Commands", "Duration", "Hyperparameter", "Movement", "Slot", "Target"),
    "model.domain": ("Domain",),
    "model.conditions": ("Violation",),
    "model.law": ("check_law",),
    "model.network": ("ReassignmentNetwork",),
    "model.plan": ("BlockInstance", "TaskPlan"),
    "model.predicate": ("ANY", "Atom", "Literal", "Parameter", "Predicate", "SymbolSort"),
    "model.recording": ("Recording",),
    "model.state": ("State",),
    "model.task": ("Limits", "MidLevel", "Range", "Task"),
    "model.token": ("Token",),
    "verbs.plan": ("plan",),
    "verbs.probe": ("probe",),
    "verbs.replay": ("replay",),
    "verbs.run": ("run",),
    "taskfile.loader": ("load_task",),
    "taskfile.making": ("make_task",),
    "taskfile.saving": ("save_task",),
    "testing": ("check_domain",),
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}

__version__ = "0.1.0"
__all__ = [
    "ANY",
    "AffordanceClass",
    "Atom",
    "BasicAction",
    "Binding",
    "Block",
    "BlockInstance",
    "CapabilityClass",
    "Commands",
    "Domain",
    "DomainError",
    "Duration",
    "ExecutionFailed",
    "HybridTampError",
    "Hyperparameter",
    "InputError",
    "Issue",
    "LawBroken",
    "LimitReached",
    "Limits",
    "Literal",
    "MidLevel",
    "Movement",
    "NoPlan",
    "ObjectClass",
    "Parameter",
    "PlaceClass",
    "Predicate",
    "Range",
    "ReassignmentNetwork",
    "Recording",
    "Slot",
    "State",
    "SymbolSort",
    "TOKEN",
    "Target",
    "Task",
    "TaskPlan",
    "Token",
    "VaryingProperty",
    "Violation",
    "check_domain",
    "check_law",
    "learn",
    "load_task",
    "make_task",
    "plan",
    "probe",
    "quantity",
    "replay",
    "run",
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
