"""A task to a checked plan, or to the reason why there is none."""

import shlex
import time
from dataclasses import dataclass
from typing import Literal

from hybrid_tamp.errors import HybridTampError, LimitReached, NoPlan
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.tailoring import Tailoring
from hybrid_tamp.report.plan_entries import (
    BroughtEntry,
    ExplanationEntry,
    NetworkEntry,
    PlanDocument,
    PlannerEntry,
    ReasonEntry,
    network_entry,
    plan_document,
)
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.symbolic.strategies.search import Planner, SearchResult
from hybrid_tamp.verbs.explaining import SUGGESTING, explained

_SAID = {
    "unsolvable": "No plan exists; the planner has proven it.",
    "not_found": "The planner found no plan, but has not proven that there is none.",
    "planner_crashed": "The planner crashed.",
    "plan_refused": "The planner returned a plan that is wrong; it was refused.",
}

CLASS_UNKNOWN = "class_unknown"
"""The kind of explanation where the goal speaks of a token that is unknown in the class that it asks for."""


@dataclass(frozen=True)
class PlanOutcome:
    """What came of planning: the document that is shown, and the plan where there is one.

    Attributes:
        task: the task.
        document: what is shown.
        plan: the plan, or None.
        error: why there is none, or None.
        chosen: the task with the ground goal that the plan reaches; the task itself where it leaves no choice.
    """

    task: Task
    document: PlanDocument
    plan: TaskPlan | None
    error: HybridTampError | None
    chosen: Task | None = None

    def required(self) -> TaskPlan:
        """Return the plan.

        Raises:
            NoPlan: there is none, or none was found.
            LimitReached: the planner ran into a limit.
        """
        if self.plan is None:
            raise self.error or NoPlan("no plan", proven=False, kind="not_found")
        return self.plan


def plan(task: Task, planner: Planner | None = None, suggesting: float = SUGGESTING) -> PlanOutcome:
    """Plan a task and judge the plan.

    Args:
        task: the task.
        planner: a running planner process; without one, one is started for this call.
        suggesting: how long to look for a single change that gives a plan, where there is none [s].

    Raises:
        InputError: the engine is unknown or not installed.
    """
    if planner is None:
        with PlannerProcess() as process:
            return plan(task, process, suggesting)
    began = time.monotonic()
    if task.unsettled:
        return _unsettled(task)
    tailoring = Tailoring(task)
    try:
        planned = tailoring.planned(planner)
    except LimitReached as limit:
        entry = PlannerEntry(name=task.planner, seconds=time.monotonic() - began)
        said = ExplanationEntry(kind=limit.limit, message=str(limit), reasons=[])
        network = _network(tailoring)
        document = plan_document(task, status="limit", planner=entry, plan=None, network=network, explanation=said)
        return PlanOutcome(task, document, None, limit)
    return _outcome(task, planned, _network(tailoring), suggesting)


def _unsettled(task: Task) -> PlanOutcome:
    """Return that a plan has to wait until it is known what a token of the goal is."""
    said = "Whether there is a plan is not known: the goal speaks of a token that nobody has tried yet."
    reasons = []
    for atom, token, sort in task.unsettled:
        asking = f"hybrid-tamp probe {task.source or task.name} --token {shlex.quote(token.name)} --write NEW.yaml"
        message = f"it is unknown whether {token.name} is a member of {sort.name}; '{asking}' finds out"
        reasons.append(ReasonEntry(goal=str(atom), block="", kind=CLASS_UNKNOWN, message=message, lacks=sort.name))
    explanation = ExplanationEntry(kind=CLASS_UNKNOWN, message=said, reasons=reasons)
    entry, network = PlannerEntry(name=task.planner, seconds=0.0), network_entry(task, task, [])
    document = plan_document(task, status="unknown", planner=entry, plan=None, network=network, explanation=explanation)
    return PlanOutcome(task, document, None, NoPlan(_with_reasons(explanation), proven=False, kind=CLASS_UNKNOWN))


def _with_reasons(explanation: ExplanationEntry) -> str:
    return "\n".join([explanation.message, *(f"  {each.goal}: {each.message}" for each in explanation.reasons)])


def _network(tailoring: Tailoring) -> NetworkEntry:
    brought = [
        BroughtEntry(token=each.token, classes=list(each.classes), blocks=list(each.blocks), why=each.why)
        for each in tailoring.brought
    ]
    return network_entry(tailoring.task, tailoring.reduction.task, brought)


def _outcome(task: Task, planned: SearchResult, network: NetworkEntry, suggesting: float) -> PlanOutcome:
    answer = planned.answer
    entry = PlannerEntry(
        name=answer.engine,
        seconds=answer.seconds,
        way=planned.way,
        stages=dict(planned.stages),
    )
    if planned.plan is not None:
        document = plan_document(
            task, status="solved", planner=entry, plan=planned.plan, network=network, explanation=None
        )
        return PlanOutcome(task, document, planned.plan, None, planned.task)
    proven = planned.status == "unsolvable"
    detail = planned.refusal or ("" if proven else answer.message)
    said = " ".join(filter(None, [_SAID[planned.status], detail]))
    if detail:
        explanation = ExplanationEntry(kind=planned.status, message=said, reasons=[])
    else:
        explanation = explained(task, planned.status, said, proven, suggesting)
    status: Literal["unsolvable", "unknown"] = "unsolvable" if proven else "unknown"
    document = plan_document(task, status=status, planner=entry, plan=None, network=network, explanation=explanation)
    return PlanOutcome(task, document, None, NoPlan(_with_reasons(explanation), proven=proven, kind=planned.status))
